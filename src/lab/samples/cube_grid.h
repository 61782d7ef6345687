// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice on a cube's surface, shared by every shape that is a projected cube. Points are integers, so that two
// faces agree on their common edge to the bit.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace meshlode::lab {

/// Corners of a cell in counter-clockwise order.
constexpr std::uint32_t kCellCorner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/// Point (i, j) of face 0 … 5 (+x -x +y -y +z -z), each coordinate in -n … n. i × j points outwards.
[[nodiscard]] inline Vec3i cube_lattice_point(int face, std::uint32_t i, std::uint32_t j, std::uint32_t n) {
  const int side = static_cast<int>(n);
  const int u = 2 * static_cast<int>(i) - side, v = 2 * static_cast<int>(j) - side;
  switch (face) {
    case 0: return {side, u, v};
    case 1: return {-side, v, u};
    case 2: return {v, side, u};
    case 3: return {u, -side, v};
    case 4: return {u, v, side};
    default: return {v, u, -side};
  }
}

template <class Body>
void for_each_cell(std::uint32_t n, const Body& body) {
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) body(i, j);
  }
}

/// The border's edges of n · n cells, points numbered row by row: a to b, all around.
template <class Body>
void for_each_rim_edge(std::uint32_t n, const Body& body) {
  const std::uint32_t row = n + 1;
  for (std::uint32_t i = 0; i < n; ++i) {
    body(i, i + 1);
    body(n * row + i + 1, n * row + i);
    body((i + 1) * row, i * row);
    body(i * row + n, (i + 1) * row + n);
  }
}

/// Two triangles of a quad given counter-clockwise.
inline void add_quad(std::vector<std::uint32_t>& indices, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                     std::uint32_t d) {
  indices.insert(indices.end(), {a, b, c, a, c, d});
}

}  // namespace meshlode::lab
