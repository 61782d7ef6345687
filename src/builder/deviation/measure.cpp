// SPDX-License-Identifier: GPL-3.0-or-later
// Group to source, estimated from below: points on the group's triangles, and adaptive subdivision where they say that
// the maximum may lie (in the manner of Metro, Cignoni, Rocchini and Scopigno 1998, but with the effort where it
// counts).
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "builder/deviation/group_measure.h"
#include "builder/deviation/patch.h"

namespace meshlode::builder {

namespace {

// Points above this share of the maximum are told: the other direction may have its maximum beside them.
constexpr double kNearMaximum = 0.9;
// Of the effort on top, this part goes where nothing promises anything.
constexpr std::uint32_t kSpareShare = 3;
// What was within the errors of the finer levels, which are estimates from below.
constexpr double kReach = 1.3;
/// Distances to the source, with the maximum so far.
class SourceProbe {
 public:
  SourceProbe(const SurfaceTree& tree, double rise, const Farthest& farthest)
      : tree_(tree), dismiss_share_(1.0 / (1.0 + rise)), farthest_(farthest) {
    set_enough();
  }

  [[nodiscard]] Probe measure(const Vec3d& point, TreeSlot place, std::uint32_t /*owner*/ = 0) {
    const Vec3f at = tree_.to_frame(point);
    SurfaceTree::Hit hit = tree_.look_around(at, place, {});
    if (!(hit.distance2 <= enough_)) hit = tree_.find_nearest(at, hit, enough_);
    if (!hit.slot.is_valid()) return {maximum(), place};  // farther than floats reach: not on any real mesh
    if (hit.distance2 <= enough_) return {std::sqrt(static_cast<double>(hit.distance2)) / tree_.scale(), hit.slot};
    const double value = std::sqrt(tree_.distance2_at(point, hit.slot));
    const bool is_higher = value > maximum();
    farthest_.take(value);
    if (is_higher) set_enough();
    if (value > kNearMaximum * maximum()) high_.push_back({point, 0, static_cast<float>(value), hit.slot});
    return {value, hit.slot};
  }
  [[nodiscard]] const SurfaceTree& tree() const { return tree_; }
  [[nodiscard]] double maximum() const { return farthest_.to_beat(); }
  [[nodiscard]] const Farthest& farthest() const { return farthest_; }
  [[nodiscard]] std::vector<CarriedSample> take_high() { return std::move(high_); }

 private:
  void set_enough() { enough_ = tree_.squared_in_frame(dismiss_share_ * maximum()); }

  const SurfaceTree& tree_;
  /// Points nearer than this share of the maximum are not measured exactly: no patch of such points may rise above it.
  double dismiss_share_;
  Farthest farthest_;
  float enough_ = 0.0F;              ///< squared, in the tree's frame
  std::vector<CarriedSample> high_;  ///< near what was the maximum then
};

}  // namespace

Farthest measure_to_source(const SurfaceTree& source, const GroupSurface& group, const GroupEdges& edges,
                           std::vector<TreeSlot>& places, Farthest farthest, Effort budget,
                           std::vector<CarriedSample>& high) {
  SourceProbe probe(source, budget.rise.first, farthest);
  const std::size_t count = group.triangles.size();
  std::vector<Probe> at_vertex(group.positions.size(), {0.0, TreeSlot()});
  std::vector<Probe> at_edge(edges.use_count.size(), {0.0, TreeSlot()});
  TreeSlot place{0U};
  PatchQueue<SourceProbe> queue(probe, budget.rise, budget.spare);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& ids = group.triangles[t];
    Patch patch;
    if (places[t].is_valid()) place = places[t];
    for (std::size_t k = 0; k < 3; ++k) patch.corner[k] = group.positions[ids[k]];
    const Probe center = probe.measure((patch.corner[0] + patch.corner[1] + patch.corner[2]) / 3.0, place);
    places[t] = place = center.place;
    for (std::size_t k = 0; k < 3; ++k) {
      Probe& vertex = at_vertex[ids[k]];
      if (!vertex.place.is_valid()) vertex = probe.measure(patch.corner[k], place);
      patch.at_corner[k] = vertex;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      Probe& middle = at_edge[edges.of_triangle[t][k]];
      if (!middle.place.is_valid()) middle = probe.measure(patch.middle(k), place);
      patch.at_middle[k] = middle;
    }
    patch.set_range(center.value);
    queue.add(patch);
  }
  queue.refine(budget.promising);
  high = probe.take_high();
  return probe.farthest();
}

GroupDeviation measure_group(const SourceTree& source, const GroupSurface& group,
                             std::span<const CarriedSample> samples, const DeviationTierOptions& options) {
  GroupDeviation result;
  const SurfaceTree& source_tree = source.impl().tree;
  if (group.triangles.empty() || source_tree.size() == 0) {
    if (!samples.empty() || !group.triangles.empty()) result.deviation = std::numeric_limits<double>::infinity();
    return result;
  }
  SurfaceTree group_tree;
  group_tree.build({group.positions, group.triangles});
  std::vector<CarriedSample> projected(samples.begin(), samples.end());
  const GroupEdges edges(group);
  Farthest farthest{project_samples(group_tree, projected), options.least};
  std::vector<TreeSlot>& places = result.places;
  places.resize(group.triangles.size());
  for (const CarriedSample& sample : projected) places[sample.triangle] = sample.place;
  const GroupEdges finer_edges(options.finer);
  farthest =
      measure_closed_borders(source_tree, group_tree, options.finer, finer_edges, options.finer_is_shared, farthest);
  std::vector<CarriedSample> high;
  const bool is_spared = options.extra_effort >= kLeastExtra;
  const Effort effort{64 + group.triangles.size() / (is_spared ? 4 : 16) + options.extra_effort,
                      is_spared ? options.extra_effort / kSpareShare : 0, is_spared ? kHighestRise : kUsualRise};
  farthest = measure_to_source(source_tree, group, edges, places, farthest, effort, high);
  farthest = search_by_bounds(source_tree, group, places, options.margin, farthest);
  OwnerTest owner(options.finer, finer_edges, options.finer_is_shared, kReach * options.floor, options.is_whole);
  const std::vector<std::uint8_t> is_folded = find_folded(options.finer, finer_edges);
  farthest = search_source(source.impl(), group, group_tree, owner, is_folded, farthest, high, options.extra_effort,
                           projected);
  result.carried = thin_samples(projected, group.triangles.size(), options.samples_per_triangle, farthest.to_beat());
  result.deviation = farthest.found;
  return result;
}

}  // namespace meshlode::builder
