// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/attribute_deviation.h"

#include <algorithm>
#include <cmath>
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

struct Weights {
  double a = 0.0, b = 0.0, c = 0.0;
};

/// Barycentric coordinates of the triangle's point nearest to the foot of `p` on its plane: clamped and renormalized,
/// which is exact inside and near enough on the edge where the surface ends.
Weights weights_of(const Vec3d& p, const TriangleCorners& corners) {
  const Vec3d ab = corners[1] - corners[0], ac = corners[2] - corners[0], ap = p - corners[0];
  const Vec3d n = glm::cross(ab, ac);
  const double nn = glm::dot(n, n);
  if (!(nn > 0.0)) return {1.0, 0.0, 0.0};
  Weights w;
  w.c = std::max(0.0, glm::dot(glm::cross(ab, ap), n) / nn);
  w.b = std::max(0.0, glm::dot(glm::cross(ap, ac), n) / nn);
  w.a = std::max(0.0, 1.0 - w.b - w.c);
  const double sum = w.a + w.b + w.c;
  return {w.a / sum, w.b / sum, w.c / sum};
}

/// The attributes of one triangle at barycentric coordinates.
class Interpolator {
 public:
  Interpolator(const SurfaceAttributes& surface, std::size_t stride, std::uint32_t triangle) {
    const WedgeTriangle& t = surface.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) at_[k] = surface.wedge_attributes.data() + t[k] * stride;
  }
  [[nodiscard]] double value(std::size_t j, const Weights& w) const {
    return w.a * static_cast<double>(at_[0][j]) + w.b * static_cast<double>(at_[1][j]) +
           w.c * static_cast<double>(at_[2][j]);
  }
  [[nodiscard]] Vec3d normal(const Weights& w) const {
    const Vec3d n(value(0, w), value(1, w), value(2, w));
    const double length = std::sqrt(glm::dot(n, n));
    return length > 0.0 ? n / length : n;
  }

 private:
  std::array<const float*, 3> at_{};
};

struct UvError {
  double error, area;
};

/// What kCovered of the area does not exceed. Beside a seam the nearest point of the source may lie on the other side
/// of it, in another island: such points are few, and their jumps say nothing of the texture's drift.
double upper_value(std::vector<UvError>& errors) {
  constexpr double kCovered = 0.95;
  std::sort(errors.begin(), errors.end(), [](const UvError& a, const UvError& b) {
    return a.error != b.error ? a.error < b.error : a.area < b.area;
  });
  double total = 0.0, below = 0.0;
  for (const UvError& e : errors) total += e.area;
  for (const UvError& e : errors) {
    below += e.area;
    if (below >= kCovered * total) return e.error;
  }
  return 0.0;
}

/// A point of the group that is compared.
struct PaintedPoint {
  std::uint32_t triangle;
  Vec3d at;
  Weights weights;
  double area;  ///< twice the triangle's
};

/// Three of each triangle, or one, each of the three in its turn.
std::vector<PaintedPoint> choose_points(const GroupSurface& group) {
  constexpr std::array<Weights, 3> kPoints{
      {{2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}}};
  const bool is_large = group.triangles.size() > kFewTriangles;
  std::vector<PaintedPoint> points;
  points.reserve((is_large ? 1 : 3) * group.triangles.size());
  for (std::uint32_t t = 0; t < group.triangles.size(); ++t) {
    const auto& ids = group.triangles[t];
    const TriangleCorners corners{group.positions[ids[0]], group.positions[ids[1]], group.positions[ids[2]]};
    const Vec3d cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double area = std::sqrt(glm::dot(cross, cross));
    if (!(area > 0.0)) continue;
    for (std::size_t i = 0; i < kPoints.size(); ++i) {
      if (is_large && i != t % 3) continue;
      const Weights& w = kPoints[i];
      points.push_back({t, corners[0] * w.a + corners[1] * w.b + corners[2] * w.c, w, area});
    }
  }
  return points;
}

/// How far the attributes of a point are from those of the nearest one of the source.
struct PointDrift {
  double normal2 = 0.0;
  std::array<double, scene::kMaxUvSets> uv{};
  bool is_known = false;
};

/// The two surfaces and what they carry.
struct PaintedSurfaces {
  const SurfaceTree& source;
  const SurfaceAttributes &source_attributes, &group_attributes;
  const AttributeLayout& layout;

  [[nodiscard]] PointDrift drift_of(const PaintedPoint& point, TreeSlot nearest) const {
    PointDrift drift;
    drift.is_known = true;
    const Interpolator ours(group_attributes, layout.stride(), point.triangle);
    const Interpolator theirs(source_attributes, layout.stride(), source.triangle_at(nearest));
    const Weights there = weights_of(point.at, source.corners_at(nearest));
    if (layout.has_normal) {
      const Vec3d off = ours.normal(point.weights) - theirs.normal(there);
      drift.normal2 = glm::dot(off, off);
    }
    for (std::size_t s = 0; s < layout.uv_set_count; ++s) {
      const std::size_t j = layout.uv_offset() + 2 * s;
      const double u = ours.value(j, point.weights) - theirs.value(j, there);
      const double v = ours.value(j + 1, point.weights) - theirs.value(j + 1, there);
      drift.uv[s] = std::sqrt(u * u + v * v);
    }
    return drift;
  }
};

}  // namespace

AttributeDeviation measure_attributes(const SourceTree& source, const SurfaceAttributes& source_attributes,
                                      const GroupSurface& group, const SurfaceAttributes& group_attributes,
                                      const AttributeLayout& layout, std::span<const TreeSlot> near) {
  const SurfaceTree& tree = source.impl().tree;
  if ((!layout.has_normal && layout.uv_set_count == 0) || tree.size() == 0) return {};
  const std::vector<PaintedPoint> points = choose_points(group);
  const PaintedSurfaces surfaces{tree, source_attributes, group_attributes, layout};
  std::vector<PointDrift> drifts(points.size());
  // Side by side where each point knows its place; else one leads to the next.
  const std::size_t chunk = near.empty() ? std::max<std::size_t>(1, points.size()) : 64;
  parallel_for_each_chunk(points.size(), chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
    TreeSlot place{0U};
    for (std::size_t i = begin; i < end; ++i) {
      if (!near.empty()) place = near[points[i].triangle];
      const Vec3f at = tree.to_frame(points[i].at);
      const SurfaceTree::Hit hit = tree.find_nearest(at, tree.look_around(at, place, {}), 0.0F);
      if (!hit.slot.is_valid()) continue;
      place = hit.slot;
      drifts[i] = surfaces.drift_of(points[i], place);
    }
  });
  double total = 0.0, normal2 = 0.0;
  std::array<std::vector<UvError>, scene::kMaxUvSets> uv_errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    total += points[i].area;
    if (!drifts[i].is_known) continue;
    normal2 += points[i].area * drifts[i].normal2;
    for (std::size_t s = 0; s < layout.uv_set_count; ++s) uv_errors[s].push_back({drifts[i].uv[s], points[i].area});
  }
  if (!(total > 0.0)) return {};
  AttributeDeviation result;
  result.normal = 2.0 * arc_sine_degrees(std::min(1.0, 0.5 * std::sqrt(normal2 / total)));
  for (std::vector<UvError>& errors : uv_errors) result.uv = std::max(result.uv, upper_value(errors));
  return result;
}

}  // namespace meshlode::builder
