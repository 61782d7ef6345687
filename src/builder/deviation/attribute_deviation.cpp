// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/attribute_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "base/parallel.h"
#include "builder/deviation/source_tree.h"

namespace meshlode::builder {

namespace {

constexpr double kDegrees = 57.295779513082320877;

/// Arcus sine in degrees by its series: nothing of a C library may decide a stored bit (I10). x in [0, 1].
double arc_sine_degrees(double x) {
  if (x > 0.5) return 90.0 - 2.0 * arc_sine_degrees(std::sqrt(std::max(0.0, (1.0 - x) / 2.0)));
  double term = x, sum = x;
  for (int n = 1; n < 24; ++n) {
    term *= x * x * static_cast<double>((2 * n - 1) * (2 * n - 1)) / static_cast<double>(2 * n * (2 * n + 1));
    sum += term;
  }
  return sum * kDegrees;
}

/// Barycentric coordinates.
using Weights = std::array<double, 3>;

/// Barycentric coordinates of the triangle's point nearest to `p`; without area its first corner.
Weights weights_of(const Vec3d& p, const TriangleCorners& corners) {
  const Vec3d ab = corners[1] - corners[0], ac = corners[2] - corners[0], ap = p - corners[0];
  const Vec3d n = glm::cross(ab, ac);
  const double nn = glm::dot(n, n);
  if (!(nn > 0.0)) return {1.0, 0.0, 0.0};
  const double c = glm::dot(glm::cross(ab, ap), n) / nn, b = glm::dot(glm::cross(ap, ac), n) / nn;
  if (b >= 0.0 && c >= 0.0 && b + c <= 1.0) return {1.0 - b - c, b, c};
  Weights best{};
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vec3d edge = corners[next] - corners[k], from = p - corners[k];
    const double length2 = glm::dot(edge, edge);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(from, edge) / length2, 0.0, 1.0) : 0.0;
    const Vec3d away = from - edge * t;
    if (!(glm::dot(away, away) < least2)) continue;
    least2 = glm::dot(away, away);
    best = {};
    best[k] = 1.0 - t;
    best[next] = t;
  }
  return best;
}

/// The attributes of one triangle at barycentric coordinates.
class Interpolator {
 public:
  Interpolator(const SurfaceAttributes& surface, std::size_t stride, std::uint32_t triangle) {
    const WedgeTriangle& t = surface.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) at_[k] = surface.wedge_attributes.data() + t[k] * stride;
  }
  [[nodiscard]] double value(std::size_t j, const Weights& w) const {
    return w[0] * double{at_[0][j]} + w[1] * double{at_[1][j]} + w[2] * double{at_[2][j]};
  }
  [[nodiscard]] Vec3d normal(const Weights& w) const {
    const Vec3d n(value(0, w), value(1, w), value(2, w));
    const double length = std::sqrt(glm::dot(n, n));
    return length > 0.0 ? n / length : n;
  }

 private:
  std::array<const float*, 3> at_{};
};

Vec3d point_at(const TriangleCorners& corners, const Weights& w) {
  return corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
}

TriangleCorners corners_of(const GroupSurface& group, std::uint32_t triangle) {
  const auto& ids = group.triangles[triangle];
  return {group.positions[ids[0]], group.positions[ids[1]], group.positions[ids[2]]};
}

/// A group's triangles chart by chart and by places in the source's tree: evenly spread, and one point's place is a
/// hint for the next.
std::vector<SurfacePart> order_triangles(const GroupSurface& group, const SurfaceAttributes& attributes,
                                         std::span<const TreeSlot> near) {
  struct Ordered {
    std::uint32_t chart, slot, triangle;
    [[nodiscard]] bool operator<(const Ordered& other) const {
      return std::tie(chart, slot, triangle) < std::tie(other.chart, other.slot, other.triangle);
    }
  };
  std::vector<Ordered> order;
  order.reserve(group.triangles.size());
  for (std::uint32_t t = 0; t < group.triangles.size(); ++t) {
    order.push_back({attributes.chart_of(t), near.empty() ? 0U : near[t].value, t});
  }
  std::sort(order.begin(), order.end());
  std::vector<SurfacePart> parts;
  parts.reserve(order.size());
  for (const Ordered& o : order) parts.push_back({o.triangle, kNoId, area_of(corners_of(group, o.triangle))});
  return parts;
}

/// How far the attributes of a point are from those of the one that it is compared with.
struct PointDrift {
  double normal2 = 0.0;
  std::array<double, scene::kMaxUvSets> uv{};
  bool is_known = false;
};

PointDrift drift_between(const Interpolator& ours, const Weights& here, const Interpolator& theirs,
                         const Weights& there, const AttributeLayout& layout) {
  PointDrift drift;
  drift.is_known = true;
  if (layout.has_normal) {
    const Vec3d off = ours.normal(here) - theirs.normal(there);
    drift.normal2 = glm::dot(off, off);
  }
  for (std::size_t s = 0; s < layout.uv_set_count; ++s) {
    const std::size_t j = layout.uv_offset() + 2 * s;
    const double u = ours.value(j, here) - theirs.value(j, there);
    const double v = ours.value(j + 1, here) - theirs.value(j + 1, there);
    drift.uv[s] = std::sqrt(u * u + v * v);
  }
  return drift;
}

/// Finds what is nearest to one point after another, each near to the one before it.
class NearOfChart {
 public:
  NearOfChart(const SurfaceTree& tree, const SurfaceAttributes& attributes) : tree_(tree), attributes_(attributes) {}

  /// Of `chart`; of all where that is kNoId.
  [[nodiscard]] TreeSlot find(const Vec3d& point, std::uint32_t chart, TreeSlot hint) {
    const Vec3f at = tree_.to_frame(point);
    SurfaceTree::Hit nearest;
    for (const TreeSlot slot : {last_, hint}) {
      if (slot.is_valid()) nearest = tree_.look_around(at, slot, nearest);
    }
    nearest = tree_.find_nearest(at, nearest, 0.0F);
    if (chart == kNoId || (nearest.slot.is_valid() && chart_at(nearest.slot) == chart)) return last_ = nearest.slot;
    return last_ = find_of(at, chart);
  }

 private:
  [[nodiscard]] std::uint32_t chart_at(TreeSlot slot) const { return attributes_.chart_of(tree_.triangle_at(slot)); }
  [[nodiscard]] TreeSlot find_of(const Vec3f& at, std::uint32_t chart) const {
    const auto is_of_chart = [&](std::uint32_t triangle) { return attributes_.chart_of(triangle) == chart; };
    SurfaceTree::Hit best;
    if (last_.is_valid()) best = tree_.look_around_of(at, last_, best, is_of_chart);
    return tree_.find_nearest_of(at, best, is_of_chart).slot;
  }

  const SurfaceTree& tree_;
  const SurfaceAttributes& attributes_;
  TreeSlot last_;
};

/// What kCovered of the points do not exceed, in the set that is farthest off: beside seams and where a corner moved
/// the farthest a few points are off by much more than all others, and a maximum would be theirs alone.
double upper_uv(std::span<const PointDrift> drifts, std::size_t uv_set_count) {
  constexpr double kCovered = 0.95;
  double worst = 0.0;
  std::vector<double> errors;
  for (std::size_t s = 0; s < uv_set_count; ++s) {
    errors.clear();
    for (const PointDrift& drift : drifts) {
      if (drift.is_known) errors.push_back(drift.uv[s]);
    }
    if (errors.empty()) continue;
    const auto within = static_cast<std::size_t>(std::ceil(kCovered * static_cast<double>(errors.size())));
    const auto at = errors.begin() + static_cast<std::ptrdiff_t>(within - 1);
    std::nth_element(errors.begin(), at, errors.end());
    worst = std::max(worst, *at);
  }
  return worst;
}

/// Points that one thread compares, each near to the one before.
constexpr std::size_t kPointsOfChunk = 64;

}  // namespace

std::array<double, 3> shares_of(std::uint32_t number) {
  const auto part = [&](double step) {
    const double x = 0.5 + step * number;
    return x - std::floor(x);
  };
  const double b = part(0.7548776662466927), c = part(0.5698402909980532);  // 1/g and 1/g^2, g^3 = g + 1
  return b + c <= 1.0 ? Weights{1.0 - b - c, b, c} : Weights{b + c - 1.0, 1.0 - b, 1.0 - c};
}

std::vector<SurfacePart> spread_points(std::span<const SurfacePart> parts, std::uint32_t count) {
  double total = 0.0;
  for (const SurfacePart& part : parts) total += part.area;
  std::vector<SurfacePart> points;
  if (!(total > 0.0)) return points;
  points.reserve(count);
  const double step = total / static_cast<double>(count);
  double passed = 0.0;
  for (const SurfacePart& part : parts) {
    passed += part.area;
    while (points.size() < count && (static_cast<double>(points.size()) + 0.5) * step <= passed) {
      const auto number = static_cast<std::uint32_t>(points.size());
      points.push_back({part.triangle, part.number == kNoId ? number : part.number, step});
    }
  }
  return points;
}

double area_of(const TriangleCorners& corners) {
  const Vec3d cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  return std::sqrt(glm::dot(cross, cross));
}

AttributeDeviation measure_attributes(const SourceTree& source, const SurfaceAttributes& source_attributes,
                                      const GroupSurface& group, const SurfaceAttributes& group_attributes,
                                      const AttributeLayout& layout, std::span<const TreeSlot> near) {
  const SurfaceTree& tree = source.impl().tree;
  if ((!layout.has_normal && layout.uv_set_count == 0) || tree.size() == 0) return {};
  const std::vector<SurfacePart> points = spread_points(order_triangles(group, group_attributes, near),
                                                        layout.uv_set_count > 0 ? kPointsForUvs : kPointsForNormals);
  if (points.empty()) return {};
  std::vector<PointDrift> drifts(points.size());
  parallel_for_each_chunk(points.size(), kPointsOfChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
    NearOfChart nearest(tree, source_attributes);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t t = points[i].triangle;
      const Weights here = shares_of(points[i].number);
      const Vec3d at = point_at(corners_of(group, t), here);
      const TreeSlot slot = nearest.find(at, group_attributes.chart_of(t), near.empty() ? TreeSlot() : near[t]);
      if (!slot.is_valid()) continue;
      drifts[i] = drift_between({group_attributes, layout.stride(), t}, here,
                                {source_attributes, layout.stride(), tree.triangle_at(slot)},
                                weights_of(at, tree.corners_at(slot)), layout);
    }
  });
  double normal2 = 0.0;
  for (const PointDrift& drift : drifts) normal2 += drift.normal2;
  const double chord = std::sqrt(normal2 / static_cast<double>(points.size()));
  return {2.0 * arc_sine_degrees(std::min(1.0, 0.5 * chord)), upper_uv(drifts, layout.uv_set_count)};
}

SourceDeviation measure_uvs_from_source(const SourceTree& source, const SurfaceAttributes& source_attributes,
                                        std::span<const SurfacePart> parts, const GroupSurface& group,
                                        const SurfaceAttributes& group_attributes, const AttributeLayout& layout) {
  SurfaceTree tree;
  tree.build({group.positions, group.triangles});
  std::vector<std::uint32_t> charts;  // that the group has
  for (std::uint32_t t = 0; t < group.triangles.size(); ++t) charts.push_back(group_attributes.chart_of(t));
  std::sort(charts.begin(), charts.end());
  charts.erase(std::unique(charts.begin(), charts.end()), charts.end());
  SourceDeviation found;
  found.points = spread_points(parts, kPointsForUvs);
  found.near.resize(found.points.size(), kNoId);
  std::vector<PointDrift> drifts(found.points.size());
  parallel_for_each_chunk(drifts.size(), kPointsOfChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
    NearOfChart nearest(tree, group_attributes);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t t = found.points[i].triangle, chart = source_attributes.chart_of(t);
      const Weights here = shares_of(found.points[i].number);
      const Vec3d at = point_at(source.impl().corners(t), here);
      const bool has_chart = std::binary_search(charts.begin(), charts.end(), chart);
      const TreeSlot slot = nearest.find(at, has_chart ? chart : kNoId, {});
      if (!slot.is_valid()) continue;
      found.near[i] = tree.triangle_at(slot);
      drifts[i] = drift_between({source_attributes, layout.stride(), t}, here,
                                {group_attributes, layout.stride(), found.near[i]},
                                weights_of(at, tree.corners_at(slot)), layout);
    }
  });
  found.uv = upper_uv(drifts, layout.uv_set_count);
  return found;
}

}  // namespace meshlode::builder
