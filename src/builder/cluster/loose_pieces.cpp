// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/loose_pieces.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/box.h"
#include "base/local_ids.h"

namespace meshlode::builder {

namespace {

/// A place that triangles of one piece have a corner at, and the first of them.
struct PieceCorner {
  glm::i64vec3 place;
  std::uint32_t piece, triangle;
};

/// Each once, by their first triangles: a corner is met by six triangles, and asked about once. Of pieces that have
/// `fewest` triangles at least.
std::vector<PieceCorner> corners_of_pieces(std::span<const std::array<std::uint32_t, 3>> corner_positions,
                                           std::span<const Vec3i> positions, const std::vector<std::uint32_t>& piece,
                                           const std::vector<std::uint32_t>& size, std::uint32_t fewest) {
  LocalIds ids(corner_positions.size());
  std::vector<std::uint32_t> last_piece;  // by local id of a position: that it was met with last, mostly the only one
  std::vector<PieceCorner> corners;
  corners.reserve(corner_positions.size());
  for (std::uint32_t t = 0; t < piece.size(); ++t) {
    if (size[piece[t]] < fewest) continue;
    for (const std::uint32_t corner : corner_positions[t]) {
      const std::uint32_t id = ids.add(corner);
      if (id == last_piece.size()) last_piece.push_back(kNoId);
      if (std::exchange(last_piece[id], piece[t]) == piece[t]) continue;
      corners.push_back({glm::i64vec3(positions[corner]), piece[t], t});
    }
  }
  return corners;
}

}  // namespace

std::vector<TriangleLink> link_to_nearest(std::span<const std::array<std::uint32_t, 3>> corner_positions,
                                          std::span<const Vec3i> positions, const std::vector<std::uint32_t>& piece,
                                          std::uint32_t piece_count) {
  constexpr std::size_t kProbes = 4;  // triangles of a piece that look for a neighbour
  std::vector<std::vector<std::uint32_t>> probes(piece_count);
  std::vector<std::uint32_t> size(piece_count, 0);
  for (std::uint32_t t = 0; t < piece.size(); ++t) {
    if (probes[piece[t]].size() < kProbes) probes[piece[t]].push_back(t);
    ++size[piece[t]];
  }
  const auto largest = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const std::vector<PieceCorner> corners =
      corners_of_pieces(corner_positions, positions, piece, size, size[largest] > kDebris ? kDebris + 1 : 1);
  std::vector<TriangleLink> links;
  std::vector<std::uint32_t> asked;  // corners of the piece: the next triangle has two of them again
  for (std::uint32_t p = 0; p < piece_count; ++p) {
    if (p == largest) continue;
    std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
    TriangleLink link{};
    asked.clear();
    for (const std::uint32_t mine : probes[p]) {
      for (const std::uint32_t corner : corner_positions[mine]) {
        if (std::find(asked.begin(), asked.end(), corner) != asked.end()) continue;
        asked.push_back(corner);
        const glm::i64vec3 from(positions[corner]);
        for (const PieceCorner& other : corners) {
          if (other.piece == p) continue;
          const glm::i64vec3 apart = other.place - from;
          const std::int64_t distance2 = apart.x * apart.x + apart.y * apart.y + apart.z * apart.z;
          if (distance2 >= nearest) continue;
          nearest = distance2;
          link = {mine, other.triangle};
        }
      }
    }
    links.push_back(link);
  }
  return links;
}

Clustering cluster_pieces(std::span<const WedgeTriangle> triangles, std::span<const std::uint32_t> wedge_position,
                          std::span<const Vec3i> positions, const std::vector<std::uint32_t>& piece,
                          std::uint32_t piece_count, std::size_t parts) {
  // Centres as means of corners in doubles: sums of integers below 2^53, so they are exact before the division.
  std::vector<Vec3d> center(piece_count, Vec3d(0.0));
  std::vector<std::uint32_t> corner_count(piece_count, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t wedge : triangles[t]) center[piece[t]] += Vec3d(positions[wedge_position[wedge]]);
    corner_count[piece[t]] += 3;
  }
  for (std::uint32_t p = 0; p < piece_count; ++p) center[p] /= corner_count[p];

  struct Range {
    std::size_t begin, end, parts;
  };
  Clustering clustering;
  clustering.label.assign(triangles.size(), 0);
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<Range> stack{{0, order.size(), parts}};
  while (!stack.empty()) {
    const Range range = stack.back();
    stack.pop_back();
    if (range.parts <= 1) {
      for (std::size_t i = range.begin; i < range.end; ++i) clustering.label[order[i]] = clustering.count;
      ++clustering.count;
      continue;
    }
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(range.begin);
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(range.end);
    Box3d box;
    for (auto it = begin; it != end; ++it) box.add(center[piece[*it]]);
    const int axis = box.longest_axis();
    const std::size_t left_parts = range.parts / 2;
    const std::size_t left = (range.end - range.begin) * left_parts / range.parts;
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(left), end, [&](std::uint32_t a, std::uint32_t b) {
      const double x = center[piece[a]][axis];
      const double y = center[piece[b]][axis];
      if (x != y) return x < y;
      return piece[a] != piece[b] ? piece[a] < piece[b] : a < b;
    });
    stack.push_back({range.begin + left, range.end, range.parts - left_parts});
    stack.push_back({range.begin, range.begin + left, left_parts});
  }
  return clustering;
}

}  // namespace meshlode::builder
