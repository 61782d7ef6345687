// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/obj_materials.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/utf8.h"
#include "scene/import/gltf/uri.h"
#include "scene/import/image_mime.h"
#include "scene/import/json.h"
#include "scene/import/polygons/read_mtl.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

/// A name of the file's for a terminal.
std::string shown(std::string_view name) {
  std::string out(name.substr(0, 64));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return out;
}

/// Windows writes its paths the other way.
std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

class ObjMaterials {
 public:
  ObjMaterials(const std::filesystem::path& path, const ImportOptions& options, Hasher& hasher, Scene& scene)
      : folder_(path.parent_path()), options_(options), hasher_(hasher), scene_(scene) {}

  Status run(const PolygonFile& file) {
    for (const std::string& line : file.material_libraries) open_library(line);
    std::set<std::string> unknown;
    for (const std::string& name : file.material_names) {
      const auto found = by_name_.find(name);
      if (found == by_name_.end()) unknown.insert(name);
      add(name, found == by_name_.end() ? MtlMaterial{} : found->second);
    }
    if (!unknown.empty()) {
      leave_out("material " + shown(*unknown.begin()) +
                    (unknown.size() > 1 ? " and " + std::to_string(unknown.size() - 1) + " more" : ""),
                "no mtllib that could be read has it; it is plain white");
    }
    const auto& used = file.soup.polygon_materials;  // kNoId before any usemtl
    if (used.empty() || std::find(used.begin(), used.end(), kNoId) != used.end()) scene_.materials.emplace_back();
    if (!materials_.empty()) write_document();
    return missing_;
  }

 private:
  void leave_out(std::string what, std::string why) { scene_.left_out.push_back({std::move(what), std::move(why)}); }

  /// A file that geometry does not need.
  void lack(const std::string& what) {
    const char* const why = "it cannot be opened below the scene's folder";
    if (!options_.may_lack_images && missing_) missing_ = Error{ErrorCode::kIo, what, why};
    leave_out(what, why);
  }

  Result<MappedFile> open(const std::string& name, std::filesystem::path& path) {
    auto resolved = resolve_below(folder_, with_slashes(name), options_.allow_outside);
    if (!resolved) return resolved.error();
    path = *resolved;
    auto file = MappedFile::open(path);
    if (!file) return file;
    if (options_.files_read != nullptr) options_.files_read->push_back(file->id());
    return file;
  }

  bool read_library(const std::string& name) {
    std::filesystem::path path;
    const auto file = open(name, path);
    if (!file) return false;
    if (!read_.insert(path).second) return true;
    hasher_.update(file->bytes());
    for (MtlMaterial& material : read_mtl(file->bytes())) {
      std::string key = material.name;
      by_name_.try_emplace(std::move(key), std::move(material));  // the first of a name counts
    }
    return true;
  }

  /// One name with blanks, or several.
  void open_library(const std::string& line) {
    if (read_library(line)) return;
    std::string_view rest = line;
    for (std::string_view name = take_word(rest); !name.empty(); name = take_word(rest)) {
      if (!read_library(std::string(name))) {
        lack("mtllib " + shown(name));
      }
    }
  }

  /// The image of that name; kNoId where it cannot be opened, which is said once.
  std::uint32_t image_of(const std::string& name) {
    if (const auto known = image_by_name_.find(name); known != image_by_name_.end()) return known->second;
    std::uint32_t& image = image_by_name_[name];
    image = kNoId;
    std::filesystem::path path;
    const auto file = open(name, path);
    if (!file) {
      lack("map_Kd " + shown(name));
      return kNoId;
    }
    const auto [known, is_new] = image_by_path_.try_emplace(path, static_cast<std::uint32_t>(images_.size()));
    image = known->second;
    if (!is_new) return image;
    hasher_.update(file->bytes());
    SceneBlob blob;
    blob.name = as_utf8(path.filename().string());
    blob.mime_type = std::string(sniff_image_mime(file->bytes()));
    blob.source_index = image;
    blob.bytes.assign(file->bytes().begin(), file->bytes().end());
    Json json = Json::make_object();
    json.set("name", Json::make_string(blob.name));
    if (!blob.mime_type.empty()) json.set("mimeType", Json::make_string(blob.mime_type));
    json.set("blob", Json::make_index(scene_.blobs.size()));
    images_.push_back(std::move(json));
    scene_.blobs.push_back(std::move(blob));
    return image;
  }

  void add(const std::string& name, const MtlMaterial& from) {
    SceneMaterial material;
    material.name = as_utf8(name);
    material.source_index = static_cast<std::uint32_t>(materials_.size());
    const std::uint32_t image = from.texture.empty() ? kNoId : image_of(from.texture);
    Json factor = Json::make_array();
    for (int c = 0; c < 4; ++c) {
      const double value = c < 3 ? from.diffuse[static_cast<std::size_t>(c)] : from.opacity;
      material.base_color[c] = static_cast<float>(value);
      std::get<Json::Array>(factor.value).push_back(Json::make_number(value));
    }
    Json pbr = Json::make_object();
    pbr.set("baseColorFactor", std::move(factor));
    if (image != kNoId) {
      Json info = Json::make_object();
      info.set("index", Json::make_index(image));  // each image has one texture
      pbr.set("baseColorTexture", std::move(info));
      material.base_color_texture = image;
      material.base_color_uv_set = 0;
      material.uv_sets_used = 1;
      TextureUse use;
      use.role = TextureRole::kBaseColor;
      use.texture = use.image = use.blob = image;  // an OBJ has no other blobs
      material.textures.push_back(use);
    }
    pbr.set("metallicFactor", Json::make_number(0.0));
    Json json = Json::make_object();
    json.set("name", Json::make_string(material.name));
    json.set("pbrMetallicRoughness", std::move(pbr));
    if (from.opacity < 1.0) {
      material.alpha_mode = AlphaMode::kBlend;
      json.set("alphaMode", Json::make_string("BLEND"));
    }
    materials_.push_back(std::move(json));
    scene_.materials.push_back(std::move(material));
  }

  void write_document() {
    Json document = Json::make_object();
    Json asset = Json::make_object();
    asset.set("version", Json::make_string("2.0"));
    document.set("asset", std::move(asset));
    document.set("materials", Json{std::move(materials_)});
    if (!images_.empty()) {
      Json::Array textures;
      for (std::size_t i = 0; i < images_.size(); ++i) {
        Json texture = Json::make_object();
        texture.set("source", Json::make_index(i));
        textures.push_back(std::move(texture));
      }
      document.set("textures", Json{std::move(textures)});
      document.set("images", Json{std::move(images_)});
    }
    scene_.document = dump_json(document);
  }

  std::filesystem::path folder_;
  const ImportOptions& options_;
  Hasher& hasher_;
  Scene& scene_;
  std::set<std::filesystem::path> read_;
  std::map<std::string, MtlMaterial> by_name_;
  std::map<std::string, std::uint32_t> image_by_name_;
  std::map<std::filesystem::path, std::uint32_t> image_by_path_;
  Json::Array materials_, images_;
  Status missing_ = Ok{};  ///< the first file that may not be missing
};

class ReferenceList {
 public:
  ReferenceList(std::filesystem::path folder, std::span<const std::filesystem::path> allow_outside)
      : folder_(std::move(folder)), allow_outside_(allow_outside) {}

  /// The line of a mtllib: one name with blanks, or several. Where the one is not there, another may be some day.
  void add_libraries(std::string_view line) {
    if (add_library(std::string(line))) return;
    for (std::string_view name = take_word(line); !name.empty(); name = take_word(line)) {
      add_library(std::string(name));
    }
  }

  [[nodiscard]] std::vector<FileReference> take() { return std::move(references_); }

 private:
  using Kind = FileReference::Kind;

  /// \returns where it is; nothing where it is not, or may not be opened
  std::optional<std::filesystem::path> add(Kind kind, const std::string& name) {
    const std::string path = with_slashes(name);
    auto resolved = resolve_below(folder_, path, allow_outside_);
    if (!resolved && resolved.error().code != ErrorCode::kIo) return std::nullopt;
    const std::filesystem::path where = folder_ / std::filesystem::path(path).lexically_normal();
    if (known_.insert(where).second) references_.push_back({kind, name, where});
    return resolved ? std::optional(std::move(*resolved)) : std::nullopt;
  }

  bool add_library(const std::string& name) {
    const auto path = add(Kind::kMaterials, name);
    if (!path) return false;
    const auto file = MappedFile::open(*path);
    if (!file) return false;
    for (const MtlMaterial& material : read_mtl(file->bytes())) {
      if (!material.texture.empty()) add(Kind::kImage, material.texture);
    }
    return true;
  }

  std::filesystem::path folder_;
  std::span<const std::filesystem::path> allow_outside_;
  std::set<std::filesystem::path> known_;
  std::vector<FileReference> references_;
};

}  // namespace

std::vector<FileReference> list_obj_references(const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                                               std::span<const std::filesystem::path> allow_outside) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::set<std::string> libraries;  // in the order of the import
  std::string joined;
  for (std::size_t lines = 0; !text.empty();) {
    std::string_view line = take_joined_line(text, joined, lines);
    if (take_word(line) == "mtllib" && !trimmed(line).empty()) libraries.emplace(trimmed(line));
  }
  ReferenceList list(path.parent_path(), allow_outside);
  for (const std::string& line : libraries) list.add_libraries(line);
  return list.take();
}

Status add_obj_materials(const std::filesystem::path& path, const PolygonFile& file, const ImportOptions& options,
                         Hasher& hasher, Scene& scene) {
  return ObjMaterials(path, options, hasher, scene).run(file);
}

}  // namespace meshlode::scene
