// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/write_primitive.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/export/float_positions.h"
#include "base/gltf_textures.h"
#include "base/json_handle.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123, kUnsignedByte = 5121;

/// Largest TEXCOORD_n that a material's texture infos name, over extensions too (KHR_texture_transform may name another
/// set than its texture info, and who does not know it reads the texture info's); -1 where nothing is sampled.
int largest_texcoord(const GltfJson& material) {
  constexpr std::uint64_t kMost = 63;
  int largest = -1;
  for_each_texture_info(TreeHandle(material), [&](const auto& info) {
    const TextureReference reference = read_texture_info(info);
    const std::uint64_t set = std::max(reference.tex_coord, reference.uv_set);
    largest = std::max(largest, static_cast<int>(std::min(set, kMost)));
  });
  return largest;
}

}  // namespace

/// How many TEXCOORD sets, from 0 on, the material's textures ask for.
int PrimitiveWriter::texcoords_needed(MaterialId material) {
  const std::uint32_t index = asset_.materials()[material.value].source_index;
  const auto [found, is_new] = texcoords_.try_emplace(index, 0);
  const GltfJson* json = is_new ? find_element(document_, "materials", index) : nullptr;
  if (json != nullptr) found->second = largest_texcoord(*json) + 1;
  return found->second;
}

/// An accessor of vertex data that lies in the BIN chunk.
std::size_t PrimitiveWriter::add_vertices(int component, const char* type, std::size_t count, GlbBinary::Range range,
                                          GltfJson extra) {
  extra["bufferView"] = add_view(document_, range, ViewTarget::kVertices);
  extra["componentType"] = component;
  extra["count"] = count;
  extra["type"] = type;
  return add_accessor(document_, std::move(extra));
}

Status PrimitiveWriter::add_positions(const format::MeshRecord& record, const run::DecodedCluster& vertices,
                                      const Vec3d& baked, GltfJson& attributes) {
  const auto positions = bake_positions(record, vertices, baked);
  if (!positions) {
    return Error{ErrorCode::kUnsupported, std::string(asset_.string(record.name)),
                 "a position does not fit glTF's 32-bit floats"};
  }
  Vec3f low = positions->front();
  Vec3f high = low;
  for (const Vec3f& p : *positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  attributes["POSITION"] =
      add_vertices(kFloat, "VEC3", positions->size(), binary_.append_values(std::span<const Vec3f>(*positions)),
                   {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}});
  return Ok{};
}

void PrimitiveWriter::add_texcoords(const format::MeshRecord& record, const run::ClusterAttributes& floats,
                                    MaterialId material, std::size_t count, GltfJson& attributes) {
  int texcoord_end = texcoords_needed(material);
  for (std::uint32_t k = 0; k < record.uv_set_count; ++k) {
    attributes["TEXCOORD_" + std::to_string(record.uv_set_source[k])] = add_vertices(
        kFloat, "VEC2", count, binary_.append_values(std::span<const Vec2f>(floats.uvs[k])), GltfJson::object());
    texcoord_end = std::max(texcoord_end, record.uv_set_source[k] + 1);
  }
  // glTF wants sets without gaps, and those that a material names. One that the asset did not keep is an accessor
  // without a buffer view: zeros, at no cost.
  for (int set = 0; set < texcoord_end; ++set) {
    const std::string name = "TEXCOORD_" + std::to_string(set);
    if (attributes.contains(name)) continue;
    attributes[name] = add_accessor(document_, {{"componentType", kFloat}, {"count", count}, {"type", "VEC2"}});
  }
}

void PrimitiveWriter::add_colors(const run::DecodedCluster& vertices, GltfJson& attributes) {
  std::vector<std::array<std::uint8_t, 4>> colors(vertices.vertex_count);
  const std::size_t first = vertices.channel_count - 4;  // colour is the last channel group
  for (std::size_t i = 0; i < colors.size(); ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      const std::int32_t value = vertices.channels[i * vertices.channel_count + first + c];
      colors[i][c] = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
    }
  }
  attributes["COLOR_0"] =
      add_vertices(kUnsignedByte, "VEC4", colors.size(),
                   binary_.append_values(std::span<const std::array<std::uint8_t, 4>>(colors)), {{"normalized", true}});
}

std::size_t PrimitiveWriter::add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertex_count) {
  // The largest value of an index type means "restart" and may not be used.
  const bool is_short = vertex_count <= 65535;
  GlbBinary::Range range;
  if (is_short) {
    const std::vector<std::uint16_t> narrow(indices.begin(), indices.end());
    range = binary_.append_values(std::span<const std::uint16_t>(narrow));
  } else {
    range = binary_.append_values(std::span<const std::uint32_t>(indices));
  }
  return add_accessor(document_, {{"bufferView", add_view(document_, range, ViewTarget::kIndices)},
                                  {"componentType", is_short ? kUnsignedShort : kUnsignedInt},
                                  {"count", indices.size()},
                                  {"type", "SCALAR"}});
}

Result<GltfJson> PrimitiveWriter::write(const format::MeshRecord& record, const CutPrimitive& primitive,
                                        const Vec3d& baked) {
  const run::DecodedCluster& vertices = primitive.vertices;
  const std::size_t count = vertices.vertex_count;
  GltfJson attributes = GltfJson::object();
  TRY(add_positions(record, vertices, baked, attributes));
  run::ClusterAttributes floats;
  run::decode_attributes(record, vertices, floats);
  // No NORMAL means flat normals in glTF, which is what the other two modes ask for.
  if (record.normal_mode == format::NormalMode::kStored) {
    attributes["NORMAL"] = add_vertices(
        kFloat, "VEC3", count, binary_.append_values(std::span<const Vec3f>(floats.normals)), GltfJson::object());
  }
  add_texcoords(record, floats, primitive.material, count, attributes);
  if (record.has_color != 0) add_colors(vertices, attributes);
  GltfJson result = {{"attributes", std::move(attributes)}};
  result["indices"] = add_indices(primitive.indices, count);
  const std::uint32_t material = asset_.materials()[primitive.material.value].source_index;
  if (material != format::kNone) {
    if (find_element(document_, "materials", material) == nullptr) {
      return malformed("material " + std::to_string(material) + " does not exist");
    }
    result["material"] = material;
  }
  return result;
}

}  // namespace meshlode::app
