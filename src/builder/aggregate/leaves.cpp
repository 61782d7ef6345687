// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/leaves.h"

#include <algorithm>

#include "builder/aggregate/blocks.h"

namespace meshlode::builder {

Leaves make_leaves(const PreparedMesh& mesh, const ByPiece& pieces, const PieceCards& cards,
                   std::uint32_t leaf_triangles) {
  std::vector<Vec3d> centers(pieces.size());
  std::vector<std::uint32_t> weights(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    Vec3d sum(0.0);
    for (const std::uint32_t t : pieces.of(p)) {
      for (const Vec3d& corner : corners_of(mesh, t)) sum += corner;
    }
    weights[p] = static_cast<std::uint32_t>(pieces.of(p).size());
    centers[p] = sum / (3.0 * weights[p]);
  }
  Leaves leaves;
  while ((mesh.triangles.size() >> static_cast<unsigned>(leaves.depth)) > leaf_triangles) ++leaves.depth;
  const Blocks blocks = split_by_weight(centers, weights, leaves.depth);
  leaves.triangles.first.push_back(0);
  leaves.first_card.push_back(0);
  leaves.first_level.push_back(0);
  for (std::size_t leaf = 0; leaf < blocks.size(); ++leaf) {
    const auto in_leaf = blocks.of(leaf);
    std::vector<Vec3d> points;
    for (const std::uint32_t p : in_leaf) points.push_back(centers[p]);
    const Blocks order = points.empty() ? Blocks{} : split_evenly(points, points.size());
    for (const std::uint32_t place : order.order) {
      const std::uint32_t p = in_leaf[place];
      const auto triangles = pieces.of(p);
      leaves.triangles.items.insert(leaves.triangles.items.end(), triangles.begin(), triangles.end());
      for (std::uint32_t c = cards.first[p]; c < cards.first[p + 1]; ++c) leaves.cards.push_back(c);
    }
    leaves.triangles.first.push_back(static_cast<std::uint32_t>(leaves.triangles.items.size()));
    leaves.first_card.push_back(static_cast<std::uint32_t>(leaves.cards.size()));
    const std::size_t cards_of_leaf = leaves.first_card[leaf + 1] - leaves.first_card[leaf];
    const std::size_t half = (leaves.triangles.of(leaf).size() + 1) / 2;
    leaves.first_level.push_back(leaves.first_level.back() + std::min(cards_of_leaf, half));
  }
  return leaves;
}

}  // namespace meshlode::builder
