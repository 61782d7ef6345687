// SPDX-License-Identifier: GPL-3.0-or-later
// What meshoptimizer writes of an exported cut: the streams of EXT_meshopt_compression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/export/cut_geometry.h"
#include "base/vec.h"

namespace meshlode::app {

/// Triangles in an order in which each shares vertices with those before it, and vertices in the order of first use:
/// what the codecs predict from.
void order_for_codecs(CutPrimitive& primitive);

/// Mode ATTRIBUTES. \pre whole elements of `stride` bytes, a multiple of 4 and at most 256
[[nodiscard]] std::vector<std::uint8_t> encode_vertices(std::span<const std::uint8_t> bytes, std::size_t stride);

/// Mode TRIANGLES. \pre indices below vertex_count, three a triangle
[[nodiscard]] std::vector<std::uint8_t> encode_triangles(std::span<const std::uint32_t> indices,
                                                         std::size_t vertex_count);

/// The filter OCTAHEDRAL, to elements of 4 or 8 bytes. \pre unit vectors; 1 <= bits <= 16, at most 8 for 4 bytes
[[nodiscard]] std::vector<std::uint8_t> encode_octahedral(std::span<const Vec3f> normals, int bits, std::size_t stride);

}  // namespace meshlode::app
