// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/meshopt_views.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "scene/import/gltf/check_base.h"

namespace meshlode::scene {

namespace {

/// A file may have both, for readers of one of them; EXT_'s streams are never newer.
constexpr std::array<std::string_view, 2> kExtensionNames{"EXT_meshopt_compression", "KHR_meshopt_compression"};

constexpr std::array<std::pair<std::string_view, MeshoptMode>, 3> kModes{{{"ATTRIBUTES", MeshoptMode::kAttributes},
                                                                          {"TRIANGLES", MeshoptMode::kTriangles},
                                                                          {"INDICES", MeshoptMode::kIndices}}};
constexpr std::array<std::pair<std::string_view, MeshoptFilter>, 4> kFilters{
    {{"NONE", MeshoptFilter::kNone},
     {"OCTAHEDRAL", MeshoptFilter::kOctahedral},
     {"QUATERNION", MeshoptFilter::kQuaternion},
     {"EXPONENTIAL", MeshoptFilter::kExponential}}};

template <class Table>
auto find_value(const Table& table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.first == name; });
  return found == table.end() ? std::nullopt : std::optional(found->second);
}

struct Extension {
  const Json* json = nullptr;
  std::string_view name;
};

/// Of a buffer or a buffer view.
Extension find_extension(const Json& object) {
  const Json* extensions = object.find("extensions");
  for (const std::string_view name : kExtensionNames) {
    const Json* json = extensions != nullptr ? extensions->find(name) : nullptr;
    if (json != nullptr) return {json, name};
  }
  return {};
}

std::string_view text_or(const Json& object, std::string_view key, std::string_view fallback) {
  const Json* member = object.find(key);
  return member != nullptr ? member->string().value_or(fallback) : fallback;
}

/// \pre checked
MeshoptLayout read_layout(const Json& json) {
  MeshoptLayout layout;
  layout.mode = find_value(kModes, text_or(json, "mode", "")).value_or(layout.mode);
  layout.filter = find_value(kFilters, text_or(json, "filter", "NONE")).value_or(layout.filter);
  layout.count = index_or(json, "count", 0);
  layout.stride = static_cast<std::uint32_t>(index_or(json, "byteStride", 0));
  return layout;
}

class MeshoptChecker : public JsonChecker {
 public:
  MeshoptChecker(const Json& root, const std::string& file) : JsonChecker(file), root_(root) {}

  void run() {
    const auto& buffers = root_.items("buffers");
    for (std::size_t i = 0; i < buffers.size() && ok(); ++i) {
      const std::string path = "/buffers/" + std::to_string(i);
      const Extension extension = find_extension(buffers[i]);
      if (extension.json == nullptr) continue;
      const std::string here = path + "/extensions/" + std::string(extension.name);
      if (!extension.json->is_object()) fail(here, "not an object");
      optional_bool(*extension.json, here, "fallback");
    }
    const auto& views = root_.items("bufferViews");
    for (std::size_t i = 0; i < views.size() && ok(); ++i) {
      const std::string path = "/bufferViews/" + std::to_string(i);
      const Extension extension = find_extension(views[i]);
      if (extension.json != nullptr) {
        check_view(views[i], *extension.json, path, path + "/extensions/" + std::string(extension.name));
      } else if (is_meshopt_fallback(buffers[index_or(views[i], "buffer", 0)])) {
        fail(path + "/buffer", "a fallback buffer, which only compressed buffer views may name");
      }
    }
  }

 private:
  static constexpr std::uint64_t kByteLimit = std::uint64_t{1} << 48U;

  template <class Table>
  bool check_name(const Json& json, const std::string& here, std::string_view key, const Table& table) {
    const Json* member = json.find(key);
    if (member == nullptr) return true;
    if (!member->is_string()) return fail(here + "/" + std::string(key), "not a string");
    return find_value(table, *member->string()).has_value() ||
           fail(here + "/" + std::string(key), "\"" + pointer_part(*member->string()) + "\" is not supported",
                ErrorCode::kUnsupported);
  }

  bool check_view(const Json& view, const Json& json, const std::string& path, const std::string& here) {
    if (!json.is_object()) return fail(here, "not an object");
    const auto& buffers = root_.items("buffers");
    if (!required_index(json, here, "buffer", buffers.size()) ||
        !optional_index(json, here, "byteOffset", kByteLimit) ||
        !required_index(json, here, "byteLength", kByteLimit) || !required_index(json, here, "byteStride", 257) ||
        !required_index(json, here, "count", kByteLimit)) {
      return false;
    }
    if (json.find("mode") == nullptr) return fail(here + "/mode", "missing");
    if (!check_name(json, here, "mode", kModes) || !check_name(json, here, "filter", kFilters)) return false;
    const Json& buffer = buffers[index_or(json, "buffer", 0)];
    if (is_meshopt_fallback(buffer)) return fail(here + "/buffer", "a fallback buffer, which has no compressed bytes");
    const std::uint64_t size = index_or(buffer, "byteLength", 0);
    const std::uint64_t offset = index_or(json, "byteOffset", 0);
    const std::uint64_t length = index_or(json, "byteLength", 0);
    if (offset > size || length > size - offset) {
      return fail(here, "bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                            " lie outside its buffer of " + std::to_string(size) + " bytes");
    }
    const MeshoptLayout layout = read_layout(json);
    if (!is_sound(layout)) return fail(here, "a mode, filter, byteStride and count that do not go together");
    const std::uint64_t stride = index_or(view, "byteStride", layout.stride);
    if (stride != layout.stride) return fail(here + "/byteStride", "not that of the buffer view");
    // count < 2^48 and a stride of at most 256: no overflow.
    if (layout.size_bytes() != index_or(view, "byteLength", 0)) {
      return fail(path + "/byteLength", "not " + std::to_string(layout.count) + " elements of " +
                                            std::to_string(layout.stride) + " bytes, as its extension says");
    }
    return true;
  }

  const Json& root_;
};

}  // namespace

Status check_gltf_meshopt(const Json& root, const std::string& file) {
  MeshoptChecker checker(root, file);
  checker.run();
  return checker.status();
}

bool is_meshopt_fallback(const Json& buffer) {
  const Extension extension = find_extension(buffer);
  const Json* flag = extension.json != nullptr ? extension.json->find("fallback") : nullptr;
  return flag != nullptr && flag->is_bool() && std::get<bool>(flag->value);
}

std::uint64_t count_meshopt_bytes(const Json& root) {
  std::uint64_t sum = 0;  // lengths have 48 bits, and there are less than 2^31 views in a file: held below 2^63
  for (const Json& view : root.items("bufferViews")) {
    const Extension extension = find_extension(view);
    if (extension.json == nullptr) continue;
    sum = std::min(sum + index_or(*extension.json, "byteLength", 0), std::uint64_t{1} << 62U);
  }
  return sum;
}

Status decode_meshopt_views(GltfAsset& asset, std::uint64_t max_bytes) {
  const auto& views = asset.root.items("bufferViews");
  std::uint64_t left = max_bytes;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Extension extension = find_extension(views[i]);
    if (extension.json == nullptr) continue;
    const std::string path = "/bufferViews/" + std::to_string(i) + "/extensions/" + std::string(extension.name);
    const MeshoptLayout layout = read_layout(*extension.json);
    if (layout.size_bytes() > left) {
      return asset.invalid(path,
                           "the compressed views decode to more than the size of the file and --max-decoded justify");
    }
    left -= layout.size_bytes();
    const auto& buffer = asset.buffers[index_or(*extension.json, "buffer", 0)];
    if (buffer.empty() && layout.count > 0) return asset.invalid(path + "/buffer", "this buffer has no data");
    if (layout.count == 0) continue;
    const auto stream =
        buffer.subspan(index_or(*extension.json, "byteOffset", 0), index_or(*extension.json, "byteLength", 0));
    auto decoded = decode_meshopt(stream, layout);
    if (!decoded) return asset.error(decoded.error().code, path, decoded.error().detail);
    asset.decoded_views.resize(views.size());
    asset.decoded_views[i] = std::move(*decoded);
  }
  return Ok{};
}

}  // namespace meshlode::scene
