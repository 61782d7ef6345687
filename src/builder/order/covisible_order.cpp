// SPDX-License-Identifier: GPL-3.0-or-later
// Each group gets a bit per training view: does the view need it? Two groups are as alike as their bits overlap
// (Jaccard), with a little for nearness. METIS halves a level again and again so that alike groups stay together, and
// of two halves the one that continues the groups before them comes first.
#include "builder/order/covisible_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/vec.h"
#include "builder/cluster/partition.h"
#include "builder/hierarchy/margins.h"
#include "format/grid.h"

namespace meshlode::builder {

namespace {

/// A picture of 1080 rows at one pixel, 60 degrees high, 16:9. The distances are relative to the mesh, so that another
/// picture needs what this one needs from a little further off.
constexpr double kTanY = 0.57735026918962573, kTanX = kTanY * 16.0 / 9.0;
constexpr double kPixelsPerUnit = 1080.0 / (2.0 * kTanY);

struct TrainingView {
  Vec3d eye, forward, right, up;
  double near_distance;
};

/// A level of more groups is first halved along its longest axis: the graph below has an edge for each pair.
constexpr std::size_t kMostInGraph = 512;
/// Weights of an edge: a whole overlap, and two groups in one place. The ratio is not delicate.
constexpr std::uint32_t kOverlapWeight = 1000;
constexpr double kNearWeight = 100.0;

/// What of a group can be seen.
struct GroupBounds {
  Vec3d center{0.0};
  double radius = 0.0;
};

Vec3d unit_of(const Vec3d& v) {
  return v / length_of(v);
}

Vec3d random_direction(SplitMix64& random) {
  for (;;) {
    const double x = random.signed_unit(), y = random.signed_unit(), z = random.signed_unit();
    const Vec3d v(x, y, z);
    const double length = length_of(v);
    if (length > 0.1 && length <= 1.0) return v / length;
  }
}

std::vector<GroupBounds> bounds_of(const OrderedGroups& mesh) {
  std::vector<GroupBounds> bounds(mesh.groups.size());
  for (std::size_t g = 0; g < bounds.size(); ++g) {
    const std::span members(mesh.clusters.data() + mesh.groups[g].first_cluster, mesh.groups[g].cluster_count);
    for (const OrderedGroups::Cluster& member : members) bounds[g].center += center_of(member.sphere);
    bounds[g].center /= static_cast<double>(members.size());
    for (const OrderedGroups::Cluster& member : members) {
      const double reach = length_of(center_of(member.sphere) - bounds[g].center) + double{member.sphere.radius};
      bounds[g].radius = std::max(bounds[g].radius, reach);
    }
  }
  return bounds;
}

/// Looking at groups drawn at random, from half the mesh's radius to eight: nearer a small piece is seen, further away
/// nothing but the top is needed. Ranges from a quarter to sixteen, to four and to two radii do no better at 32 KiB.
std::vector<TrainingView> training_views(std::span<const GroupBounds> bounds) {
  Box3d box;
  for (const GroupBounds& group : bounds) box.add({group.center - group.radius, group.center + group.radius});
  const double radius = 0.5 * length_of(box.size());
  SplitMix64 random(1);
  std::vector<TrainingView> views(kTrainingViews);
  for (TrainingView& view : views) {
    const Vec3d target = bounds[random.below(bounds.size())].center;
    const double distance = (1.0 + random.unit()) * format::exp2_exact(static_cast<int>(random.below(4)) - 1);
    view.forward = random_direction(random);
    view.eye = target - view.forward * (distance * radius);
    Vec3d side = random_direction(random);
    while (length_of(glm::cross(view.forward, side)) < 0.1) side = random_direction(random);
    view.right = unit_of(glm::cross(view.forward, side));
    view.up = glm::cross(view.right, view.forward);
    view.near_distance = 0.01 * radius;
  }
  return views;
}

bool is_in_frustum(const TrainingView& view, const GroupBounds& group) {
  const Vec3d to = group.center - view.eye;
  const double depth = glm::dot(to, view.forward);
  const auto is_outside = [&](const Vec3d& axis, double tangent) {
    return std::abs(glm::dot(to, axis)) - depth * tangent > group.radius * std::sqrt(1.0 + tangent * tangent);
  };
  return depth >= -group.radius && !is_outside(view.right, kTanX) && !is_outside(view.up, kTanY);
}

/// Whether the group's own clusters are too coarse a replacement: the rule of docs/reference/selection.md.
bool is_refined(const TrainingView& view, const Hierarchy::Sphere& sphere, double error) {
  const double distance = length_of(center_of(sphere) - view.eye) - double{sphere.radius};
  return error * kPixelsPerUnit > std::max(distance, view.near_distance);
}

/// Which views need each group: to draw its clusters, or because a finer group cannot be drawn without it.
std::vector<ViewBits> views_that_need(const OrderedGroups& mesh, std::span<const GroupBounds> bounds) {
  const std::vector<TrainingView> views = training_views(bounds);
  std::vector<ViewBits> needs(mesh.groups.size());
  parallel_for_each_index(needs.size(), 8, [&](std::size_t g) {
    needs[g].fill(0);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const OrderedGroups::Group& group = mesh.groups[g];
      const bool is_needed =
          is_refined(views[v], group.sphere, double{group.error}) && is_in_frustum(views[v], bounds[g]);
      if (is_needed) needs[g][v / 64] |= std::uint64_t{1} << (v % 64);
    }
  });
  // Groups lie from coarse to fine: backwards, a finer group is complete before it is handed on.
  for (std::size_t c = mesh.clusters.size(); c-- > 0;) {
    if (mesh.clusters[c].own_group == kNoId) continue;
    const ViewBits& finer = needs[mesh.clusters[c].own_group];
    ViewBits& coarser = needs[mesh.clusters[c].coarser_group];
    for (std::size_t w = 0; w < finer.size(); ++w) coarser[w] |= finer[w];
  }
  return needs;
}

class LevelOrder {
 public:
  LevelOrder(const OrderedGroups& mesh, std::span<const GroupBounds> bounds, std::span<const ViewBits> needs)
      : mesh_(mesh), bounds_(bounds), needs_(needs) {}

  /// `groups` become their order; what comes first continues `before`, where there is one.
  void order(std::span<std::uint32_t> groups, std::uint32_t before) const {
    if (groups.size() < 2) return;
    const std::size_t middle = groups.size() > kMostInGraph ? split_in_space(groups) : split_by_views(groups);
    if (before != kNoId && likeness(before, groups.subspan(middle)) > likeness(before, groups.first(middle))) {
      std::rotate(groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(middle), groups.end());
      return order_halves(groups, groups.size() - middle, before);
    }
    order_halves(groups, middle, before);
  }

 private:
  void order_halves(std::span<std::uint32_t> groups, std::size_t middle, std::uint32_t before) const {
    order(groups.first(middle), before);
    order(groups.subspan(middle), groups[middle - 1]);
  }

  [[nodiscard]] std::int32_t weight(std::uint32_t a, std::uint32_t b) const {
    std::uint32_t both = 0, either = 0;
    for (std::size_t w = 0; w < needs_[a].size(); ++w) {
      both += static_cast<std::uint32_t>(std::popcount(needs_[a][w] & needs_[b][w]));
      either += static_cast<std::uint32_t>(std::popcount(needs_[a][w] | needs_[b][w]));
    }
    const double size = bounds_[a].radius + bounds_[b].radius;
    const double reach = size + length_of(bounds_[a].center - bounds_[b].center);
    const double near = reach > 0.0 ? kNearWeight * size / reach : kNearWeight;
    return static_cast<std::int32_t>(1 + (either > 0 ? kOverlapWeight * both / either : 0)) +
           static_cast<std::int32_t>(near);
  }

  [[nodiscard]] double likeness(std::uint32_t group, std::span<const std::uint32_t> others) const {
    std::int64_t sum = 0;
    for (const std::uint32_t other : others) sum += weight(group, other);
    return static_cast<double>(sum) / static_cast<double>(others.size());
  }

  std::size_t split_in_space(std::span<std::uint32_t> groups) const {
    Box3d centers;
    for (const std::uint32_t g : groups) centers.add(bounds_[g].center);
    const int longest = centers.longest_axis();
    std::sort(groups.begin(), groups.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double x = bounds_[a].center[longest], y = bounds_[b].center[longest];
      return x != y ? x < y : a < b;
    });
    return groups.size() / 2;
  }

  std::size_t split_by_views(std::span<std::uint32_t> groups) const {
    const std::size_t count = groups.size();
    if (count == 2) return 1;
    Graph graph;
    graph.row_start.push_back(0);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        if (i == j) continue;
        graph.neighbor.push_back(static_cast<std::int32_t>(j));
        graph.edge_weight.push_back(weight(groups[i], groups[j]));
      }
      graph.row_start.push_back(static_cast<std::int32_t>(graph.neighbor.size()));
      graph.node_weight.push_back(static_cast<std::int32_t>(mesh_.groups[groups[i]].cluster_count));
    }
    const std::vector<std::uint32_t> half = partition_graph(graph, 2);
    std::vector<std::uint32_t> second;
    std::size_t first = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (half[i] != 0) {
        second.push_back(groups[i]);
      } else {
        groups[first++] = groups[i];
      }
    }
    std::copy(second.begin(), second.end(), groups.begin() + static_cast<std::ptrdiff_t>(first));
    return first;
  }

  const OrderedGroups& mesh_;
  std::span<const GroupBounds> bounds_;
  std::span<const ViewBits> needs_;
};

/// Where groups begin that may change places: of one level, and of its terminal ones or the others. And the end.
std::vector<std::size_t> run_starts(std::span<const OrderedGroups::Group> groups) {
  std::vector<std::size_t> starts;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const bool is_next =
        g == 0 || groups[g].level != groups[g - 1].level || groups[g].is_terminal != groups[g - 1].is_terminal;
    if (is_next) starts.push_back(g);
  }
  starts.push_back(groups.size());
  return starts;
}

template <class T>
void permute(std::vector<T>& items, std::span<const std::uint32_t> order) {
  std::vector<T> out;
  out.reserve(items.size());
  for (const std::uint32_t i : order) out.push_back(items[i]);
  items = std::move(out);
}

void apply_order(std::span<const std::uint32_t> group_order, LodDag& dag, Hierarchy& hierarchy) {
  std::vector<std::uint32_t> new_id(group_order.size()), cluster_order;
  cluster_order.reserve(dag.clusters.size());
  for (std::uint32_t g = 0; g < group_order.size(); ++g) {
    const DagGroup& group = dag.groups[group_order[g]];
    new_id[group_order[g]] = g;
    for (std::uint32_t c = 0; c < group.cluster_count; ++c) cluster_order.push_back(group.first_cluster + c);
  }
  permute(dag.groups, group_order);
  permute(hierarchy.group_spheres, group_order);
  permute(hierarchy.group_errors, group_order);
  permute(dag.clusters, cluster_order);
  permute(hierarchy.cluster_spheres, cluster_order);
  permute(hierarchy.cluster_cones, cluster_order);
  std::uint32_t next = 0;
  for (DagGroup& group : dag.groups) {
    group.first_cluster = next;
    next += group.cluster_count;
  }
  for (DagCluster& cluster : dag.clusters) {
    cluster.coarser_group.value = new_id[cluster.coarser_group.value];
    if (cluster.own_group.is_valid()) cluster.own_group.value = new_id[cluster.own_group.value];
  }
  for (format::NodeRecord& node : hierarchy.nodes) {
    if (node.child_count == 0) node.first = new_id[node.first];
  }
}

OrderedGroups ordered_groups(const LodDag& dag, const Hierarchy& hierarchy) {
  OrderedGroups mesh;
  mesh.groups.reserve(dag.groups.size());
  for (std::size_t g = 0; g < dag.groups.size(); ++g) {
    const DagGroup& group = dag.groups[g];
    mesh.groups.push_back({group.first_cluster, group.cluster_count, group.level, group.is_terminal,
                           hierarchy.group_spheres[g], hierarchy.group_errors[g]});
  }
  mesh.clusters.reserve(dag.clusters.size());
  for (std::size_t c = 0; c < dag.clusters.size(); ++c) {
    mesh.clusters.push_back(
        {hierarchy.cluster_spheres[c], dag.clusters[c].own_group.value, dag.clusters[c].coarser_group.value});
  }
  return mesh;
}

}  // namespace

CovisibleOrder covisible_order(const OrderedGroups& mesh) {
  CovisibleOrder out;
  out.groups.resize(mesh.groups.size());
  std::iota(out.groups.begin(), out.groups.end(), 0U);
  if (out.groups.empty()) return out;
  const std::vector<GroupBounds> bounds = bounds_of(mesh);
  out.needs = views_that_need(mesh, bounds);
  const LevelOrder level(mesh, bounds, out.needs);
  const std::vector<std::size_t> starts = run_starts(mesh.groups);
  parallel_for_each_index(starts.size() - 1, 1, [&](std::size_t run) {
    level.order(std::span(out.groups).subspan(starts[run], starts[run + 1] - starts[run]), kNoId);
  });
  permute(out.needs, out.groups);
  return out;
}

std::vector<ViewBits> order_by_covisibility(LodDag& dag, Hierarchy& hierarchy) {
  CovisibleOrder order = covisible_order(ordered_groups(dag, hierarchy));
  apply_order(order.groups, dag, hierarchy);
  return std::move(order.needs);
}

}  // namespace meshlode::builder
