// SPDX-License-Identifier: GPL-3.0-or-later
// The pieces of a mesh, parts of its surface that share no position, and the cards that they count as.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/alpha_test.h"
#include "builder/aggregate/card.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// What a material lets through, and what stands for it.
struct SourceMaterial {
  AlphaTest covers;
  std::uint32_t uv_set = 0;  ///< TEXCOORD_n that `covers` is asked with
  std::uint32_t coarse = 0;  ///< material of what stands for it: opaque, double sided and without texture
};

/// Lists by piece: those of piece p are items[first[p]] to items[first[p + 1] - 1].
struct ByPiece {
  std::vector<std::uint32_t> first, items;
  [[nodiscard]] std::size_t size() const { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t piece) const {
    return {items.data() + first[piece], first[piece + 1] - first[piece]};
  }
};

/// Of a triangle as level 0 draws it: on the grid, where thin pieces may have another area than in the source. Levels
/// are to cover what level 0 does.
[[nodiscard]] Corners corners_of(const PreparedMesh& mesh, std::size_t triangle);

/// Triangles by piece, each list ascending; pieces by their first triangle.
[[nodiscard]] ByPiece find_pieces(const PreparedMesh& mesh);

/// The cards of all pieces, in their order, with first[p] where those of piece p begin: none for a piece that is not
/// drawn anywhere, one for a flat piece, three in the middle planes of a bulky one. `materials`: by id.
struct PieceCards {
  Cards cards;
  std::vector<std::uint32_t> first;
  std::vector<std::uint8_t> is_closed;  ///< by triangle: of a closed piece all of whose triangles are drawn whole
};
[[nodiscard]] PieceCards make_cards(const PreparedMesh& mesh, const ByPiece& pieces,
                                    std::span<const SourceMaterial> materials);

/// Texture coordinates of a triangle's corners in the set that the material asks for; 0 where the mesh has not got it.
[[nodiscard]] std::array<Vec2d, 3> corner_uvs(const PreparedMesh& mesh, std::size_t triangle,
                                              const SourceMaterial& material);

}  // namespace meshlode::builder
