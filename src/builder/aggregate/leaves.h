// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of an aggregate in leaves: neighbours, of so many triangles that a finest group replaces them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/pieces.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Pieces in leaves, and the lists that follow from it.
struct Leaves {
  int depth = 0;
  ByPiece triangles;                      ///< of the source, by leaf
  std::vector<std::uint32_t> first_card;  ///< by leaf, into `cards`
  std::vector<std::uint32_t> cards;       ///< of PieceCards, in the order of leaves

  /// Before each leaf, how many triangles the leaves so far have in the first level: a card each, and of single
  /// triangles, which are one card already, half as many.
  std::vector<std::size_t> first_level;

  [[nodiscard]] std::size_t size() const { return triangles.size(); }
  [[nodiscard]] std::span<const std::uint32_t> cards_of(std::uint32_t first_leaf, std::uint32_t end_leaf) const {
    return {cards.data() + first_card[first_leaf], first_card[end_leaf] - first_card[first_leaf]};
  }
  [[nodiscard]] std::size_t triangle_count(std::uint32_t first_leaf, std::uint32_t end_leaf) const {
    return triangles.first[end_leaf] - triangles.first[first_leaf];
  }
};

[[nodiscard]] Leaves make_leaves(const PreparedMesh& mesh, const ByPiece& pieces, const PieceCards& cards,
                                 std::uint32_t leaf_triangles);

}  // namespace meshlode::builder
