// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace meshlode {
namespace {

constexpr std::uint32_t kLeafSize = 4;
// Below this sine at its sharpest corners a triangle is taken as its edges: its normal would be mostly rounding, and
// its inside is this close to an edge, relative to its length.
constexpr double kNeedleSine = 1e-8;

// Squared distance from the origin to the segment a-b.
double distance2_to_segment(const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double dd = glm::dot(d, d);
  const double t = dd > 0.0 ? std::clamp(-glm::dot(a, d) / dd, 0.0, 1.0) : 0.0;
  const Vec3d n = a + d * t;
  return glm::dot(n, n);
}

}  // namespace

double distance2_to_triangle(const Vec3d& p, const Vec3d& corner_a, const Vec3d& corner_b, const Vec3d& corner_c) {
  // Relative to the point: a far-away pair keeps the digits of its difference.
  const Vec3d a = corner_a - p, b = corner_b - p, c = corner_c - p;
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const Vec3d n = glm::cross(ab, -ca);
  const double nn = glm::dot(n, n);
  const double longest2 = std::max(glm::dot(ab, ab), std::max(glm::dot(bc, bc), glm::dot(ca, ca)));
  if (nn > kNeedleSine * kNeedleSine * longest2 * longest2) {
    const bool is_over = glm::dot(glm::cross(ab, -a), n) >= 0.0 && glm::dot(glm::cross(bc, -b), n) >= 0.0 &&
                         glm::dot(glm::cross(ca, -c), n) >= 0.0;
    if (is_over) {
      const double h = glm::dot(a, n);
      return h * h / nn;
    }
  }
  return std::min(distance2_to_segment(a, b), std::min(distance2_to_segment(b, c), distance2_to_segment(c, a)));
}

TriangleTree::TriangleTree(const Surface& surface) {
  const std::uint32_t count = static_cast<std::uint32_t>(surface.triangles.size());
  if (count == 0) return;
  std::vector<Vec3d> centers(count);
  triangle_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& t = surface.triangles[i];
    centers[i] = (surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]]) / 3.0;
    triangle_[i] = i;
  }
  nodes_.reserve(2 * std::size_t{count});
  nodes_.emplace_back();
  split(0, centers, 0, count);
  corners_.resize(count);
  place_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& t = surface.triangles[triangle_[i]];
    corners_[i] = {surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]};
    place_[triangle_[i]] = i;
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children lie behind their node
    Node& node = nodes_[n];
    if (node.count == 0) {
      node.low = glm::min(nodes_[node.first].low, nodes_[node.first + 1].low);
      node.high = glm::max(nodes_[node.first].high, nodes_[node.first + 1].high);
      continue;
    }
    node.low = node.high = corners_[node.first].a;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      for (const Vec3d& v : {corners_[i].a, corners_[i].b, corners_[i].c}) {
        node.low = glm::min(node.low, v);
        node.high = glm::max(node.high, v);
      }
    }
  }
}

void TriangleTree::split(std::uint32_t node, std::vector<Vec3d>& centers, std::uint32_t first, std::uint32_t count) {
  if (count <= kLeafSize) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  Vec3d low = centers[triangle_[first]], high = low;
  for (std::uint32_t i = first; i < first + count; ++i) {
    low = glm::min(low, centers[triangle_[i]]);
    high = glm::max(high, centers[triangle_[i]]);
  }
  const Vec3d extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  const auto begin = triangle_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
  });
  const std::uint32_t left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = left;
  nodes_.resize(nodes_.size() + 2);
  split(left, centers, first, half);  // depth: log2 of the triangle count
  split(left + 1, centers, first + half, count - half);
}

double TriangleTree::distance2_to_box(const Node& node, const Vec3d& p) const {
  const Vec3d outside = glm::max(glm::max(node.low - p, p - node.high), Vec3d(0.0));
  return glm::dot(outside, outside);
}

NearestPoint TriangleTree::nearest(const Vec3d& point, std::uint32_t hint) const {
  NearestPoint best;
  if (nodes_.empty()) return best;
  const auto try_triangle = [&](std::uint32_t i) {
    const double d = distance2_to_triangle(point, corners_[i].a, corners_[i].b, corners_[i].c);
    if (d < best.distance2) best = {d, triangle_[i]};
  };
  if (hint < place_.size()) try_triangle(place_[hint]);
  struct Entry {
    std::uint32_t node;
    double distance2;
  };
  std::array<Entry, 64> stack;  // median splits: the depth is below 32
  std::size_t size = 0;
  stack[size++] = {0, distance2_to_box(nodes_[0], point)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.distance2 >= best.distance2) continue;
    const Node& node = nodes_[entry.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) try_triangle(i);
      continue;
    }
    Entry near{node.first, distance2_to_box(nodes_[node.first], point)};
    Entry far{node.first + 1, distance2_to_box(nodes_[node.first + 1], point)};
    if (far.distance2 < near.distance2) std::swap(near, far);
    if (far.distance2 < best.distance2) stack[size++] = far;
    if (near.distance2 < best.distance2) stack[size++] = near;
  }
  return best;
}

void TriangleTree::find_within(const Vec3d& point, double distance2, std::vector<NearestPoint>& found) const {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    if (distance2_to_box(node, point) > distance2) continue;
    if (node.count == 0) {
      stack[size++] = node.first;
      stack[size++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const double d = distance2_to_triangle(point, corners_[i].a, corners_[i].b, corners_[i].c);
      if (d <= distance2) found.push_back({d, triangle_[i]});
    }
  }
}

}  // namespace meshlode
