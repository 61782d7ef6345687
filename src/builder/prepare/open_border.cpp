// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/open_border.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace meshlode::builder {

namespace {

template <class Point>
auto as_tuple(const Point& p) {
  return std::tuple(p.x, p.y, p.z);
}

template <class Point>
bool precedes(const Point& p, const Point& q) {
  return as_tuple(p) < as_tuple(q);
}

/// Vertices in use as numbers of their exact positions, and one vertex of each number.
struct Names {
  std::vector<std::uint32_t> of_vertex, vertex_of;
};

Names name_positions(const Corners& corners, const std::vector<std::uint8_t>& is_used) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v] != 0) order.push_back(v);
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return precedes(corners.positions[a], corners.positions[b]); });
  Names names;
  names.of_vertex.resize(is_used.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || corners.positions[order[i]] != corners.positions[order[i - 1]];
    if (is_new) names.vertex_of.push_back(order[i]);
    names.of_vertex[order[i]] = static_cast<std::uint32_t>(names.vertex_of.size() - 1);
  }
  return names;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Both ways alike, of triangles that differ in a corner or in their side.
std::vector<Edge> sorted_edges(const Corners& corners, const Names& names) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t c = 0; c < corners.triangles.size(); c += 3) {
    std::array<std::uint32_t, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = names.of_vertex[corners.triangles[c + k]];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

std::vector<std::uint8_t> find_open_border(const Corners& corners, const std::vector<std::uint8_t>& is_used,
                                           std::span<const Vec3i> points, std::span<const Vec3i> positions) {
  const Names names = name_positions(corners, is_used);
  const std::vector<Edge> edges = sorted_edges(corners, names);
  std::vector<Vec3i> border;
  for (std::size_t i = 0; i < edges.size();) {
    const std::size_t first = i;
    while (i < edges.size() && edges[i] == edges[first]) ++i;
    if (i - first > 1) continue;
    border.push_back(points[names.vertex_of[edges[first].first]]);
    border.push_back(points[names.vertex_of[edges[first].second]]);
  }
  std::sort(border.begin(), border.end(), precedes<Vec3i>);
  std::vector<std::uint8_t> is_border(positions.size(), 0);
  for (std::size_t p = 0; p < positions.size(); ++p) {
    is_border[p] = std::binary_search(border.begin(), border.end(), positions[p], precedes<Vec3i>) ? 1 : 0;
  }
  return is_border;
}

}  // namespace meshlode::builder
