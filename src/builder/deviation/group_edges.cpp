// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/group_edges.h"

#include <algorithm>

#include "base/ids.h"

namespace meshlode::builder {

GroupEdges::GroupEdges(const GroupSurface& group)
    : of_triangle(group.triangles.size()), is_border_position(group.positions.size(), 0) {
  // Edges are numbered in the order of the triangles. Those with the same lower end are a list, the latest first: most
  // are three, and around a hub what was met last is mostly met next.
  struct Listed {
    std::uint32_t higher_end, before;
  };
  std::vector<std::uint32_t> latest(group.positions.size(), kNoId);
  std::vector<Listed> listed;
  listed.reserve(2 * group.triangles.size());
  use_count.reserve(2 * group.triangles.size());
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = group.triangles[t][k], b = group.triangles[t][(k + 1) % 3];
      const std::uint32_t low = std::min(a, b), high = std::max(a, b);
      std::uint32_t edge = latest[low];
      while (edge != kNoId && listed[edge].higher_end != high) edge = listed[edge].before;
      if (edge == kNoId) {
        edge = static_cast<std::uint32_t>(listed.size());
        listed.push_back({high, latest[low]});
        latest[low] = edge;
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

}  // namespace meshlode::builder
