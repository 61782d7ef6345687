// SPDX-License-Identifier: GPL-3.0-or-later
// The loose pieces of a mesh: parts of it that share no exact position.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Calls visit(corners among all primitives' vertices, material), primitive by primitive.
template <class Visit>
void for_each_triangle(const SourceMesh& mesh, const Visit& visit) {
  std::size_t base = 0;
  for (const Primitive& primitive : mesh.primitives) {
    const std::vector<std::uint32_t>& indices = primitive.indices;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      std::array<std::uint32_t, 3> t{};
      for (std::size_t k = 0; k < 3; ++k) t[k] = static_cast<std::uint32_t>(base + indices[i + k]);
      visit(t, primitive.material.value);
    }
    base += primitive.positions.size();
  }
}

struct Piece {
  std::uint64_t triangles = 0;
  Box3d box;
  std::uint32_t material = 0;  ///< of its first triangle
};

struct Pieces {
  std::vector<Piece> pieces;
  std::vector<std::uint32_t> of_triangle;  ///< by triangle, primitive by primitive

  /// O(n log n).
  explicit Pieces(const SourceMesh& mesh);

  /// By piece, whether it has at most `most_triangles` of the material of each of its triangles (by the scene's id; a
  /// material behind the last has 0).
  [[nodiscard]] std::vector<std::uint8_t> find_small(const SourceMesh& mesh,
                                                     std::span<const std::uint32_t> most_triangles) const;
};

/// Parts that share no vertex number: never fewer than there are pieces, and found without sorting positions.
[[nodiscard]] std::size_t count_parts_by_vertex(const SourceMesh& mesh);

}  // namespace meshlode::scene
