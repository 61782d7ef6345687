// SPDX-License-Identifier: GPL-3.0-or-later
// Source to group, second part: carried samples are few, so the source around the farthest of them is searched whole,
// from vertex to vertex. Only the neighbourhoods of a few samples are looked at, so that this costs little; and since
// it is the source itself that is looked at, thinning costs no accuracy where the maximum is.
//
// The source does not say which of its points a group stands for. But the triangles that the group replaces are known,
// and how far the source was from them: a point that was farther from them belongs to somebody else. So may one whose
// nearest place on them is a border that they share, and one that faces the other way lies on another sheet.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/id_table.h"
#include "builder/deviation/group_measure.h"
#include "builder/deviation/patch.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kMaxSeeds = 64;
// Seeds lie close together, where the distance is large: most have been searched around when their turn comes. Of the
// others so many are, and all where the effort allows it.
constexpr std::size_t kUsualDiscs = 16, kNewDisc = 16;
constexpr std::size_t kMaxPointsPerSeed = 4096;
// A seed nearer than this share of the maximum is not searched around.
constexpr double kSeedShare = 0.5;
// And a point of what the group replaces.
constexpr double kFarShare = 0.8;
// Points nearer than this share of the maximum need not be known exactly.
constexpr double kDismissShare = 0.7;
// Source triangles that may be divided.
constexpr std::size_t kRefineBudget = 48;
// A source triangle is looked at inside where its edges are longer than this share of the search radius.
constexpr double kLargeShare = 0.25;
// Of a part of the source that is searched from above, to be compared with dividing a triangle.
constexpr std::size_t kPointsPerPart = 4;
// A source of so many triangles is large against those of a group that is all of its mesh: discs around samples hold
// thousands of its vertices each, where from above some ten thousand points are enough to know the maximum.
constexpr std::size_t kManyTriangles = 262144;
constexpr std::size_t kPointsOfMany = 24000;
// What cannot raise the maximum by more than this is left alone.
constexpr double kWorthwhile = 1.002;

class SourceSearch {
 public:
  SourceSearch(const SourceTree::Impl& source, const SurfaceTree& group_tree, OwnerTest& owner_test,
               const Farthest& farthest)
      : source_(source), tree_(group_tree), owner_test_(owner_test), farthest_(farthest) {
    set_enough();
  }

  [[nodiscard]] const SurfaceTree& tree() const { return tree_; }
  [[nodiscard]] double maximum() const { return farthest_.to_beat(); }
  [[nodiscard]] const Farthest& farthest() const { return farthest_; }

  /// Takes the farthest point found around a seed, if it is farther than the maximum was. Returns how many vertices it
  /// looked at: those that no other seed led to.
  std::size_t search_around(const CarriedSample& seed, double radius, std::vector<CarriedSample>& found) {
    const double before = maximum();
    frontier_.clear();
    const std::uint32_t first = source_.tree.triangle_at(seed.place);
    const double radius2 = radius * radius;
    std::size_t points = 0;
    const auto visit = [&](std::uint32_t vertex, std::uint32_t through, TreeSlot place) {
      if (seen_.has(vertex)) return;  // each is met by all of its triangles, through each of their corners
      const Vec3d away = source_.positions[vertex] - seed.point;
      if (glm::dot(away, away) > radius2) return;
      seen_.insert(vertex);
      ++points;
      const Probe probe = measure_vertex(vertex, place, through);
      if (is_ours_) frontier_.push_back({vertex, probe.place});
    };
    const TreeSlot start = place_near(seed.point);
    for (const std::uint32_t vertex : source_.vertices(first)) visit(vertex, first, start);
    look_inside(first, radius, start);
    for (std::size_t next = 0; next < frontier_.size() && points < kMaxPointsPerSeed; ++next) {
      const Reached reached = frontier_[next];
      for (const std::uint32_t triangle : source_.triangles_on_from(reached.vertex)) {
        for (const std::uint32_t vertex : source_.vertices(triangle)) {
          if (vertex != reached.vertex) visit(vertex, triangle, reached.place);
        }
        look_inside(triangle, radius, reached.place);
      }
    }
    if (maximum() > before) found.push_back(farthest_point_);
    return points;
  }

  /// The triangle of the source that is nearest to a point of what the group replaces, and those around it.
  void search_behind(const Vec3d& point) {
    const SurfaceTree::Hit hit = source_.tree.find_nearest(source_.tree.to_frame(point), {}, 0.0F);
    if (!hit.slot.is_valid()) return;
    const std::uint32_t triangle = source_.tree.triangle_at(hit.slot);
    const TreeSlot place = place_near(point);
    look_inside(triangle, 0.0, place);
    for (const std::uint32_t corner : source_.vertices(triangle)) {
      for (const std::uint32_t around : source_.triangles_on_from(corner)) look_inside(around, 0.0, place);
    }
  }

  /// All of the source, from above: whatever a ball around a part of it says cannot be farther than the maximum is left
  /// alone, and what may be farthest comes first. About `budget` points are measured. Complete where the deviation is
  /// large against the source's triangles; where it is small the samples are dense against the group's. \returns
  /// whether nothing is left that may be farther, but for the insides of triangles, which are refine()'s.
  bool search_everywhere(std::size_t budget, std::vector<CarriedSample>& found) {
    struct Part {
      double bound;
      std::uint32_t level, index;
      TreeSlot place;  ///< of the group's tree
      std::uint32_t order;
      [[nodiscard]] bool operator<(const Part& other) const {
        return bound != other.bound ? bound < other.bound : order > other.order;
      }
    };
    const double before = maximum();
    const SurfaceTree& tree = source_.tree;
    std::vector<Part> heap{{std::numeric_limits<double>::infinity(), 0, 0, TreeSlot{0U}, 0}};
    std::uint32_t order = 0;
    std::size_t measured = 0;
    const auto is_done = [&] { return heap.empty() || !(heap.front().bound > kWorthwhile * maximum()); };
    while (measured < budget && !is_done()) {
      std::pop_heap(heap.begin(), heap.end());
      const Part part = heap.back();
      heap.pop_back();
      if (part.level == tree.depth()) {
        for (std::uint32_t slot = 4 * part.index; slot < std::min(4 * part.index + 4, tree.size()); ++slot) {
          measured += look_at(tree.triangle_at(TreeSlot(slot)), part.place);
        }
        continue;
      }
      for (std::uint32_t child = 0; child < 4; ++child) {
        const SurfaceTree::Ball ball = tree.ball_of_child(part.level, part.index, child);
        if (ball.radius < 0.0) continue;
        ++measured;
        const Vec3f at = tree_.to_frame(ball.center);
        const float enough = tree_.squared_in_frame(std::max(0.0, kWorthwhile * maximum() - ball.radius));
        SurfaceTree::Hit hit = tree_.look_around(at, part.place, {});
        if (!(hit.distance2 <= enough)) hit = tree_.find_nearest(at, hit, enough);
        if (hit.distance2 <= enough || !hit.slot.is_valid()) continue;
        const double bound = std::sqrt(static_cast<double>(hit.distance2)) / tree_.scale() + ball.radius;
        heap.push_back({bound, part.level + 1, 4 * part.index + child, hit.slot, ++order});
        std::push_heap(heap.begin(), heap.end());
      }
    }
    if (maximum() > before) found.push_back(farthest_point_);
    return is_done();
  }

  /// Large triangles of the source that were met: the maximum may lie between their corners.
  void refine(Effort effort, std::vector<CarriedSample>& found) {
    const double before = maximum();
    PatchQueue<SourceSearch> queue(*this, effort.rise, effort.spare);
    for (const Patch& patch : large_) queue.add(patch);
    large_.clear();
    queue.refine(effort.promising);
    if (maximum() > before) found.push_back(farthest_point_);
  }

  /// A point of a triangle of the source. Raises the maximum.
  Probe measure(const Vec3d& point, TreeSlot place, std::uint32_t owner) {
    return judge(point, find_near(point, place), place, owner);
  }

 private:
  struct Reached {
    std::uint32_t vertex;
    TreeSlot place;
  };

  /// The nearest triangle, or one that is near enough. What is enough only grows: a point that was near enough stays
  /// so, and what is farther is the nearest.
  [[nodiscard]] SurfaceTree::Hit find_near(const Vec3d& point, TreeSlot place) const {
    const Vec3f at = tree_.to_frame(point);
    const SurfaceTree::Hit hit = tree_.look_around(at, place, {});
    return hit.distance2 <= enough_ ? hit : tree_.find_nearest(at, hit, enough_);
  }

  /// The same as measure() of a vertex of the source, which is looked for once: every triangle around it asks.
  Probe measure_vertex(std::uint32_t vertex, TreeSlot place, std::uint32_t owner) {
    const auto [id, is_new] = known_table_.find_or_insert(
        hash_word(0, vertex), static_cast<std::uint32_t>(known_.size()),
        [&](std::uint32_t other) { return known_[other].vertex == vertex; },
        [&](std::uint32_t other) { return hash_word(0, known_[other].vertex); });
    const Vec3d& point = source_.positions[vertex];
    if (is_new) known_.push_back({vertex, find_near(point, place)});
    return judge(point, known_[id].hit, place, owner);
  }

  Probe judge(const Vec3d& point, const SurfaceTree::Hit& hit, TreeSlot place, std::uint32_t owner) {
    const Probe dismissed{kDismissShare * maximum(), hit.slot.is_valid() ? hit.slot : place};
    is_ours_ = true;
    if (hit.distance2 <= enough_) return dismissed;
    const TriangleCorners facing = source_.corners(owner);
    is_ours_ = owner_test_.is_ours(point, glm::cross(facing[1] - facing[0], facing[2] - facing[0]));
    if (!is_ours_) return dismissed;
    const double distance = std::sqrt(tree_.distance2_at(point, dismissed.place));
    const bool is_higher = distance > maximum();
    farthest_.take(distance);
    if (is_higher) {
      set_enough();
      farthest_point_ = {point, tree_.triangle_at(dismissed.place), static_cast<float>(distance),
                         source_.place_of(owner)};
    }
    return {distance, dismissed.place};
  }

  /// Of the group's tree: where a search around the point may begin.
  [[nodiscard]] TreeSlot place_near(const Vec3d& point) const {
    const TreeSlot nearest = tree_.find_nearest(tree_.to_frame(point), {}, 0.0F).slot;
    return nearest.is_valid() ? nearest : TreeSlot{0U};
  }

  void set_enough() { enough_ = tree_.squared_in_frame(kDismissShare * maximum()); }

  /// A triangle of the source: its corners, and its inside where that may be farther than the maximum. Returns how many
  /// points were measured.
  std::size_t look_at(std::uint32_t triangle, TreeSlot place) {
    Patch patch;
    patch.corner = source_.corners(triangle);
    const std::array<std::uint32_t, 3> ids = source_.vertices(triangle);
    for (std::size_t k = 0; k < 3; ++k) {
      patch.at_corner[k] = patch.at_middle[k] = measure_vertex(ids[k], place, triangle);
    }
    const double enough = kWorthwhile * maximum();
    if (!(bound_by_one_triangle(tree_, patch, enough) > enough)) return 3;
    look_inside(triangle, 0.0, place);
    return 10;
  }

  void look_inside(std::uint32_t triangle, double radius, TreeSlot place) {
    if (seen_inside_.has(triangle)) return;  // most are met by each of their corners
    Patch patch;
    patch.corner = source_.corners(triangle);
    double longest2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d edge = patch.corner[(k + 1) % 3] - patch.corner[k];
      longest2 = std::max(longest2, glm::dot(edge, edge));
    }
    if (!(longest2 > kLargeShare * kLargeShare * radius * radius)) return;
    seen_inside_.insert(triangle);
    patch.owner = triangle;
    const std::array<std::uint32_t, 3> ids = source_.vertices(triangle);
    for (std::size_t k = 0; k < 3; ++k) patch.at_corner[k] = measure_vertex(ids[k], place, triangle);
    if (is_near_throughout(patch)) return;
    for (std::size_t k = 0; k < 3; ++k) {
      patch.at_middle[k] = measure(patch.middle(k), patch.at_corner[k].place, triangle);
    }
    const Vec3d center = (patch.corner[0] + patch.corner[1] + patch.corner[2]) / 3.0;
    patch.set_range(measure(center, place, triangle).value);
    large_.push_back(patch);
  }

  /// Whether one triangle of the group is near enough to all three corners, and so to all that is between them: the
  /// distance to a convex set is convex.
  [[nodiscard]] bool is_near_throughout(const Patch& patch) const {
    const double enough = kDismissShare * maximum(), enough2 = enough * enough;
    TreeSlot tried;
    for (const Probe& probe : patch.at_corner) {
      if (probe.value > enough) return false;
      if (probe.place == tried) continue;
      tried = probe.place;
      const TriangleDistance triangle(tree_.corners_at(tried));
      if (std::all_of(patch.corner.begin(), patch.corner.end(),
                      [&](const Vec3d& p) { return triangle.squared_to(p) <= enough2; })) {
        return true;
      }
    }
    return false;
  }

  const SourceTree::Impl& source_;
  const SurfaceTree& tree_;
  OwnerTest& owner_test_;
  Farthest farthest_;
  float enough_ = 0.0F;           ///< squared, in the group tree's frame
  bool is_ours_ = true;           ///< the last point measured: the search may go on from there
  CarriedSample farthest_point_;  ///< of all points measured here
  IdSet seen_, seen_inside_;
  struct Known {
    std::uint32_t vertex;
    SurfaceTree::Hit hit;
  };
  IdTable known_table_;       ///< by vertex
  std::vector<Known> known_;  ///< vertices of the source that were looked for
  std::vector<Reached> frontier_;
  std::vector<Patch> large_;
};

/// The farthest few, the farthest first.
std::vector<CarriedSample> choose_seeds(std::span<const CarriedSample> samples, double least) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (static_cast<double>(samples[i].distance) > least) order.push_back(i);
  }
  const auto is_farther = [&](std::uint32_t a, std::uint32_t b) {
    return samples[a].distance != samples[b].distance ? samples[a].distance > samples[b].distance : a < b;
  };
  const std::size_t count = std::min(order.size(), kMaxSeeds);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), is_farther);
  std::vector<CarriedSample> seeds;
  for (std::size_t i = 0; i < count; ++i) seeds.push_back(samples[order[i]]);
  return seeds;
}

/// Of the triangles that the group replaces, those at folds and borders: the middles and corners that are farthest from
/// it, if farther than `least`. A notch, a tunnel or a gap between loose pieces may open there that no carried sample
/// lies in; elsewhere what lies between samples is no farther than their surroundings.
std::vector<Vec3d> choose_far_points(const GroupSurface& finer, std::span<const std::uint8_t> is_folded,
                                     const SurfaceTree& group_tree, double least) {
  struct Far {
    double minus_distance2;
    std::uint32_t order;
    Vec3d point;
    [[nodiscard]] bool operator<(const Far& other) const {
      return minus_distance2 != other.minus_distance2 ? minus_distance2 < other.minus_distance2 : order < other.order;
    }
  };
  std::vector<Far> far;
  const float enough2 = group_tree.squared_in_frame(least);
  TreeSlot place{0U};
  std::uint32_t order = 0;
  const auto consider = [&](const Vec3d& point) {
    const Vec3f at = group_tree.to_frame(point);
    SurfaceTree::Hit hit = group_tree.look_around(at, place, {});
    if (!(hit.distance2 <= enough2)) hit = group_tree.find_nearest(at, hit, enough2);
    if (!hit.slot.is_valid()) return;
    place = hit.slot;
    if (!(hit.distance2 <= enough2)) far.push_back({-group_tree.distance2_at(point, place), order++, point});
  };
  std::vector<std::uint8_t> is_seen(finer.positions.size(), 0);
  for (std::uint32_t t = 0; t < finer.triangles.size(); ++t) {
    if (is_folded[t] == 0) continue;
    const auto& ids = finer.triangles[t];
    consider((finer.positions[ids[0]] + finer.positions[ids[1]] + finer.positions[ids[2]]) / 3.0);
    for (const std::uint32_t v : ids) {
      if (is_seen[v] == 0) consider(finer.positions[v]);
      is_seen[v] = 1;
    }
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(far.size(), kMaxSeeds));
  std::partial_sort(far.begin(), far.begin() + count, far.end());
  std::vector<Vec3d> points;
  for (std::ptrdiff_t i = 0; i < count; ++i) points.push_back(far[static_cast<std::size_t>(i)].point);
  return points;
}

/// How far apart the group's triangles are: about one edge.
double triangle_spacing(const GroupSurface& group) {
  double area = 0.0;
  for (const auto& t : group.triangles) {
    const Vec3d& a = group.positions[t[0]];
    area += 0.5 * glm::length(glm::cross(group.positions[t[1]] - a, group.positions[t[2]] - a));
  }
  return 1.5 * std::sqrt(area / static_cast<double>(group.triangles.size()));
}

}  // namespace

bool OwnerTest::is_ours(const Vec3d& point, const Vec3d& facing) {
  if (is_whole_) return true;
  if (tree_.size() == 0) tree_.build({finer_.positions, finer_.triangles});
  const Vec3f at = tree_.to_frame(point);
  const SurfaceTree::Hit hit = tree_.find_nearest(at, tree_.look_around(at, place_, {}), 0.0F);
  if (!hit.slot.is_valid()) return false;
  place_ = hit.slot;
  const TriangleCorners corners = tree_.corners_at(place_);
  if (!(std::sqrt(point_triangle_distance2(point, corners)) <= reach_)) return false;
  const std::uint32_t triangle = tree_.triangle_at(place_);
  const NearestFeature feature = nearest_feature(point, corners);
  const auto& ids = finer_.triangles[triangle];
  if (feature.kind == NearestFeature::Kind::kEdge && edges_.is_border(triangle, feature.index) &&
      is_shared(ids[feature.index]) && is_shared(ids[(feature.index + 1) % 3])) {
    return false;
  }
  if (feature.kind == NearestFeature::Kind::kCorner && edges_.is_border_position[ids[feature.index]] != 0 &&
      is_shared(ids[feature.index])) {
    return false;
  }
  return glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), facing) >= 0.0;
}

Farthest search_source(const SourceTree::Impl& source, const GroupSurface& group, const SurfaceTree& group_tree,
                       OwnerTest& owner, std::span<const std::uint8_t> is_folded, Farthest farthest,
                       std::span<const CarriedSample> high, std::size_t budget, std::vector<CarriedSample>& samples) {
  if (!owner.is_known()) return farthest;
  const double radius = triangle_spacing(group);
  SourceSearch search(source, group_tree, owner, farthest);
  std::vector<CarriedSample> found;
  const auto search_around_all = [&](std::span<const CarriedSample> seeds, double within) {
    std::size_t discs = 0;
    for (const CarriedSample& seed : seeds) {
      if (discs < (budget < kLeastExtra ? kUsualDiscs : kMaxSeeds)) {
        discs += search.search_around(seed, within, found) >= kNewDisc ? 1 : 0;
      }
    }
  };
  const bool is_known =
      owner.is_whole() && source.triangles.size() >= kManyTriangles && search.search_everywhere(kPointsOfMany, found);
  if (!is_known) {
    search_around_all(choose_seeds(samples, kSeedShare * farthest.to_beat()), radius);
    search_around_all(choose_seeds(high, kSeedShare * farthest.to_beat()), 0.5 * radius);
    for (const Vec3d& point : choose_far_points(owner.finer(), is_folded, group_tree, kFarShare * search.maximum())) {
      search.search_behind(point);
    }
  }
  if (owner.is_whole()) {
    if (!is_known) search.search_everywhere(kPointsPerPart * budget, found);
    search.refine({kRefineBudget + budget / 4, budget / 4, kHighestRise}, found);
  } else {
    search.refine({kRefineBudget, 0, kHighestRise}, found);
  }
  samples.insert(samples.end(), found.begin(), found.end());
  return search.farthest();
}

}  // namespace meshlode::builder
