// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/detect/edge_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace meshlode::scene {

namespace {

constexpr double kSeamOfDiagonal = 1e-4;
constexpr double kSeamOfEdge = 0.1;
/// Below it, in units of the largest coordinate, gaps are not told from rounding, and cells could not be counted.
constexpr double kLeastSeam = 0x1p-40;
/// Border points of one cell that are looked at: a file can put all of them into one.
constexpr std::size_t kMostInCell = 32;

/// Disjoint sets that know whether a member faces as the one that stands for its set (union by size, path halving would
/// lose the sides: paths are compressed in two walks).
class OrientedSets {
 public:
  explicit OrientedSets(std::size_t count) : parent_(count), size_(count, 1), is_opposite_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  struct Member {
    std::uint32_t root;
    bool is_opposite;  ///< faces the other way than the root
  };
  [[nodiscard]] Member find(std::uint32_t x) {
    std::uint32_t root = x;
    bool side = false;
    for (; parent_[root] != root; root = parent_[root]) side = side != (is_opposite_[root] != 0);
    const bool is_opposite = side;
    while (parent_[x] != root && x != root) {
      const std::uint32_t next = parent_[x];
      const bool step = is_opposite_[x] != 0;
      parent_[x] = root;
      is_opposite_[x] = side ? 1 : 0;
      side = side != step;
      x = next;
    }
    return {root, is_opposite};
  }

  /// False where the two are in one set already, and not as said.
  bool join(std::uint32_t a, std::uint32_t b, bool are_opposite) {
    Member first = find(a), second = find(b);
    const bool is_odd = (first.is_opposite != second.is_opposite) != are_opposite;
    if (first.root == second.root) return !is_odd;
    if (size_[first.root] < size_[second.root]) std::swap(first, second);
    parent_[second.root] = first.root;
    is_opposite_[second.root] = is_odd ? 1 : 0;
    size_[first.root] += size_[second.root];
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_, size_;
  std::vector<std::uint8_t> is_opposite_;  ///< to the parent; 0 of a root
};

/// A border point and the cell that it lies in.
struct BorderPoint {
  std::array<std::int64_t, 3> cell{};
  std::uint32_t point = 0;
};

struct Border {
  std::vector<BorderPoint> points;  ///< by cell, then point
  std::vector<std::uint32_t> triangles;
  double tolerance = 0.0;  ///< 0: nothing is near
};

std::array<std::int64_t, 3> cell_of(const Vec3d& p, double size) {
  return {static_cast<std::int64_t>(std::floor(p.x / size)), static_cast<std::int64_t>(std::floor(p.y / size)),
          static_cast<std::int64_t>(std::floor(p.z / size))};
}

Border find_border(const Topology& topology) {
  Border border;
  std::vector<std::uint32_t> points;
  std::vector<double> lengths;
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    if (edge.size() != 1) return;
    points.insert(points.end(), {edge[0].low, edge[0].high});
    border.triangles.push_back(edge[0].triangle);
    const Vec3d along = topology.points[edge[0].high] - topology.points[edge[0].low];
    lengths.push_back(std::sqrt(glm::dot(along, along)));
  });
  if (lengths.empty()) return border;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double tolerance = std::min(kSeamOfDiagonal * topology.diagonal, kSeamOfEdge * *middle);
  if (!(tolerance >= kLeastSeam)) return border;
  border.tolerance = tolerance;
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  for (const std::uint32_t point : points) {
    border.points.push_back({cell_of(topology.points[point], tolerance), point});
  }
  std::sort(border.points.begin(), border.points.end(), [](const BorderPoint& a, const BorderPoint& b) {
    return std::tie(a.cell, a.point) < std::tie(b.cell, b.point);
  });
  return border;
}

/// The distance to the nearest other border point that no edge leads to; nothing within the tolerance: 0.
double gap_at(const Topology& topology, const Border& border, const BorderPoint& from) {
  double nearest = 0.0;
  const auto look_at = [&](const BorderPoint& other) {
    if (other.point == from.point) return;
    const Vec3d between = topology.points[other.point] - topology.points[from.point];
    const double distance = std::sqrt(glm::dot(between, between));
    if (distance > border.tolerance || (nearest > 0.0 && distance >= nearest)) return;
    if (!topology.has_edge(from.point, other.point)) nearest = distance;
  };
  for (std::int64_t x = -1; x <= 1; ++x) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      // The three cells along z lie side by side in the order.
      const std::array<std::int64_t, 3> first{from.cell[0] + x, from.cell[1] + y, from.cell[2] - 1};
      auto at = std::lower_bound(border.points.begin(), border.points.end(), first,
                                 [](const BorderPoint& a, const auto& cell) { return a.cell < cell; });
      for (std::size_t i = 0; i < 3 * kMostInCell && at != border.points.end(); ++i, ++at) {
        if (at->cell[0] != first[0] || at->cell[1] != first[1] || at->cell[2] > from.cell[2] + 1) break;
        look_at(*at);
      }
    }
  }
  return nearest;
}

}  // namespace

Fault find_non_manifold_edges(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kNonManifold);
  ConcernedTriangles concerned(topology);
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    if (edge.size() <= 2) return;
    ++fault.count;
    fault.measure = std::max(fault.measure, static_cast<double>(edge.size()));
    for (const TopologyEdge& one : edge) concerned.mark(one.triangle);
  });
  concerned.list_in(fault);
  if (fault.count == 0) return fault;
  fault.costs.push_back(
      {CostKind::kTime, CostUnit::kTriangles, static_cast<double>(concerned.count()), concerned.share()});
  return fault;
}

Fault find_misoriented(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kMisoriented);
  ConcernedTriangles concerned(topology);
  OrientedSets sets(topology.triangles.size());
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    if (edge.size() != 2) return;
    const bool is_wrong = edge[0].is_forward == edge[1].is_forward;
    fault.count += is_wrong ? 1U : 0U;
    if (!sets.join(edge[0].triangle, edge[1].triangle, is_wrong) && is_wrong) {
      concerned.mark(edge[0].triangle);
      concerned.mark(edge[1].triangle);
    }
  });
  if (fault.count == 0) return fault;
  std::vector<std::uint32_t> opposite(topology.triangles.size(), 0), all(topology.triangles.size(), 0);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    const OrientedSets::Member member = sets.find(t);
    ++all[member.root];
    opposite[member.root] += member.is_opposite ? 1U : 0U;
  }
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    const OrientedSets::Member member = sets.find(t);
    const std::uint32_t against = opposite[member.root];
    if (against == 0) continue;
    if (member.is_opposite == (2 * std::uint64_t{against} <= all[member.root])) concerned.mark(t);
  }
  concerned.list_in(fault);
  // At most half of a piece is turned, which is then as wrong as it can be.
  fault.costs.push_back({CostKind::kAccuracy, CostUnit::kTriangles, static_cast<double>(concerned.count()),
                         std::min(1.0, 2.0 * concerned.share())});
  return fault;
}

Fault find_unwelded_seams(const Topology& topology) {
  Fault fault = fault_of(FaultKind::kUnweldedSeam);
  const Border border = find_border(topology);
  if (border.tolerance == 0.0) return fault;
  std::vector<std::uint8_t> is_loose(topology.points.size(), 0);
  for (const BorderPoint& from : border.points) {
    const double gap = gap_at(topology, border, from);
    if (gap == 0.0) continue;
    is_loose[from.point] = 1;
    ++fault.count;
    fault.measure = std::max(fault.measure, gap * topology.unit);
  }
  // Leaves and gravel come that near by chance.
  if (fault.count * kOneInAHundred < border.points.size()) return fault_of(FaultKind::kUnweldedSeam);
  if (fault.count == 0) return fault;
  ConcernedTriangles concerned(topology);
  for (const std::uint32_t triangle : border.triangles) {
    for (const std::uint32_t point : topology.triangles[triangle]) {
      if (is_loose[point] != 0) concerned.mark(triangle);
    }
  }
  concerned.list_in(fault);
  // Two borders are simplified, each for itself: what was a hair's breadth opens as far as the level's error lets it.
  fault.costs.push_back({CostKind::kAccuracy, CostUnit::kObjectUnits, fault.measure, concerned.share()});
  const double bytes = 0.5 * kBytesPerWedge * static_cast<double>(fault.count);
  fault.costs.push_back({CostKind::kBytes, CostUnit::kAssetBytes, bytes,
                         std::min(1.0, bytes / (kBytesPerTriangle * static_cast<double>(topology.triangles.size())))});
  return fault;
}

}  // namespace meshlode::scene
