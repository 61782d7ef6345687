// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/meshopt_encode.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <utility>

namespace meshlode::app {

void order_for_codecs(CutPrimitive& primitive) {
  run::DecodedCluster& vertices = primitive.vertices;
  std::vector<std::uint32_t>& indices = primitive.indices;
  meshopt_optimizeVertexCache(indices.data(), indices.data(), indices.size(), vertices.vertex_count);
  std::vector<std::uint32_t> remap(vertices.vertex_count);
  meshopt_optimizeVertexFetchRemap(remap.data(), indices.data(), indices.size(), vertices.vertex_count);
  for (std::uint32_t& index : indices) index = remap[index];
  std::vector<std::int32_t> channels(vertices.channels.size());
  for (std::size_t i = 0; i < remap.size(); ++i) {
    std::copy_n(vertices.channels.begin() + static_cast<std::ptrdiff_t>(i * vertices.channel_count),
                vertices.channel_count,
                channels.begin() + static_cast<std::ptrdiff_t>(std::size_t{remap[i]} * vertices.channel_count));
  }
  vertices.channels = std::move(channels);
}

std::vector<std::uint8_t> encode_vertices(std::span<const std::uint8_t> bytes, std::size_t stride) {
  const std::size_t count = bytes.size() / stride;
  std::vector<std::uint8_t> out(meshopt_encodeVertexBufferBound(count, stride));
  meshopt_encodeVertexVersion(0);  // the one that the extension has
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), bytes.data(), count, stride));
  return out;
}

std::vector<std::uint8_t> encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
  std::vector<std::uint8_t> out(meshopt_encodeIndexBufferBound(indices.size(), vertex_count));
  meshopt_encodeIndexVersion(1);  // the one that the extension has
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

std::vector<std::uint8_t> encode_octahedral(std::span<const Vec3f> normals, int bits, std::size_t stride) {
  std::vector<float> padded;
  padded.reserve(normals.size() * 4);
  for (const Vec3f& n : normals) padded.insert(padded.end(), {n.x, n.y, n.z, 0.0F});
  std::vector<std::uint8_t> out(normals.size() * stride);
  meshopt_encodeFilterOct(out.data(), normals.size(), stride, bits, padded.data());
  return out;
}

}  // namespace meshlode::app
