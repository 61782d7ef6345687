// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/write_primitive.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/export/float_positions.h"
#include "app/export/meshopt_encode.h"
#include "base/gltf_textures.h"
#include "base/json_handle.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

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

/// A view of buffer 1, which is not there, and of the stretch of the BIN chunk that it is decoded from.
std::size_t PrimitiveWriter::add_compressed_view(std::span<const std::uint8_t> compressed, std::size_t count,
                                                 std::size_t stride, const char* filter, ViewTarget target) {
  const GlbBinary::Range range = binary_.append(compressed);
  GltfJson extension = {{"buffer", 0},
                        {"byteOffset", range.offset},
                        {"byteLength", range.bytes},
                        {"byteStride", stride},
                        {"count", count},
                        {"mode", target == ViewTarget::kIndices ? "TRIANGLES" : "ATTRIBUTES"}};
  if (filter != nullptr) extension["filter"] = filter;
  constexpr std::size_t kAligned = 4;
  fallback_bytes_ = (fallback_bytes_ + kAligned - 1) / kAligned * kAligned;
  const std::size_t view = add_view(document_, {fallback_bytes_, count * stride}, target);
  fallback_bytes_ += count * stride;
  GltfJson& json = document_["bufferViews"][view];
  json["buffer"] = 1;
  if (target == ViewTarget::kVertices) json["byteStride"] = stride;
  json["extensions"]["EXT_meshopt_compression"] = std::move(extension);
  return view;
}

/// An accessor of vertex data.
std::size_t PrimitiveWriter::add_vertices(const VertexStream& stream, const char* type, GltfJson extra) {
  const std::size_t count = stream.bytes.size() / stream.stride;
  std::size_t view = 0;
  if (packing_.meshopt) {
    view = add_compressed_view(encode_vertices(stream.bytes, stream.stride), count, stream.stride, stream.filter,
                               ViewTarget::kVertices);
  } else {
    view = add_view(document_, binary_.append(stream.bytes), ViewTarget::kVertices);
    if (packing_.quantize) document_["bufferViews"][view]["byteStride"] = stream.stride;  // elements may be padded
  }
  extra["bufferView"] = view;
  extra["componentType"] = stream.component;
  extra["count"] = count;
  extra["type"] = type;
  if (stream.is_normalized) extra["normalized"] = true;
  return add_accessor(document_, std::move(extra));
}

Status PrimitiveWriter::add_positions(const format::MeshRecord& record, const run::DecodedCluster& vertices,
                                      const Vec3d& baked, double step, GltfJson& attributes) {
  if (step > 0.0) {
    const QuantizedPositions quantized = quantize_positions(record, vertices, baked, step);
    attributes["POSITION"] = add_vertices(quantized.stream, "VEC3", {{"min", quantized.low}, {"max", quantized.high}});
    return Ok{};
  }
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
  const VertexStream stream =
      pack_floats({&positions->front().x, positions->size() * 3}, 3, record.grid.log2, packing_);
  attributes["POSITION"] =
      add_vertices(stream, "VEC3", {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}});
  return Ok{};
}

void PrimitiveWriter::add_texcoords(const format::MeshRecord& record, const run::ClusterAttributes& floats,
                                    MaterialId material, std::size_t count, GltfJson& attributes) {
  int texcoord_end = texcoords_needed(material);
  for (std::uint32_t k = 0; k < record.uv_set_count; ++k) {
    attributes["TEXCOORD_" + std::to_string(record.uv_set_source[k])] =
        add_vertices(pack_uvs(floats.uvs[k], record.uv_log2[k], packing_), "VEC2");
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
  VertexStream colors{kUnsignedByte, true, 4, std::vector<std::uint8_t>(std::size_t{vertices.vertex_count} * 4)};
  const std::size_t first = vertices.channel_count - 4;  // colour is the last channel group
  for (std::size_t i = 0; i < vertices.vertex_count; ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      const std::int32_t value = vertices.channels[i * vertices.channel_count + first + c];
      colors.bytes[i * 4 + c] = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
    }
  }
  attributes["COLOR_0"] = add_vertices(colors, "VEC4");
}

std::size_t PrimitiveWriter::add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertex_count) {
  // The largest value of an index type means "restart" and may not be used.
  const bool is_short = vertex_count <= 65535;
  std::size_t view = 0;
  if (packing_.meshopt) {
    view = add_compressed_view(encode_triangles(indices, vertex_count), indices.size(),
                               is_short ? sizeof(std::uint16_t) : sizeof(std::uint32_t), nullptr, ViewTarget::kIndices);
  } else if (is_short) {
    const std::vector<std::uint16_t> narrow(indices.begin(), indices.end());
    view = add_view(document_, binary_.append_values(std::span<const std::uint16_t>(narrow)), ViewTarget::kIndices);
  } else {
    view = add_view(document_, binary_.append_values(std::span<const std::uint32_t>(indices)), ViewTarget::kIndices);
  }
  return add_accessor(document_, {{"bufferView", view},
                                  {"componentType", is_short ? kUnsignedShort : kUnsignedInt},
                                  {"count", indices.size()},
                                  {"type", "SCALAR"}});
}

Result<GltfJson> PrimitiveWriter::write(const format::MeshRecord& record, CutPrimitive& primitive, const Vec3d& baked,
                                        double step) {
  if (packing_.meshopt) order_for_codecs(primitive);
  const run::DecodedCluster& vertices = primitive.vertices;
  const std::size_t count = vertices.vertex_count;
  GltfJson attributes = GltfJson::object();
  TRY(add_positions(record, vertices, baked, step, attributes));
  run::ClusterAttributes floats;
  run::decode_attributes(record, vertices, floats);
  // No NORMAL means flat normals in glTF, which is what the other two modes ask for.
  if (record.normal_mode == format::NormalMode::kStored) {
    attributes["NORMAL"] = add_vertices(pack_normals(floats.normals, record.normal_scale, packing_), "VEC3");
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
