// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/measure.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "base/local_ids.h"
#include "base/parallel.h"
#include "base/release.h"
#include "builder/deviation/attribute_deviation.h"
#include "builder/deviation/deviation.h"
#include "builder/measure/canonical_form.h"
#include "builder/measure/groups_by_level.h"
#include "builder/measure/kept_samples.h"
#include "builder/measure/shared_positions.h"
#include "builder/measure/whole_cuts.h"

namespace meshlode::builder {

namespace {

/// Carried on at least: where few triangles stand for many vanished pieces, each stands for more than two samples say.
constexpr std::size_t kSamplesPerGroup = 4096;
/// Spread over the groups of a level: coarse levels have few, of large triangles, and cost next to nothing.
constexpr std::size_t kExtraEffort = 1500;

/// Clusters of the DAG as one surface, off the grid. Positions are in the order of their ids.
struct ClusterSurface {
  std::vector<std::uint32_t> position_ids;  ///< of `positions`, ascending
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<WedgeTriangle> vertices;             ///< the same triangles, of LodDag's vertices
  std::vector<std::uint32_t> first_of_cluster{0};  ///< triangles; one more than clusters

  ClusterSurface(const PreparedMesh& mesh, const LodDag& dag, std::span<const std::uint32_t> position_of_vertex,
                 std::span<const std::uint32_t> clusters) {
    std::size_t count = 0;
    for (const std::uint32_t c : clusters) count += dag.clusters[c].triangle_count;
    triangles.reserve(count);
    vertices.reserve(count);
    LocalIds ids(count);
    std::vector<Vec3i> on_grid;
    for (const std::uint32_t c : clusters) {
      const DagCluster& cluster = dag.clusters[c];
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        std::array<std::uint32_t, 3> corners{};
        WedgeTriangle of_dag{};
        for (std::size_t k = 0; k < 3; ++k) {
          of_dag[k] = cluster.first_vertex + dag.triangles[t][k];
          corners[k] = ids.add(position_of_vertex[of_dag[k]]);
          if (corners[k] == on_grid.size()) on_grid.push_back(dag.vertex_position[of_dag[k]]);
        }
        triangles.push_back(corners);
        vertices.push_back(of_dag);
      }
      first_of_cluster.push_back(static_cast<std::uint32_t>(triangles.size()));
    }
    const std::vector<std::uint32_t> place = ids.sort();
    position_ids = ids.numbers();
    positions.resize(on_grid.size());
    for (std::size_t p = 0; p < on_grid.size(); ++p) positions[place[p]] = mesh.grid.decode(on_grid[p]);
    for (auto& corners : triangles) {
      for (std::uint32_t& corner : corners) corner = place[corner];
    }
  }
  [[nodiscard]] GroupSurface surface() const { return {positions, triangles}; }
  /// Of the clusters that this was made of, which one has the triangle.
  [[nodiscard]] std::size_t cluster_of(std::uint32_t triangle) const {
    const auto after = std::upper_bound(first_of_cluster.begin(), first_of_cluster.end(), triangle);
    return static_cast<std::size_t>(after - first_of_cluster.begin()) - 1;
  }
};

std::vector<std::uint32_t> members_of(const DagGroup& group) {
  std::vector<std::uint32_t> clusters(group.cluster_count);
  for (std::uint32_t i = 0; i < group.cluster_count; ++i) clusters[i] = group.first_cluster + i;
  return clusters;
}

/// Level by level: each group hands what it knows to the clusters that replace it.
class Measurer {
 public:
  Measurer(const PreparedMesh& mesh, format::ErrorTier tier, const CanonicalForm& form, LodDag& dag)
      : mesh_(mesh),
        dag_(dag),
        form_(form),
        is_certified_(tier == format::ErrorTier::kCertified),
        source_(mesh.exact_positions, mesh.exact_triangles),
        made_of_(clusters_made_of_groups(dag)),
        use_(dag, form.position_of_vertex, form.position_count) {
    is_certified_ ? bound_level0() : sample_level0();
  }

  void run() {
    for (std::vector<std::uint32_t>& groups : groups_by_level(dag_)) {
      std::erase_if(groups, [&](std::uint32_t g) { return dag_.groups[g].is_terminal; });
      if (groups.empty()) continue;
      use_.begin(dag_.groups[groups.front()].level);
      parallel_for_each_index(groups.size(), 1, [&](std::size_t i) { measure_group_at(groups[i], groups.size()); });
    }
  }

 private:
  void bound_level0() {
    bounds_.resize(dag_.triangles.size());
    for (std::size_t t = 0; t < mesh_.exact_triangles.size(); ++t) {
      TriangleCorners3 exact, on_grid;
      for (std::size_t k = 0; k < 3; ++k) {
        exact[k] = mesh_.exact_positions[mesh_.exact_triangles[t][k]];
        on_grid[k] = mesh_.grid.decode(dag_.vertex_position[form_.vertices_of_source[t][k]]);
      }
      bounds_[form_.level0_of_source[t].triangle] = initial_bound(exact, on_grid);
    }
  }

  void sample_level0() {
    samples_.resize(dag_.clusters.size());
    keep(initial_samples(source_), [&](std::uint32_t triangle) { return form_.level0_of_source[triangle].cluster; });
  }

  /// Samples go to the clusters of their triangles, in their order.
  template <class ClusterOf>
  void keep(std::span<const CarriedSample> carried, const ClusterOf& cluster_of) {
    struct Count {
      std::size_t samples = 0, loose = 0;
    };
    std::vector<std::uint32_t> cluster(carried.size());
    LocalIds used(64);
    std::vector<Count> counts;
    for (std::size_t i = 0; i < carried.size(); ++i) {
      cluster[i] = cluster_of(carried[i].triangle);
      const std::uint32_t id = used.add(cluster[i]);
      if (id == counts.size()) counts.emplace_back();
      ++counts[id].samples;
      if (carried[i].vertex == kNoId) ++counts[id].loose;
    }
    for (std::size_t id = 0; id < counts.size(); ++id) {
      samples_[used.numbers()[id]].reserve(counts[id].samples, counts[id].loose);
    }
    for (std::size_t i = 0; i < carried.size(); ++i) samples_[cluster[i]].add(carried[i]);
  }

  void measure_group_at(std::uint32_t id, std::size_t groups_of_level) {
    DagGroup& group = dag_.groups[id];
    group.normal_deviation = group.uv_deviation = 0.0;
    double floor = mesh_.level0_deviation;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag_.clusters[c].own_group;
      if (!own.is_valid()) continue;
      const DagGroup& finer = dag_.groups[own.value];
      floor = std::max(floor, finer.error);
      group.normal_deviation = std::max(group.normal_deviation, finer.normal_deviation);
      group.uv_deviation = std::max(group.uv_deviation, finer.uv_deviation);
    }
    const ClusterSurface before = surface_of(members_of(group)), after = surface_of(made_of_[id]);
    const std::vector<TreeSlot> places = is_certified_
                                             ? certify(group, before, id, after, floor)
                                             : measure_samples(group, before, id, after, floor, groups_of_level);
    const AttributeDeviation attributes =
        measure_attributes(source_, {dag_.vertex_attributes, form_.vertices_of_source}, after.surface(),
                           {dag_.vertex_attributes, after.vertices}, mesh_.layout, places);
    group.normal_deviation = std::max(group.normal_deviation, attributes.normal);
    group.uv_deviation = std::max(group.uv_deviation, attributes.uv);
  }

  [[nodiscard]] ClusterSurface surface_of(std::span<const std::uint32_t> clusters) const {
    return {mesh_, dag_, form_.position_of_vertex, clusters};
  }

  std::vector<TreeSlot> certify(DagGroup& group, const ClusterSurface& before, std::uint32_t id,
                                const ClusterSurface& after, double floor) {
    const DagCluster& first = dag_.clusters[group.first_cluster];
    const CertifiedGroup certified = certify_group(
        before.surface(), std::span(bounds_).subspan(first.first_triangle, before.triangles.size()), after.surface());
    group.deviation = certified.deviation;
    group.error = std::max(floor, certified.deviation);
    std::size_t next = 0;
    for (const std::uint32_t c : made_of_[id]) {
      const DagCluster& cluster = dag_.clusters[c];
      for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
        bounds_[cluster.first_triangle + t] = certified.bounds[next++];
      }
    }
    return {};
  }

  std::vector<TreeSlot> measure_samples(DagGroup& group, const ClusterSurface& before, std::uint32_t id,
                                        const ClusterSurface& after, double floor, std::size_t groups_of_level) {
    std::vector<CarriedSample> samples;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      samples_[c].append_to(samples, mesh_.exact_positions);
      samples_[c].free();  // carried on by the coarser clusters
    }
    std::vector<std::uint8_t> is_shared(before.positions.size());
    for (std::size_t p = 0; p < is_shared.size(); ++p) is_shared[p] = use_.is_shared(before.position_ids[p]) ? 1 : 0;
    // Cards and the like: no neighbour leads to a piece that went, so more of their points have to be carried.
    const std::size_t wanted =
        before.positions.size() > before.triangles.size() ? 16 * kSamplesPerGroup : kSamplesPerGroup;
    const auto per_triangle = static_cast<std::uint32_t>(wanted / std::max<std::size_t>(1, after.triangles.size()));
    GroupDeviation measured = measure_group(source_, after.surface(), samples,
                                            {.floor = floor,
                                             .least = floor / kMeasuredMargin,
                                             .margin = kMeasuredMargin,
                                             .samples_per_triangle = std::clamp(per_triangle, 2U, 64U),
                                             .extra_effort = static_cast<std::uint32_t>(kExtraEffort / groups_of_level),
                                             .finer = before.surface(),
                                             .finer_is_shared = is_shared,
                                             .is_whole = use_.is_one_group()});
    group.deviation = measured.deviation;
    group.error = std::max(floor, kMeasuredMargin * measured.deviation);
    const std::vector<std::uint32_t>& made = made_of_[id];
    keep(measured.carried, [&](std::uint32_t triangle) { return made[after.cluster_of(triangle)]; });
    return std::move(measured.places);
  }

  const PreparedMesh& mesh_;
  LodDag& dag_;
  const CanonicalForm& form_;
  bool is_certified_;
  SourceTree source_;
  std::vector<std::vector<std::uint32_t>> made_of_;
  LevelUse use_;
  std::vector<KeptSamples> samples_;   ///< per cluster; kMeasured
  std::vector<TriangleBound> bounds_;  ///< per triangle of the DAG; kCertified
};

/// What coverage is off by is found when the DAG is made; a tier adds its margin.
void add_margin(format::ErrorTier tier, LodDag& dag) {
  if (tier == format::ErrorTier::kQem) return;
  for (DagGroup& group : dag.groups) {
    if (group.is_terminal) continue;
    group.deviation = group.quadric_error;
    if (tier == format::ErrorTier::kMeasured) group.error = kMeasuredMargin * group.quadric_error;
  }
}

/// What an asset can tell again: the simplifier's estimate as it is stored, and that nothing is measured.
void forget_errors(LodDag& dag) {
  for (DagGroup& group : dag.groups) {
    if (!group.is_terminal && group.quadric_error < double{format::kInfiniteError}) {
      group.quadric_error = static_cast<float>(group.quadric_error);
    }
    group.error = group.quadric_error;
    group.deviation = group.normal_deviation = group.uv_deviation = std::numeric_limits<double>::infinity();
  }
}

}  // namespace

Status measure(const PreparedMesh& mesh, format::ErrorTier tier, LodDag& dag) {
  forget_errors(dag);
  const bool is_aggregate =
      std::any_of(dag.groups.begin(), dag.groups.end(), [](const DagGroup& group) { return group.is_aggregate; });
  if (is_aggregate) add_margin(tier, dag);
  if (is_aggregate || tier == format::ErrorTier::kQem || dag.triangles.empty()) return Ok{};
  Result<CanonicalForm> form = canonical_form(mesh, dag);
  if (!form) return form.error();
  dag.triangles.swap(form->triangles);
  Measurer(mesh, tier, *form, dag).run();
  release(form->position_of_vertex, form->level0_of_source, form->vertices_of_source);
  if (tier == format::ErrorTier::kMeasured) hold_to_whole_cuts(mesh, kMeasuredMargin, dag);
  dag.triangles.swap(form->triangles);
  return Ok{};
}

}  // namespace meshlode::builder
