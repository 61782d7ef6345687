// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/detect/face_faults.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace meshlode::scene {

namespace {

constexpr std::size_t kFewestForShares = 1000;  ///< triangles: of fewer, a thousandth is none
constexpr double kLeastErrorShare = 0.5;
constexpr double kLeastErrorOfDiagonal = 1e-4;

template <class Vector>
bool is_finite(const Vector& v) {
  for (int i = 0; i < Vector::length(); ++i) {
    if (!std::isfinite(v[i])) return false;
  }
  return true;
}

/// Whether every attribute that the vertex has is finite.
bool is_finite_vertex(const Primitive& primitive, std::size_t v) {
  const auto holds = [&](const auto& values) { return v >= values.size() || is_finite(values[v]); };
  bool is_sound = holds(primitive.positions) && holds(primitive.normals) && holds(primitive.colors);
  for (const std::vector<Vec2f>& uvs : primitive.uvs) is_sound = is_sound && holds(uvs);
  return is_sound;
}

/// Triangles of one kind, with a cost of time.
Fault collect(const Topology& topology, FaultKind kind, TriangleKind wanted) {
  Fault fault = fault_of(kind);
  ConcernedTriangles concerned(topology);
  for (std::uint32_t t = 0; t < topology.kinds.size(); ++t) {
    if (topology.kinds[t] == wanted) concerned.mark(t);
  }
  concerned.list_in(fault);
  fault.count = concerned.count();
  if (fault.count == 0) return fault;
  fault.costs.push_back({CostKind::kTime, CostUnit::kTriangles, static_cast<double>(fault.count), concerned.share()});
  return fault;
}

double ratio_of(const Topology& topology, std::uint32_t triangle) {
  const auto& points = topology.triangles[triangle];
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d along = topology.points[points[(k + 1) % 3]] - topology.points[points[k]];
    longest = std::max(longest, glm::dot(along, along));
  }
  const Vec3d normal = topology.area_normal(triangle);
  return longest / std::sqrt(glm::dot(normal, normal));  // sound triangles have area
}

/// The squared distance to planes through a point, weighted by area, as a quadratic form around that point: planes that
/// pass through it need no more, and no digits are lost far from the origin.
struct Quadric {
  double area = 0.0;
  Vec3d squares{0.0}, mixed{0.0};  ///< xx yy zz, xy yz zx

  void add(const Vec3d& n, double weight) {
    area += weight;
    squares += weight * n * n;
    mixed += weight * Vec3d(n.x * n.y, n.y * n.z, n.z * n.x);
  }
  /// \param p relative to the point
  [[nodiscard]] double at(const Vec3d& p) const {
    return std::max(0.0, glm::dot(squares, p * p) + 2.0 * glm::dot(mixed, Vec3d(p.x * p.y, p.y * p.z, p.z * p.x)));
  }
};

/// Of each point: what moving it to the best of its neighbours costs, area times squared distance.
struct PointErrors {
  std::vector<double> costs;
  double largest_distance = 0.0;
};

PointErrors collapse_errors(const Topology& topology) {
  std::vector<Quadric> quadrics(topology.points.size());
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    const Vec3d normal = topology.area_normal(t);
    const double length = std::sqrt(glm::dot(normal, normal));
    for (const std::uint32_t point : topology.triangles[t]) quadrics[point].add(normal / length, 0.5 * length);
  }
  PointErrors errors;
  errors.costs.assign(topology.points.size(), -1.0);
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    const Vec3d along = topology.points[edge[0].high] - topology.points[edge[0].low];
    const auto offer = [&](std::uint32_t point, const Vec3d& to) {
      const double cost = quadrics[point].at(to);
      double& best = errors.costs[point];
      best = best < 0.0 ? cost : std::min(best, cost);
    };
    offer(edge[0].low, along);
    offer(edge[0].high, -along);
  });
  for (std::size_t p = 0; p < errors.costs.size(); ++p) {
    errors.costs[p] = std::max(0.0, errors.costs[p]);
    if (quadrics[p].area > 0.0) {
      errors.largest_distance = std::max(errors.largest_distance, std::sqrt(errors.costs[p] / quadrics[p].area));
    }
  }
  return errors;
}

}  // namespace

Fault find_not_finite(const SourceMesh& mesh, const Topology& topology) {
  Fault fault = fault_of(FaultKind::kNotFinite);
  ConcernedTriangles concerned(topology);
  std::vector<std::uint8_t> is_sound;
  for (const Primitive& primitive : mesh.primitives) {
    for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
      is_sound.push_back(is_finite_vertex(primitive, v) ? 1 : 0);
      fault.count += is_sound.back() == 0 ? 1U : 0U;
    }
  }
  for (std::uint32_t t = 0; t < topology.vertices.size(); ++t) {
    for (const std::uint32_t vertex : topology.vertices[t]) {
      fault.count += vertex == kNoId ? 1U : 0U;
      if (vertex == kNoId || is_sound[vertex] == 0) concerned.mark(t);
    }
  }
  concerned.list_in(fault);
  if (fault.count == 0) return fault;
  fault.costs.push_back(
      {CostKind::kAccuracy, CostUnit::kTriangles, static_cast<double>(concerned.count()), concerned.share()});
  return fault;
}

Fault find_degenerate_faces(const Topology& topology) {
  return collect(topology, FaultKind::kDegenerate, TriangleKind::kDegenerate);
}

Fault find_duplicate_faces(const Topology& topology) {
  Fault fault = collect(topology, FaultKind::kDuplicate, TriangleKind::kDuplicate);
  const auto reversed = std::count(topology.is_reversed.begin(), topology.is_reversed.end(), 1);
  fault.measure = static_cast<double>(reversed);
  if (reversed > 0) {
    // A build drops those that face the same way.
    const double share = fault.measure / static_cast<double>(topology.triangles.size());
    fault.costs.push_back({CostKind::kBytes, CostUnit::kAssetBytes, kBytesPerTriangle * fault.measure, share});
  }
  return fault;
}

Fault find_needles(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kNeedles);
  ConcernedTriangles concerned(topology);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    const double ratio = ratio_of(topology, t);
    if (ratio < kNeedleRatio) continue;
    concerned.mark(t);
    fault.measure = std::max(fault.measure, ratio);
  }
  if (concerned.count() * kOneInAHundred < topology.triangles.size() || concerned.count() == 0) {
    return fault_of(FaultKind::kNeedles);
  }
  fault.count = concerned.count();
  concerned.list_in(fault);
  fault.costs.push_back({CostKind::kTime, CostUnit::kTriangles, static_cast<double>(fault.count), concerned.share()});
  return fault;
}

Fault find_error_in_few(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kErrorInFew);
  if (topology.triangles.size() < kFewestForShares) return fault;
  const PointErrors errors = collapse_errors(topology);
  if (!(errors.largest_distance > kLeastErrorOfDiagonal * topology.diagonal)) return fault;
  std::vector<std::pair<double, std::uint32_t>> order;
  double total = 0.0;
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.kinds[t] != TriangleKind::kSound) continue;
    double error = 0.0;
    for (const std::uint32_t point : topology.triangles[t]) error += errors.costs[point] / 3.0;
    total += error;
    order.emplace_back(-error, t);
  }
  // The last bits of a sum decide nothing: what is held is compared with a half, and printed to three digits.
  const std::size_t few = std::min(order.size(), topology.triangles.size() / kFewestForShares);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(few), order.end());
  double held = 0.0;
  for (std::size_t i = 0; i < few; ++i) held -= order[i].first;
  if (!(held >= kLeastErrorShare * total)) return fault;
  fault.count = fault.triangle_count = few;
  fault.measure = held / total;
  for (std::size_t i = 0; i < std::min(few, kMaxListedTriangles); ++i) {
    fault.triangles.push_back(topology.name_of_triangle(order[i].second));
  }
  fault.costs.push_back(
      {CostKind::kAccuracy, CostUnit::kObjectUnits, errors.largest_distance * topology.unit, fault.measure});
  return fault;
}

}  // namespace meshlode::scene
