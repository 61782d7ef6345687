// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/detect/precision_faults.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/box.h"

namespace meshlode::scene {

namespace {

constexpr double kStepsInAnEdge = 256.0;
constexpr double kDiagonalsAway = 4.0;
// What a build chooses its grid by (builder/prepare/choose_grid.cpp; a test of out/doctor holds the two together).
constexpr double kGridOfDiagonal = 2.5e-5, kStepsPerEdge = 8.0, kMostSteps = 0x1p21;
constexpr double kStepsOfDetail = 4.0;  ///< that an edge of a triangle has at most, or it is a sliver

/// The step of the grid that a build chooses, in the unit of the points: a power of two; 0 where all is one point.
double choose_step(const Topology& topology, const Vec3d& sides) {
  double step = kGridOfDiagonal * topology.diagonal * 2.0 / std::sqrt(3.0);
  if (topology.median_edge > 0.0) step = std::min(step, topology.median_edge / kStepsPerEdge);
  if (!(step > 0.0)) return 0.0;
  int exponent = 0;
  (void)std::frexp(step, &exponent);
  step = std::ldexp(1.0, exponent - 1);
  while (0.5 * std::max({sides.x, sides.y, sides.z}) / step >= kMostSteps) step *= 2.0;
  return step;
}

}  // namespace

Fault find_far_from_origin(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kFarFromOrigin);
  if (!(topology.median_edge > 0.0)) return fault;
  const auto largest_of = [](const Vec3d& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); };
  const auto step_at = [](double coordinate) {
    int exponent = 0;
    (void)std::frexp(coordinate, &exponent);
    return std::ldexp(1.0, exponent - 24);
  };
  double largest = 0.0;
  for (const Vec3d& p : topology.points) largest = std::max(largest, largest_of(p));
  const double step = step_at(largest);
  if (largest < kDiagonalsAway * topology.diagonal || step * kStepsInAnEdge <= topology.median_edge) return fault;
  ConcernedTriangles concerned(topology);
  std::vector<std::uint8_t> is_coarse;
  for (const Vec3d& p : topology.points) {
    is_coarse.push_back(step_at(largest_of(p)) * kStepsInAnEdge > topology.median_edge ? 1 : 0);
    fault.count += is_coarse.back();
  }
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    for (const std::uint32_t point : topology.triangles[t]) {
      if (point != kNoId && is_coarse[point] != 0) concerned.mark(t);
    }
  }
  concerned.list_in(fault);
  fault.measure = step * topology.unit;
  // Half a step along each axis; a step as long as an edge leaves nothing of the shape.
  const double moved = 0.5 * std::sqrt(3.0) * step;
  fault.costs.push_back({CostKind::kAccuracy, CostUnit::kObjectUnits, moved * topology.unit,
                         std::min(1.0, step / topology.median_edge) * concerned.share()});
  return fault;
}

Fault find_finer_than_grid(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kFinerThanGrid);
  if (topology.points.empty()) return fault;
  const Vec3d low = topology.box.low;
  const double step = choose_step(topology, topology.box.size());
  if (step == 0.0) return fault;
  // Whole numbers of 23 bits: products and their differences are exact.
  const auto on_grid = [&](std::uint32_t point) { return glm::floor((topology.points[point] - low) / step + 0.5); };
  ConcernedTriangles concerned(topology);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    const Vec3d a = on_grid(topology.triangles[t][0]);
    const Vec3d ab = on_grid(topology.triangles[t][1]) - a, ac = on_grid(topology.triangles[t][2]) - a;
    const double longest = std::max(glm::dot(ab, ab), glm::dot(ac, ac));
    if (longest > kStepsOfDetail * kStepsOfDetail || glm::cross(ab, ac) != Vec3d(0.0)) continue;
    concerned.mark(t);
  }
  if (concerned.count() == 0 || concerned.count() * kOneInAHundred < topology.triangles.size()) return fault;
  fault.count = concerned.count();
  fault.measure = step * topology.unit;
  concerned.list_in(fault);
  fault.costs.push_back(
      {CostKind::kAccuracy, CostUnit::kTriangles, static_cast<double>(fault.count), concerned.share()});
  return fault;
}

}  // namespace meshlode::scene
