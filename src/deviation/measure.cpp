// SPDX-License-Identifier: GPL-3.0-or-later
// Group to source, estimated from below: points on the group's triangles, and adaptive subdivision where they say that
// the maximum may lie (in the manner of Metro, Cignoni, Rocchini and Scopigno 1998, but with the effort where it
// counts).
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "deviation/group_measure.h"

namespace meshlode {

namespace {

// Points nearer than this share of the maximum are not measured exactly: nothing beside them will exceed it.
constexpr double kDismissShare = 0.5;
// How far a patch may rise above its six points, as a share of how much they differ. A parabola's top lies at most 1/3
// above, the ridge of a crease 1/2 in the worst case.
constexpr double kRise = 0.4;
// A patch that cannot raise the maximum by more than this is left alone.
constexpr double kWorthwhile = 1.01;

struct Probe {
  double value = 0.0;
  std::uint32_t place = 0;
};

/// Distances to the source, with the maximum so far.
class SourceProbe {
 public:
  SourceProbe(const SurfaceTree& tree, double maximum) : tree_(tree) { raise(maximum); }

  [[nodiscard]] Probe measure(const Vec3d& point, std::uint32_t place) {
    const Vec3f at = tree_.to_frame(point);
    SurfaceTree::Hit hit = tree_.look_around(at, place, {});
    if (!(hit.distance2 <= enough_)) hit = tree_.find_nearest(at, hit, enough_);
    if (hit.slot == SurfaceTree::kNone) return {maximum_, place};  // farther than floats reach: not on any real mesh
    if (hit.distance2 <= enough_) return {std::sqrt(static_cast<double>(hit.distance2)) / tree_.scale(), hit.slot};
    const double value = std::sqrt(tree_.distance2_at(point, hit.slot));
    if (value > maximum_) raise(value);
    return {value, hit.slot};
  }
  [[nodiscard]] double maximum() const { return maximum_; }

 private:
  void raise(double maximum) {
    maximum_ = maximum;
    const double enough = kDismissShare * maximum * tree_.scale();
    enough_ = static_cast<float>(enough * enough);
  }

  const SurfaceTree& tree_;
  double maximum_ = 0.0;
  float enough_ = 0.0F;  ///< squared, in the tree's frame
};

/// A triangle with six points: its corners, and the middles of its edges (of the edge that starts at corner k).
struct Patch {
  std::array<Vec3d, 3> corner;
  std::array<Probe, 3> at_corner, at_middle;
  double estimate = 0.0;
  std::uint32_t order = 0;  ///< of creation: ties are decided by it

  void set_estimate(double extra_low, double extra_high) {
    double low = extra_low, high = extra_high;
    for (std::size_t k = 0; k < 3; ++k) {
      low = std::min(low, std::min(at_corner[k].value, at_middle[k].value));
      high = std::max(high, std::max(at_corner[k].value, at_middle[k].value));
    }
    estimate = high + kRise * (high - low);
  }
  [[nodiscard]] Vec3d middle(std::size_t k) const { return (corner[k] + corner[(k + 1) % 3]) * 0.5; }
  [[nodiscard]] bool operator<(const Patch& other) const {
    return estimate != other.estimate ? estimate < other.estimate : order > other.order;
  }
};

/// Into four, with nine new points.
void split(const Patch& patch, SourceProbe& probe, std::uint32_t& order, std::vector<Patch>& heap) {
  std::array<Vec3d, 3> middle;
  for (std::size_t k = 0; k < 3; ++k) middle[k] = patch.middle(k);
  std::array<Patch, 4> parts;
  for (std::size_t k = 0; k < 3; ++k) {  // at corner k: the corner, the middle after it, the middle before it
    const std::size_t before = (k + 2) % 3;
    parts[k].corner = {patch.corner[k], middle[k], middle[before]};
    parts[k].at_corner = {patch.at_corner[k], patch.at_middle[k], patch.at_middle[before]};
    for (std::size_t j = 0; j < 3; ++j) {
      parts[k].at_middle[j] = probe.measure(parts[k].middle(j), parts[k].at_corner[j].place);
    }
  }
  parts[3].corner = middle;
  parts[3].at_corner = patch.at_middle;
  // The middle part's edge from middle k to middle k+1 is the inner edge of the part at corner k+1.
  for (std::size_t k = 0; k < 3; ++k) parts[3].at_middle[k] = parts[(k + 1) % 3].at_middle[1];
  for (Patch& part : parts) {
    part.set_estimate(part.at_corner[0].value, part.at_corner[0].value);
    part.order = order++;
    if (part.estimate > kWorthwhile * probe.maximum()) {
      heap.push_back(part);
      std::push_heap(heap.begin(), heap.end());
    }
  }
}

}  // namespace

double measure_to_source(const SurfaceTree& source, const GroupSurface& group, const GroupEdges& edges,
                         std::vector<std::uint32_t> places, double maximum) {
  SourceProbe probe(source, maximum);
  const std::size_t count = group.triangles.size();
  constexpr std::uint32_t kUnknown = 0xFFFFFFFFU;
  std::vector<Probe> at_vertex(group.positions.size(), {0.0, kUnknown});
  std::vector<Patch> patches(count);
  std::vector<Probe> at_edge(edges.use_count.size(), {0.0, kUnknown});
  std::uint32_t place = 0;
  // Every patch is made before any is split: what is highest is refined first.
  std::vector<std::pair<double, double>> range(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& ids = group.triangles[t];
    Patch& patch = patches[t];
    if (places[t] != SurfaceTree::kNone) place = places[t];
    for (std::size_t k = 0; k < 3; ++k) patch.corner[k] = group.positions[ids[k]];
    const Probe center = probe.measure((patch.corner[0] + patch.corner[1] + patch.corner[2]) / 3.0, place);
    place = center.place;
    for (std::size_t k = 0; k < 3; ++k) {
      Probe& vertex = at_vertex[ids[k]];
      if (vertex.place == kUnknown) vertex = probe.measure(patch.corner[k], place);
      patch.at_corner[k] = vertex;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      Probe& middle = at_edge[edges.of_triangle[t][k]];
      if (middle.place == kUnknown) middle = probe.measure(patch.middle(k), place);
      patch.at_middle[k] = middle;
    }
    range[t] = {center.value, center.value};
  }
  std::uint32_t order = 0;
  std::vector<Patch> heap;
  for (std::size_t t = 0; t < count; ++t) {
    patches[t].set_estimate(range[t].first, range[t].second);
    patches[t].order = order++;
    if (patches[t].estimate > kWorthwhile * probe.maximum()) heap.push_back(patches[t]);
  }
  std::make_heap(heap.begin(), heap.end());
  for (std::size_t budget = 24 + count / 16; budget > 0 && !heap.empty(); --budget) {
    std::pop_heap(heap.begin(), heap.end());
    const Patch patch = heap.back();
    heap.pop_back();
    if (!(patch.estimate > kWorthwhile * probe.maximum())) break;
    split(patch, probe, order, heap);
  }
  return probe.maximum();
}

GroupDeviation measure_group(const SourceTree& source, const GroupSurface& group,
                             std::span<const CarriedSample> samples, const DeviationTierOptions& options) {
  GroupDeviation result;
  result.deviation = options.floor;
  const SurfaceTree& source_tree = source.impl().tree;
  if (group.triangles.empty() || source_tree.size() == 0) {
    if (!samples.empty() || !group.triangles.empty()) result.deviation = std::numeric_limits<double>::infinity();
    return result;
  }
  SurfaceTree group_tree;
  group_tree.build({group.positions, group.triangles});
  std::vector<CarriedSample> projected(samples.begin(), samples.end());
  const GroupEdges edges(group);
  double to_group = project_samples(group_tree, projected);
  to_group = std::max(
      to_group, search_source(source.impl(), group, group_tree, edges, std::max(options.floor, to_group), projected));
  result.carried = thin_samples(projected, group.triangles.size(), options.samples_per_triangle, to_group);
  std::vector<std::uint32_t> places(group.triangles.size(), SurfaceTree::kNone);
  for (const CarriedSample& sample : result.carried) places[sample.triangle] = sample.place;
  result.deviation = measure_to_source(source_tree, group, edges, std::move(places), std::max(options.floor, to_group));
  return result;
}

}  // namespace meshlode
