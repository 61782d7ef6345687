// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <optional>

#include "lab/samples/write_png.h"
#include "scene.h"

namespace meshlode::test {

namespace {

/// The binary chunk with its tables as JSON text, element by element.
class Buffer {
 public:
  std::string accessors, views;
  std::vector<std::uint8_t> bytes;

  template <class T>
  void put(const T& value) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    // NOLINTNEXTLINE(bugprone-undefined-memory-manipulation): GLM's vectors are plain numbers.
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }
  void align() {
    while (bytes.size() % 4 != 0) bytes.push_back(0);
  }
  /// Everything from `start` on.
  std::uint32_t end_view(std::size_t start) {
    views += (views.empty() ? "" : ",") + std::string(R"({"buffer":0,"byteOffset":)") + std::to_string(start) +
             R"(,"byteLength":)" + std::to_string(bytes.size() - start) + "}";
    align();
    return view_count_++;
  }
  std::uint32_t add_accessor(std::uint32_t view, std::uint32_t component, std::size_t count, const char* type,
                             const std::string& more = {}) {
    accessors += (accessors.empty() ? "" : ",") + std::string(R"({"bufferView":)") + std::to_string(view) +
                 R"(,"componentType":)" + std::to_string(component) + R"(,"count":)" + std::to_string(count) +
                 R"(,"type":")" + type + "\"" + more + "}";
    return accessor_count_++;
  }

 private:
  std::uint32_t view_count_ = 0, accessor_count_ = 0;
};

constexpr std::uint32_t kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string triple(const Vec3f& v) {
  return "[" + number(double{v.x}) + "," + number(double{v.y}) + "," + number(double{v.z}) + "]";
}

template <class V>
std::uint32_t write_vectors(Buffer& buffer, const std::vector<V>& values, const char* type,
                            const std::string& more = {}) {
  const std::size_t start = buffer.bytes.size();
  for (const V& value : values) buffer.put(value);
  return buffer.add_accessor(buffer.end_view(start), kFloat, values.size(), type, more);
}

std::uint32_t write_positions(Buffer& buffer, const std::vector<Vec3f>& positions) {
  Vec3f low = positions.at(0), high = low;
  for (const Vec3f& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return write_vectors(buffer, positions, "VEC3", R"(,"min":)" + triple(low) + R"(,"max":)" + triple(high));
}

std::uint32_t write_indices(Buffer& buffer, const RandomPrimitive& primitive) {
  const std::size_t start = buffer.bytes.size();
  const bool is_short = primitive.positions.size() <= 65535;  // 65535 itself would be the restart value
  for (const auto& t : primitive.triangles) {
    for (const std::uint32_t v : t) {
      if (is_short) {
        buffer.put(static_cast<std::uint16_t>(v));
      } else {
        buffer.put(v);
      }
    }
  }
  return buffer.add_accessor(buffer.end_view(start), is_short ? kUnsignedShort : kUnsignedInt,
                             3 * primitive.triangles.size(), "SCALAR");
}

std::string write_primitive(Buffer& buffer, const RandomPrimitive& primitive) {
  std::string attributes = R"("POSITION":)" + std::to_string(write_positions(buffer, primitive.positions));
  if (!primitive.normals.empty()) {
    attributes += R"(,"NORMAL":)" + std::to_string(write_vectors(buffer, primitive.normals, "VEC3"));
  }
  if (!primitive.uvs.empty()) {
    attributes += R"(,"TEXCOORD_0":)" + std::to_string(write_vectors(buffer, primitive.uvs, "VEC2"));
  }
  if (!primitive.colors.empty()) {
    attributes += R"(,"COLOR_0":)" + std::to_string(write_vectors(buffer, primitive.colors, "VEC4"));
  }
  const std::uint32_t indices = write_indices(buffer, primitive);
  return R"({"attributes":{)" + attributes + R"(},"indices":)" + std::to_string(indices) + R"(,"material":)" +
         std::to_string(primitive.material) + "}";
}

std::string material_text(const RandomMaterial& material) {
  std::string text = R"({"pbrMetallicRoughness":{"metallicFactor":0)";
  if (material.is_textured) text += R"(,"baseColorTexture":{"index":0})";
  text += "}";
  if (material.is_masked) text += R"(,"alphaMode":"MASK")";
  if (material.is_double_sided) text += R"(,"doubleSided":true)";
  return text + "}";
}

std::string instance_text(const RandomInstance& instance, std::uint32_t mesh) {
  std::string text = R"({"mesh":)" + std::to_string(mesh) + R"(,"matrix":[)";
  for (std::size_t k = 0; k < instance.matrix.size(); ++k) text += (k == 0 ? "" : ",") + number(instance.matrix[k]);
  return text + "]}";
}

/// ,"name":[elements], or nothing: glTF has no empty arrays.
std::string array_text(const char* name, const std::vector<std::string>& elements) {
  if (elements.empty()) return {};
  std::string text = std::string(",\"") + name + "\":[";
  for (std::size_t i = 0; i < elements.size(); ++i) text += (i == 0 ? "" : ",") + elements[i];
  return text + "]";
}

std::vector<std::uint8_t> join(std::string json, Buffer& buffer) {
  while (json.size() % 4 != 0) json.push_back(' ');
  Buffer file;
  file.put(std::uint32_t{0x46546C67});  // "glTF"
  file.put(std::uint32_t{2});
  file.put(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.bytes.size()));
  file.put(static_cast<std::uint32_t>(json.size()));
  file.put(std::uint32_t{0x4E4F534A});  // "JSON"
  file.bytes.insert(file.bytes.end(), json.begin(), json.end());
  file.put(static_cast<std::uint32_t>(buffer.bytes.size()));
  file.put(std::uint32_t{0x004E4942});  // "BIN"
  file.bytes.insert(file.bytes.end(), buffer.bytes.begin(), buffer.bytes.end());
  return std::move(file.bytes);
}

}  // namespace

std::vector<std::uint8_t> write_glb(const RandomScene& scene) {
  Buffer buffer;
  std::vector<std::string> meshes, nodes, node_ids, materials;
  std::vector<std::optional<std::uint32_t>> mesh_ids;
  for (const RandomMesh& mesh : scene.meshes) {
    std::string primitives;
    for (const RandomPrimitive& primitive : mesh.primitives) {
      if (primitive.triangles.empty()) continue;
      primitives += (primitives.empty() ? "" : ",") + write_primitive(buffer, primitive);
    }
    mesh_ids.emplace_back();
    if (primitives.empty()) continue;
    mesh_ids.back() = static_cast<std::uint32_t>(meshes.size());
    meshes.push_back(R"({"primitives":[)" + primitives + "]}");
  }
  for (const RandomInstance& instance : scene.instances) {
    if (!mesh_ids[instance.mesh]) continue;
    node_ids.push_back(std::to_string(nodes.size()));
    nodes.push_back(instance_text(instance, *mesh_ids[instance.mesh]));
  }
  for (const RandomMaterial& material : scene.materials) materials.push_back(material_text(material));
  const bool is_textured = std::any_of(scene.materials.begin(), scene.materials.end(),
                                       [](const RandomMaterial& material) { return material.is_textured; });
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{)";
  const std::string roots = array_text("nodes", node_ids);
  json += (roots.empty() ? roots : roots.substr(1)) + "}]";
  json += array_text("nodes", nodes) + array_text("meshes", meshes) + array_text("materials", materials);
  if (is_textured) {
    const std::size_t start = buffer.bytes.size();
    const auto png = lab::encode_png(lab::make_leaf_texture(16));
    buffer.bytes.insert(buffer.bytes.end(), png.begin(), png.end());
    const std::uint32_t view = buffer.end_view(start);
    json +=
        R"(,"textures":[{"source":0}],"images":[{"mimeType":"image/png","bufferView":)" + std::to_string(view) + "}]";
  }
  if (!buffer.bytes.empty()) {
    json += R"(,"buffers":[{"byteLength":)" + std::to_string(buffer.bytes.size()) + "}]";
    json += R"(,"bufferViews":[)" + buffer.views + "]";
    if (!buffer.accessors.empty()) json += R"(,"accessors":[)" + buffer.accessors + "]";
  }
  return join(json + "}", buffer);
}

}  // namespace meshlode::test
