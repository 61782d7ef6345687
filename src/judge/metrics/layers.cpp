// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/layers.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace meshlode::judge {
namespace {

/// -1, 0 or 1; unknown values are equal to each other.
template <class Vector>
int compare_values(const Vector& a, const Vector& b) {
  for (int k = 0; k < Vector::length(); ++k) {
    if (a[k] < b[k]) return -1;
    if (b[k] < a[k]) return 1;
    if (a[k] == b[k]) continue;
    const bool is_a = a[k] == a[k], is_b = b[k] == b[k];
    if (is_a != is_b) return is_a ? -1 : 1;
  }
  return 0;
}

int compare_vertices(const ShadedSurface& s, std::uint32_t a, std::uint32_t b) {
  int order = compare_values(s.surface.positions[a], s.surface.positions[b]);
  if (order == 0 && !s.normals.empty()) order = compare_values(s.normals[a], s.normals[b]);
  for (const std::vector<Vec2f>& set : s.uvs) {
    if (order == 0 && !set.empty()) order = compare_values(set[a], set[b]);
  }
  return order;
}

double distance2_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  const Vec3d rest = p - a - t * along;
  return glm::dot(rest, rest);
}

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

Layers::Layers(const ShadedSurface& s) : surface_(s.surface), same_(s.surface.positions.size()) {
  std::vector<std::uint32_t> order(same_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int compared = compare_vertices(s, a, b);
    return compared != 0 ? compared < 0 : a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && compare_vertices(s, order[i - 1], order[i]) == 0;
    same_[order[i]] = is_same ? same_[order[i - 1]] : order[i];
  }
}

void Layers::keep_first_of_each(const Vec3d& point, double reach, std::vector<NearestPoint>& found,
                                Scratch& scratch) const {
  if (found.size() < 2) return;
  scratch.joints.clear();
  scratch.layer_of.resize(found.size());
  for (std::uint32_t i = 0; i < found.size(); ++i) {
    scratch.layer_of[i] = i;
    const std::array<std::uint32_t, 3>& t = surface_.triangles[found[i].triangle];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3d &a = surface_.positions[t[k]], &b = surface_.positions[t[(k + 1) % 3]];
      const auto [low, high] = std::minmax(same_[t[k]], same_[t[(k + 1) % 3]]);
      if (distance2_to_segment(point, a, a) <= reach * reach) scratch.joints.push_back({same_[t[k]], same_[t[k]], i});
      if (distance2_to_segment(point, a, b) <= reach * reach) scratch.joints.push_back({low, high, i});
    }
  }
  std::sort(scratch.joints.begin(), scratch.joints.end(), [](const Scratch::Joint& a, const Scratch::Joint& b) {
    return std::tie(a.low, a.high, a.place) < std::tie(b.low, b.high, b.place);
  });
  for (std::size_t j = 1; j < scratch.joints.size(); ++j) {
    const Scratch::Joint &before = scratch.joints[j - 1], &joint = scratch.joints[j];
    if (joint.low != before.low || joint.high != before.high) continue;
    const std::uint32_t a = root_of(scratch.layer_of, before.place), b = root_of(scratch.layer_of, joint.place);
    scratch.layer_of[std::max(a, b)] = std::min(a, b);
  }
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < found.size(); ++i) {
    if (scratch.layer_of[i] == i) found[kept++] = found[i];
  }
  found.resize(kept);
}

}  // namespace meshlode::judge
