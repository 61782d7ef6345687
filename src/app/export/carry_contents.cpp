// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/carry_contents.h"

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/export/sniff.h"
#include "base/hash.h"
#include "base/try.h"
#include "format/names.h"

namespace meshlode::app {
namespace {

using Json = GltfJson;

class Carrier {
 public:
  Carrier(const run::Asset& asset, Json& document, GlbBinary& binary)
      : asset_(asset), document_(document), binary_(binary) {}
  Status run();

 private:
  [[nodiscard]] Result<const format::BlobRecord*> blob_of(const Json& owner) const;
  Result<GlbBinary::Range> carry_blob(const format::BlobRecord& blob);
  Status carry_buffers();
  Status carry_images();
  void move_texture_sources();
  Status complete_materials();

  const run::Asset& asset_;
  Json& document_;
  GlbBinary& binary_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, GlbBinary::Range> carried_;  ///< blobs in it, by offset and bytes
};

/// The blob that a document entry names with its member "blob".
Result<const format::BlobRecord*> Carrier::blob_of(const Json& owner) const {
  const auto index = owner.at("blob").get<std::uint64_t>();
  if (index >= asset_.blobs().size()) return malformed("blob " + std::to_string(index) + " does not exist");
  return &asset_.blobs()[index];
}

/// The bytes of a blob in the BIN chunk: once, however many entries of the document name it. Opening an asset does not
/// look at them.
Result<GlbBinary::Range> Carrier::carry_blob(const format::BlobRecord& blob) {
  const auto [found, is_new] = carried_.try_emplace({blob.offset, blob.bytes});
  if (!is_new) return found->second;
  const std::span<const std::uint8_t> bytes = asset_.blob_bytes(blob);
  if (hash64(bytes) != blob.checksum) {
    const auto index = static_cast<std::size_t>(&blob - asset_.blobs().data());
    return Error{ErrorCode::kInvalid, "blob " + std::to_string(index) + ", field checksum",
                 "does not match the stored bytes"};
  }
  found->second = binary_.append(bytes);
  return found->second;
}

/// The buffers of animations become stretches of the one BIN chunk; their views keep their indices.
Status Carrier::carry_buffers() {
  std::vector<GlbBinary::Range> ranges;
  if (const auto buffers = document_.find("buffers"); buffers != document_.end()) {
    for (const Json& buffer : *buffers) {
      TRY_LET(blob, blob_of(buffer));
      TRY_LET(range, carry_blob(**blob));
      ranges.push_back(*range);
    }
    document_.erase("buffers");
  }
  if (!document_.contains("bufferViews")) return Ok{};
  for (Json& view : array_of(document_, "bufferViews")) {
    const auto buffer = view.at("buffer").get<std::size_t>();
    if (buffer >= ranges.size()) return malformed("buffer " + std::to_string(buffer) + " does not exist");
    const GlbBinary::Range range = ranges[buffer];
    const auto offset = view.value("byteOffset", std::uint64_t{0});
    const auto bytes = view.at("byteLength").get<std::uint64_t>();
    if (offset > range.bytes || bytes > range.bytes - offset) return malformed("a view leaves its buffer");
    view["buffer"] = 0;
    view["byteOffset"] = range.offset + offset;
  }
  return Ok{};
}

Status Carrier::carry_images() {
  if (!document_.contains("images")) return Ok{};
  constexpr std::size_t kLongestName = 4096;  // a name that many images share must not be multiplied by them
  for (Json& image : array_of(document_, "images")) {
    if (!image.contains("blob")) continue;
    TRY_LET(blob, blob_of(image));
    const format::BlobRecord& record = **blob;
    const std::span<const std::uint8_t> bytes = asset_.blob_bytes(record);
    TRY_LET(range, carry_blob(record));
    image["bufferView"] = add_view(document_, *range);
    const std::string_view mime_type = asset_.string(record.mime_type);
    // The record's is that of the stored bytes; the document has the source's.
    const bool is_known = !mime_type.empty() && mime_type.size() <= kLongestName;
    if (is_known || !image.contains("mimeType")) {
      image["mimeType"] = is_known ? std::string(mime_type) : sniff_mime_type(bytes);
    }
    const std::string_view name = asset_.string(record.name);
    if (!image.contains("name") && !name.empty() && name.size() <= kLongestName) image["name"] = std::string(name);
    image.erase("blob");
    image.erase("uri");
  }
  return Ok{};
}

/// A texture's own source may be PNG or JPEG only. A source file that refers to others by a URI without a type gets
/// away with more; inside a GLB each image has a type, and the other types have extensions to name them by.
void Carrier::move_texture_sources() {
  if (!document_.contains("textures")) return;
  std::set<std::string_view> used;
  for (Json& texture : array_of(document_, "textures")) {
    const auto source = texture.find("source");
    if (source == texture.end() || !source->is_number_unsigned()) continue;
    const Json* image = find_element(document_, "images", source->get<std::size_t>());
    if (image == nullptr || !image->is_object()) continue;
    const Json type = image->value("mimeType", Json());
    const char* extension = type == "image/ktx2"   ? "KHR_texture_basisu"
                            : type == "image/webp" ? "EXT_texture_webp"
                                                   : "";
    if (*extension == 0) continue;
    Json& named = texture["extensions"][extension];
    if (named.is_null()) named = {{"source", *source}};
    texture.erase("source");
    used.insert(extension);
  }
  for (const std::string_view extension : used) use_extension(document_, extension.data(), true);  // of literals
}

/// Assets that do not come from a glTF have no materials in their document: the records say what is known.
Status Carrier::complete_materials() {
  if (document_.contains("materials")) return Ok{};
  std::map<std::uint32_t, Json> by_index;
  for (const format::MaterialRecord& record : asset_.materials()) {
    if (record.source_index == format::kNone) continue;
    Json material = Json::object();
    if (const auto name = asset_.string(record.name); !name.empty()) material["name"] = std::string(name);
    Json factor = Json::array();
    for (const float c : record.base_color) factor.push_back(c);
    material["pbrMetallicRoughness"] = {{"baseColorFactor", factor}, {"metallicFactor", 0}};
    if (record.alpha_mode != format::AlphaMode::kOpaque) material["alphaMode"] = format::name_of(record.alpha_mode);
    if (record.alpha_mode == format::AlphaMode::kMask) material["alphaCutoff"] = record.alpha_cutoff;
    if (record.double_sided != 0) material["doubleSided"] = true;
    by_index.emplace(record.source_index, std::move(material));
  }
  // Indices without gaps are what the builder writes; a gap cannot be filled with anything true.
  Json materials = Json::array();
  for (auto& [index, material] : by_index) {
    if (index != materials.size()) return malformed("material indices have a gap and there is no document");
    materials.push_back(std::move(material));
  }
  if (!materials.empty()) document_["materials"] = std::move(materials);
  return Ok{};
}

Status Carrier::run() {
  TRY(carry_buffers());
  TRY(carry_images());
  move_texture_sources();
  return complete_materials();
}

}  // namespace

Status carry_contents(const run::Asset& asset, GltfJson& document, GlbBinary& binary) {
  return Carrier(asset, document, binary).run();
}

}  // namespace meshlode::app
