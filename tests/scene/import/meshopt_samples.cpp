// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshopt_samples.h"

#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <cstring>

#include "gltf_builder.h"

namespace meshlode::testing {

namespace {

struct Patch {
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint8_t> colors;
  std::vector<std::uint32_t> indices;
  [[nodiscard]] std::size_t vertex_count() const { return positions.size() / 3; }
};

Patch make_patch(int n) {
  Patch out;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      const float tilt = static_cast<float>((x * 5 + y * 3) % 7 - 3) * 0.1F;
      const float length = std::sqrt(1.0F + tilt * tilt);
      out.positions.insert(out.positions.end(), {fx, fy, static_cast<float>((x * 7 + y * 13) % 5) * 0.1F});
      out.normals.insert(out.normals.end(), {tilt / length, 0.0F, 1.0F / length});
      out.uvs.insert(out.uvs.end(), {fx / static_cast<float>(n), fy / static_cast<float>(n)});
      out.colors.insert(out.colors.end(),
                        {static_cast<std::uint8_t>(9 * x), static_cast<std::uint8_t>(7 * y), 40, 255});
    }
  }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      out.indices.insert(out.indices.end(), {at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      out.indices.insert(out.indices.end(), {at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return out;
}

template <class T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

constexpr const char* kAttributes = "\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2,\"COLOR_0\":3";
constexpr const char* kUses =
    ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],\"textures\":[{}]";

/// The triangles as the library gives them back: it may turn the corners of one.
std::vector<std::uint32_t> triangles_after(const Stream& stream, std::size_t count) {
  std::vector<std::uint32_t> out(count);
  meshopt_decodeIndexBuffer(out.data(), count, 4, stream.data(), stream.size());
  return out;
}

}  // namespace

Stream encode_meshopt_attributes(std::span<const std::uint8_t> elements, std::size_t stride) {
  const std::size_t count = elements.size() / stride;
  Stream out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), elements.data(), count, stride));
  return out;
}

Stream encode_meshopt_triangles(const std::vector<std::uint32_t>& indices, int version) {
  meshopt_encodeIndexVersion(version);
  Stream out(meshopt_encodeIndexBufferBound(indices.size(), std::size_t{1} << 31U));
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

Stream encode_meshopt_indices(const std::vector<std::uint32_t>& indices, int version) {
  meshopt_encodeIndexVersion(version);
  Stream out(meshopt_encodeIndexSequenceBound(indices.size(), std::size_t{1} << 31U));
  out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

Stream filter_octahedral(const std::vector<float>& values, std::size_t stride, int bits) {
  Stream out(values.size() / 4 * stride);
  meshopt_encodeFilterOct(out.data(), values.size() / 4, stride, bits, values.data());
  return out;
}

Stream filter_quaternion(const std::vector<float>& values, int bits) {
  Stream out(values.size() * 2);
  meshopt_encodeFilterQuat(out.data(), values.size() / 4, 8, bits, values.data());
  return out;
}

Stream filter_exponential(const std::vector<float>& values, std::size_t stride, int bits) {
  Stream out(values.size() * 4);
  meshopt_encodeFilterExp(out.data(), out.size() / stride, stride, bits, values.data());
  return out;
}

void undo_filter_by_library(const std::string& filter, Stream& elements, std::size_t stride) {
  const auto undo = filter == "OCTAHEDRAL"   ? meshopt_decodeFilterOct
                    : filter == "QUATERNION" ? meshopt_decodeFilterQuat
                                             : meshopt_decodeFilterExp;
  undo(elements.data(), elements.size() / stride, stride);
}

MeshoptPair make_meshopt_pair(int n) {
  const Patch patch = make_patch(n);
  const std::size_t count = patch.vertex_count();
  const Stream triangles = encode_meshopt_triangles(patch.indices);
  const std::string rest = mesh_text(kAttributes, ",\"indices\":4,\"material\":0") + kUses;
  GltfBuilder plain;
  plain.floats(patch.positions, "VEC3", 3);
  plain.floats(patch.normals, "VEC3", 3);
  plain.floats(patch.uvs, "VEC2", 2);
  plain.array(patch.colors, 5121, "VEC4", 4, ",\"normalized\":true");
  plain.array(triangles_after(triangles, patch.indices.size()), 5125, "SCALAR", 1);
  GltfBuilder packed;
  const auto attribute = [&](std::span<const std::uint8_t> bytes) {
    const std::size_t stride = bytes.size() / count;
    return packed.meshopt_view(encode_meshopt_attributes(bytes, stride), count, stride, "ATTRIBUTES");
  };
  packed.accessor(attribute(bytes_of(patch.positions)), 5126, count, "VEC3");
  packed.accessor(attribute(bytes_of(patch.normals)), 5126, count, "VEC3");
  packed.accessor(attribute(bytes_of(patch.uvs)), 5126, count, "VEC2");
  packed.accessor(attribute(bytes_of(patch.colors)), 5121, count, "VEC4", ",\"normalized\":true");
  packed.accessor(packed.meshopt_view(triangles, patch.indices.size(), 4, "TRIANGLES"), 5125, patch.indices.size(),
                  "SCALAR");
  return {plain.glb(rest), packed.glb(rest + ",\"extensionsRequired\":[\"EXT_meshopt_compression\"]")};
}

std::string make_filtered_glb(int n) {
  const Patch patch = make_patch(n);
  const std::size_t count = patch.vertex_count();
  std::vector<float> normals;  // four floats each, as the filter takes them
  for (std::size_t i = 0; i < count; ++i) {
    normals.insert(normals.end(), patch.normals.begin() + std::ptrdiff_t(3 * i),
                   patch.normals.begin() + std::ptrdiff_t(3 * i + 3));
    normals.push_back(0.0F);
  }
  GltfBuilder b;
  const auto attribute = [&](const Stream& elements, std::size_t stride, const std::string& filter) {
    return b.meshopt_view(encode_meshopt_attributes(elements, stride), elements.size() / stride, stride, "ATTRIBUTES",
                          filter);
  };
  b.accessor(attribute(filter_exponential(patch.positions, 12, 15), 12, "EXPONENTIAL"), 5126, count, "VEC3");
  b.accessor(attribute(filter_octahedral(normals, 4, 8), 4, "OCTAHEDRAL"), 5120, count, "VEC3", ",\"normalized\":true");
  b.accessor(attribute(filter_exponential(patch.uvs, 8, 12), 8, "EXPONENTIAL"), 5126, count, "VEC2");
  b.accessor(attribute(Stream(patch.colors), 4, "NONE"), 5121, count, "VEC4", ",\"normalized\":true");
  b.accessor(b.meshopt_view(encode_meshopt_indices(patch.indices), patch.indices.size(), 2, "INDICES"), 5123,
             patch.indices.size(), "SCALAR");
  return b.glb(mesh_text(kAttributes, ",\"indices\":4,\"material\":0") + kUses);
}

}  // namespace meshlode::testing
