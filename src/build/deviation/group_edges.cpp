// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/deviation/group_edges.h"

#include <algorithm>

#include "base/id_table.h"
#include "base/ids.h"

namespace meshlode::build {

GroupEdges::GroupEdges(const GroupSurface& group)
    : of_triangle(group.triangles.size()), is_border_position(group.positions.size(), 0) {
  // Edges are numbered in the order of the triangles.
  IdTable table(3 * group.triangles.size());
  std::vector<std::uint64_t> keys;
  keys.reserve(2 * group.triangles.size());
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = group.triangles[t][k], b = group.triangles[t][(k + 1) % 3];
      const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32U | std::max(a, b);
      const auto [edge, is_new] = table.find_or_insert(
          hash_word(0, key), static_cast<std::uint32_t>(keys.size()), [&](std::uint32_t e) { return keys[e] == key; },
          [&](std::uint32_t e) { return hash_word(0, keys[e]); });
      if (is_new) {
        keys.push_back(key);
        use_count.push_back(0);
      }
      of_triangle[t][k] = edge;
      ++use_count[edge];
    }
  }
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_border(static_cast<std::uint32_t>(t), k)) continue;
      is_border_position[group.triangles[t][k]] = 1;
      is_border_position[group.triangles[t][(k + 1) % 3]] = 1;
    }
  }
}

std::vector<std::uint8_t> find_folded(const GroupSurface& surface, const GroupEdges& edges) {
  std::vector<Vec3d> normals;
  normals.reserve(surface.triangles.size());
  for (const auto& t : surface.triangles) {
    const Vec3d& p = surface.positions[t[0]];
    normals.push_back(glm::cross(surface.positions[t[1]] - p, surface.positions[t[2]] - p));
  }
  std::vector<std::uint32_t> first(edges.use_count.size(), kNoId);
  std::vector<std::uint8_t> is_folded(surface.triangles.size(), 0);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    for (const std::uint32_t edge : edges.of_triangle[t]) {
      if (edges.use_count[edge] != 2) {
        is_folded[t] = 1;
      } else if (first[edge] == kNoId) {
        first[edge] = t;
      } else {
        const Vec3d &m = normals[first[edge]], &n = normals[t];
        const double dot = glm::dot(m, n);
        if (!(dot > 0.0 && dot * dot > 0.25 * glm::dot(m, m) * glm::dot(n, n)))
          is_folded[t] = is_folded[first[edge]] = 1;
      }
    }
  }
  return is_folded;
}

}  // namespace meshlode::build
