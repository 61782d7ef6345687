// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/source_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshlode::builder {

namespace {

/// Points on triangles beside the corners: so many in all, but within so many a triangle on average.
constexpr std::size_t kPoints = 100000;
constexpr std::size_t kFewestPerTriangle = 1, kMostPerTriangle = 24;
/// One half of them goes to all triangles alike, the other by their longest edges: what a cut is off by changes along
/// a needle as it does along a row of small triangles.
constexpr double kShareByLength = 0.5;
/// And so many besides to triangles that are so much larger than the mean, by their areas: behind one that lies across
/// half of the mesh is much that its length says nothing of.
constexpr std::size_t kPointsOfLarge = 40000;
constexpr double kLarge = 16.0;
/// Of larger meshes a part of the triangles is looked at.
constexpr std::size_t kMostTriangles = 100000;

/// How many points each triangle gets beside its corners, `each` on average.
std::vector<std::uint32_t> share_points(const PreparedMesh& mesh, std::span<const std::uint32_t> triangles,
                                        std::size_t each) {
  std::vector<double> length(triangles.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<Vec3d, 3> p = source_corners(mesh, triangles[i]);
    length[i] = std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])});
    sum += length[i];
  }
  const auto average = static_cast<double>(each);
  const double alike = average * (1.0 - kShareByLength);
  const double per_length = sum > 0.0 ? average * kShareByLength * static_cast<double>(triangles.size()) / sum : 0.0;
  std::vector<std::uint32_t> counts(triangles.size());
  double owed = 0.0;  // of a point: what is left of one goes to the next triangle
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    owed += alike + per_length * length[i];
    counts[i] = static_cast<std::uint32_t>(owed);
    owed -= counts[i];
  }
  return counts;
}

/// More points, inside of triangles that are far larger than the others.
void add_points_of_large(const PreparedMesh& mesh, std::vector<SourcePoint>& points) {
  const auto area_of = [&](std::uint32_t triangle) {
    const std::array<Vec3d, 3> p = source_corners(mesh, triangle);
    return glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  };
  const auto count = static_cast<std::uint32_t>(mesh.exact_triangles.size());
  struct Large {
    std::uint32_t triangle;
    double area;
  };
  std::vector<Large> large;  // against the sum so far, which only grows
  double sum = 0.0;
  for (std::uint32_t t = 0; t < count; ++t) {
    const double area = area_of(t);
    sum += area;
    if (area * count > kLarge * sum) large.push_back({t, area});
  }
  if (!(sum > 0.0)) return;
  SplitMix64 random(0x6C61726765ULL);
  for (const auto& [t, area] : large) {
    if (!(area * count > kLarge * sum)) continue;
    const std::array<Vec3d, 3> corners = source_corners(mesh, t);
    const auto more = static_cast<std::size_t>(area / sum * static_cast<double>(kPointsOfLarge));
    for (std::size_t k = 0; k < more; ++k) points.push_back({random_point(corners, true, random), t});
  }
}

}  // namespace

std::array<Vec3d, 3> source_corners(const PreparedMesh& mesh, std::uint32_t triangle) {
  const auto& ids = mesh.exact_triangles[triangle];
  return {mesh.exact_positions[ids[0]], mesh.exact_positions[ids[1]], mesh.exact_positions[ids[2]]};
}

Vec3d random_point(const std::array<Vec3d, 3>& p, bool inside, SplitMix64& random) {
  double u = random.unit(), v = random.unit();
  if (!inside) {
    const std::size_t k = random.below(3);
    return p[k] + u * (p[(k + 1) % 3] - p[k]);
  }
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
}

std::vector<SourcePoint> choose_source_points(const PreparedMesh& mesh) {
  const std::size_t count = mesh.exact_triangles.size();
  const std::size_t step = (count + kMostTriangles - 1) / kMostTriangles;
  const std::size_t each = std::clamp(kPoints / std::max<std::size_t>(1, count), kFewestPerTriangle, kMostPerTriangle);
  std::vector<std::uint32_t> triangles;
  for (std::size_t i = 0; i < count; i += step) triangles.push_back(static_cast<std::uint32_t>(i));
  const std::vector<std::uint32_t> counts = share_points(mesh, triangles, each);
  std::vector<SourcePoint> points;
  points.reserve((each + 3) * triangles.size() + kPointsOfLarge);
  std::vector<std::uint8_t> is_taken(mesh.exact_positions.size(), 0);
  SplitMix64 random(0x77686F6C65ULL);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t t = triangles[i];
    for (const std::uint32_t id : mesh.exact_triangles[t]) {
      if (is_taken[id] == 0) points.push_back({mesh.exact_positions[id], t});
      is_taken[id] = 1;
    }
    const std::array<Vec3d, 3> corners = source_corners(mesh, t);
    for (std::size_t k = 0; k < counts[i]; ++k) points.push_back({random_point(corners, (i + k) % 2 == 0, random), t});
  }
  add_points_of_large(mesh, points);
  return points;
}

std::vector<PointRun> runs_of(std::span<const SourcePoint> points) {
  std::vector<PointRun> runs;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (runs.empty() || runs.back().triangle != points[i].triangle) runs.push_back({points[i].triangle, i, 0});
    ++runs.back().count;
  }
  return runs;
}

}  // namespace meshlode::builder
