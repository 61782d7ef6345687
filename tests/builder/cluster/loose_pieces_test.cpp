// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/loose_pieces.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode::builder {
namespace {

using Corner3 = std::array<std::uint32_t, 3>;

/// The links as their definition has them: all corners of up to four triangles of a piece against all corners of all
/// triangles of others that are no debris, and of equals the first.
std::vector<TriangleLink> links_by_definition(const std::vector<Corner3>& triangles,
                                              const std::vector<Vec3i>& positions,
                                              const std::vector<std::uint32_t>& piece, std::uint32_t piece_count) {
  std::vector<std::uint32_t> size(piece_count, 0);
  for (const std::uint32_t p : piece) ++size[p];
  const auto largest = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<TriangleLink> links;
  for (std::uint32_t p = 0; p < piece_count; ++p) {
    if (p == largest) continue;
    auto nearest = std::numeric_limits<std::int64_t>::max();
    TriangleLink link{};
    int probes = 0;
    for (std::uint32_t mine = 0; mine < triangles.size() && probes < 4; ++mine) {
      if (piece[mine] != p) continue;
      ++probes;
      for (const std::uint32_t from : triangles[mine]) {
        for (std::uint32_t other = 0; other < triangles.size(); ++other) {
          if (piece[other] == p || (size[largest] > kDebris && size[piece[other]] <= kDebris)) continue;
          for (const std::uint32_t to : triangles[other]) {
            const glm::i64vec3 apart = glm::i64vec3(positions[to]) - glm::i64vec3(positions[from]);
            const std::int64_t distance2 = apart.x * apart.x + apart.y * apart.y + apart.z * apart.z;
            if (distance2 >= nearest) continue;
            nearest = distance2;
            link = {mine, other};
          }
        }
      }
    }
    links.push_back(link);
  }
  return links;
}

// On a grid so small that many distances are equal, with ids far apart and positions that pieces share.
TEST(LoosePieces, AreLinkedToTheFirstOfTheNearest) {
  SplitMix64 random(7);
  for (int round = 0; round < 200; ++round) {
    const auto draw = [&](std::uint32_t below) { return static_cast<std::uint32_t>(random.next() % below); };
    const std::uint32_t piece_count = 2 + draw(6), triangle_count = piece_count + draw(40);
    std::vector<Vec3i> positions(1000);
    for (Vec3i& p : positions) {
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<std::int32_t>(draw(6));
    }
    std::vector<Corner3> triangles(triangle_count);
    std::vector<std::uint32_t> piece(triangle_count);
    for (std::uint32_t t = 0; t < triangle_count; ++t) {
      piece[t] = t < piece_count ? t : draw(piece_count);
      for (std::uint32_t& corner : triangles[t]) corner = 37 * draw(25);
    }
    EXPECT_EQ(link_to_nearest(triangles, positions, piece, piece_count),
              links_by_definition(triangles, positions, piece, piece_count))
        << "round " << round;
  }
}

}  // namespace
}  // namespace meshlode::builder
