// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/hierarchy/culling_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "builder/hierarchy/margins.h"

namespace meshlode::builder {
namespace {

// Twice the area vector of a triangle, in grid units. Coordinates have at most 24 bits, so differences have 25,
// products 50 and the result 51: exact in doubles.
Vec3d area_vector(const LodDag& dag, const DagCluster& cluster, std::uint32_t triangle) {
  const auto& t = dag.triangles[triangle];
  const Vec3d a(dag.vertex_position[cluster.first_vertex + t[0]]);
  const Vec3d u = Vec3d(dag.vertex_position[cluster.first_vertex + t[1]]) - a;
  const Vec3d v = Vec3d(dag.vertex_position[cluster.first_vertex + t[2]]) - a;
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

double dot_of(const Vec3d& a, const Vec3d& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

constexpr Hierarchy::Cone kNoCone{{0, 0, 0}, 127};

}  // namespace

Hierarchy::Sphere culling_sphere(const LodDag& dag, const DagCluster& cluster, const format::PositionGrid& grid,
                                 EnclosingBall enclose) {
  if (cluster.vertex_count == 0) return {};
  std::vector<Ball> points(cluster.vertex_count);
  for (std::uint32_t i = 0; i < cluster.vertex_count; ++i) {
    points[i].center = grid.decode(dag.vertex_position[cluster.first_vertex + i]);
  }
  const Vec3d middle = enclose(points).center;
  const Hierarchy::Sphere sphere{
      {static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)}, 0.0F};
  const Vec3d center = center_of(sphere);
  double radius = 0.0;
  for (const Ball& p : points) {
    // On a coarse mantissa (--grid) a float position may round: both are held.
    radius = std::max(radius, std::max(length_of(p.center - center), length_of(Vec3d(Vec3f(p.center)) - center)));
  }
  return {{sphere.center[0], sphere.center[1], sphere.center[2]}, float_above(radius * (1.0 + kDoubleSlack))};
}

std::int32_t choose_sphere_log2(std::span<const Hierarchy::Sphere> spheres) {
  constexpr double kLargestCenter = 32766.0;  // one unit less than i16 holds: rounding may add half a one
  constexpr double kLargestRadius = 65533.0;  // u16, less what snapping adds: √3 / 2 and the rounding up
  double center = 0.0;
  double radius = 0.0;
  for (const Hierarchy::Sphere& sphere : spheres) {
    for (const float c : sphere.center) center = std::max(center, std::abs(double{c}));
    radius = std::max(radius, double{sphere.radius});
  }
  std::int32_t log2 = format::kMinSphereLog2;
  while (log2 < format::kMaxSphereLog2 &&
         (center > kLargestCenter * format::exp2_exact(log2) || radius > kLargestRadius * format::exp2_exact(log2))) {
    ++log2;
  }
  return log2;
}

Hierarchy::Sphere snap_sphere(const Hierarchy::Sphere& sphere, std::int32_t log2) {
  const double unit = format::exp2_exact(log2);
  const Vec3d center = center_of(sphere);
  Vec3d snapped(0.0);
  for (int axis = 0; axis < 3; ++axis) snapped[axis] = std::floor(center[axis] / unit + 0.5) * unit;
  const double radius = (length_of(center - snapped) + double{sphere.radius}) * (1.0 + kDoubleSlack);
  // Whole units below 2^16 and a power of two: floats hold all four exactly.
  return {{static_cast<float>(snapped.x), static_cast<float>(snapped.y), static_cast<float>(snapped.z)},
          static_cast<float>(std::ceil(radius / unit) * unit)};
}

Hierarchy::Cone normal_cone(const LodDag& dag, const DagCluster& cluster) {
  std::vector<Vec3d> normals;
  normals.reserve(cluster.triangle_count);
  Vec3d sum(0.0);
  for (std::uint32_t i = 0; i < cluster.triangle_count; ++i) {
    const Vec3d n = area_vector(dag, cluster, cluster.first_triangle + i);
    const double length = length_of(n);
    if (!(length > 0.0)) continue;  // never seen, so it restrains nothing
    normals.push_back(n / length);
    sum += normals.back();
  }
  const double sum_length = length_of(sum);
  if (normals.empty() || !(sum_length > 0.0)) return kNoCone;
  const Vec3d axis = sum / sum_length;
  const Hierarchy::Cone cone{{static_cast<std::int8_t>(std::floor(axis.x * 127.0 + 0.5)),
                              static_cast<std::int8_t>(std::floor(axis.y * 127.0 + 0.5)),
                              static_cast<std::int8_t>(std::floor(axis.z * 127.0 + 0.5))},
                             127};
  // From here on with the axis as stored, whose length is not exactly 127. With s the angle's cosine between the stored
  // axis and the normal farthest from it, a view within 90° - acos(s) of the axis sees only backs:
  // dot(view, unit axis) >= sqrt(1 - s²).
  const Vec3d stored(cone.axis[0], cone.axis[1], cone.axis[2]);
  const double stored_length = length_of(stored);
  double s = 1.0;
  for (const Vec3d& n : normals) s = std::min(s, dot_of(n, stored) / stored_length);
  if (s <= 0.0) return kNoCone;
  s = std::max(0.0, s - 1e-12);
  const double cutoff = std::ceil(stored_length * std::sqrt(1.0 - s * s) + 1e-6);
  if (!(cutoff < 127.0)) return kNoCone;
  return {{cone.axis[0], cone.axis[1], cone.axis[2]}, static_cast<std::int8_t>(cutoff)};
}

}  // namespace meshlode::builder
