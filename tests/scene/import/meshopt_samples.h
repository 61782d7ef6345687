// SPDX-License-Identifier: GPL-3.0-or-later
// Streams of EXT_meshopt_compression made by meshoptimizer's own encoders and filters, and files around them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshlode::testing {

using Stream = std::vector<std::uint8_t>;

/// Mode ATTRIBUTES: `elements` are count elements of `stride` bytes.
[[nodiscard]] Stream encode_meshopt_attributes(std::span<const std::uint8_t> elements, std::size_t stride);
/// Mode TRIANGLES; `version` 0 or 1. Triangles keep their order; the encoder may turn a triangle's corners.
[[nodiscard]] Stream encode_meshopt_triangles(const std::vector<std::uint32_t>& indices, int version = 1);
/// Mode INDICES; `version` 0 or 1.
[[nodiscard]] Stream encode_meshopt_indices(const std::vector<std::uint32_t>& indices, int version = 1);

/// The filters, each to the elements that the attribute codec is given. Four floats an element; of EXPONENTIAL
/// stride / 4.
[[nodiscard]] Stream filter_octahedral(const std::vector<float>& values, std::size_t stride, int bits);
[[nodiscard]] Stream filter_quaternion(const std::vector<float>& values, int bits);
[[nodiscard]] Stream filter_exponential(const std::vector<float>& values, std::size_t stride, int bits);
/// The library's own inverse of a filter, in place: "OCTAHEDRAL", "QUATERNION" or "EXPONENTIAL".
void undo_filter_by_library(const std::string& filter, Stream& elements, std::size_t stride);

/// One mesh stored twice: as plain accessors, and compressed without filters, so that nothing is lost.
struct MeshoptPair {
  std::string plain_glb;
  std::string meshopt_glb;
};

/// A bumpy patch of n × n quads with positions, normals and UVs as floats and colours as bytes.
[[nodiscard]] MeshoptPair make_meshopt_pair(int n);

/// The patch with every filter: exponential positions, octahedral normals, indices as a sequence.
[[nodiscard]] std::string make_filtered_glb(int n);

}  // namespace meshlode::testing
