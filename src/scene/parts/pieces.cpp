// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/parts/pieces.h"

#include <algorithm>
#include <numeric>

#include "base/disjoint_sets.h"

namespace meshlode::scene {

namespace {

bool is_before(const Vec3d& a, const Vec3d& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

}  // namespace

Pieces::Pieces(const SourceMesh& mesh) {
  std::vector<Vec3d> positions;
  for (const Primitive& primitive : mesh.primitives) {
    positions.insert(positions.end(), primitive.positions.begin(), primitive.positions.end());
  }
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (is_before(positions[a], positions[b])) return true;
    return !is_before(positions[b], positions[a]) && a < b;
  });
  DisjointSets sets(positions.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (positions[order[i - 1]] == positions[order[i]]) sets.join(order[i - 1], order[i]);
  }
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& t, std::uint32_t) {
    sets.join(t[0], t[1]);
    sets.join(t[1], t[2]);
  });
  std::vector<std::uint32_t> piece_of(positions.size(), kNoId);
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& t, std::uint32_t material) {
    std::uint32_t& number = piece_of[sets.find(t[0])];
    if (number == kNoId) {
      number = static_cast<std::uint32_t>(pieces.size());
      pieces.push_back({0, {}, material});
    }
    of_triangle.push_back(number);
    Piece& piece = pieces[number];
    ++piece.triangles;
    for (const std::uint32_t v : t) piece.box.add(positions[v]);
  });
}

std::size_t count_parts_by_vertex(const SourceMesh& mesh) {
  std::size_t vertices = 0, parts = 0;
  for (const Primitive& primitive : mesh.primitives) vertices += primitive.positions.size();
  DisjointSets sets(vertices);
  std::vector<std::uint8_t> is_used(vertices, 0);
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& t, std::uint32_t) {
    for (const std::uint32_t v : t) {
      parts += is_used[v] == 0 ? 1U : 0U;
      is_used[v] = 1;
    }
    parts -= sets.join(t[0], t[1]) ? 1U : 0U;
    parts -= sets.join(t[1], t[2]) ? 1U : 0U;
  });
  return parts;
}

std::vector<std::uint8_t> Pieces::find_small(const SourceMesh& mesh,
                                             std::span<const std::uint32_t> most_triangles) const {
  std::vector<std::uint8_t> is_small(pieces.size(), 1);
  std::size_t next = 0;
  for_each_triangle(mesh, [&](const auto&, std::uint32_t material) {
    const std::uint32_t piece = of_triangle[next++];
    const std::uint32_t most = material < most_triangles.size() ? most_triangles[material] : 0;
    if (pieces[piece].triangles > most) is_small[piece] = 0;
  });
  return is_small;
}

}  // namespace meshlode::scene
