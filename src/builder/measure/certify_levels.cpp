// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/certify_levels.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "builder/deviation/deviation.h"
#include "builder/measure/group_attributes.h"
#include "builder/measure/groups_by_level.h"
#include "builder/measure/joined_clusters.h"

namespace meshlode::builder {

namespace {

class Certifier {
 public:
  Certifier(const PreparedMesh& mesh, SourceTree source, const CanonicalForm& form, std::span<const double> least,
            LodDag& dag)
      : mesh_(mesh),
        form_(form),
        least_(least),
        dag_(dag),
        source_(std::move(source)),
        attributes_(source_, mesh, form, dag),
        made_of_(clusters_made_of_groups(dag)),
        bounds_(dag.triangles.size()) {
    for (std::size_t t = 0; t < mesh.exact_triangles.size(); ++t) {
      TriangleCorners3 exact, on_grid;
      for (std::size_t k = 0; k < 3; ++k) {
        exact[k] = mesh.exact_positions[mesh.exact_triangles[t][k]];
        on_grid[k] = mesh.grid.decode(dag.vertex_position[form.vertices_of_source[t][k]]);
      }
      bounds_[form.level0_of_source[t].triangle] = initial_bound(exact, on_grid);
    }
  }

  void run() {
    for (const std::vector<std::uint32_t>& groups : groups_by_level(dag_)) {
      parallel_for_each_index(groups.size(), 1, [&](std::size_t i) {
        if (!dag_.groups[groups[i]].is_terminal) certify(groups[i]);
      });
    }
  }

 private:
  [[nodiscard]] JoinedClusters surface_of(std::span<const std::uint32_t> clusters) const {
    return {dag_, mesh_.grid, form_.position_of_vertex, clusters};
  }

  void certify(std::uint32_t id) {
    DagGroup& group = dag_.groups[id];
    double floor = std::max(mesh_.level0_deviation, least_.empty() ? 0.0 : least_[id]);
    std::vector<std::uint32_t> members(group.cluster_count);
    for (std::uint32_t i = 0; i < group.cluster_count; ++i) {
      members[i] = group.first_cluster + i;
      const GroupId own = dag_.clusters[members[i]].own_group;
      if (own.is_valid()) floor = std::max(floor, dag_.groups[own.value].error);
    }
    const JoinedClusters before = surface_of(members), after = surface_of(made_of_[id]);
    const std::span<const TriangleBound> known =
        std::span(bounds_).subspan(dag_.clusters[members.front()].first_triangle, before.triangles.size());
    const CertifiedGroup certified = certify_group(before.surface(), known, after.surface());
    group.deviation = certified.deviation;
    group.error = std::max(floor, certified.deviation);
    std::size_t next = 0;
    for (const std::uint32_t c : made_of_[id]) {
      const DagCluster& cluster = dag_.clusters[c];
      for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
        bounds_[cluster.first_triangle + t] = certified.bounds[next++];
      }
    }
    attributes_.measure(group, made_of_[id], {});
  }

  const PreparedMesh& mesh_;
  const CanonicalForm& form_;
  std::span<const double> least_;
  LodDag& dag_;
  SourceTree source_;
  GroupAttributes attributes_;
  std::vector<std::vector<std::uint32_t>> made_of_;  ///< per group: the clusters made from it
  std::vector<TriangleBound> bounds_;                ///< per triangle of the DAG
};

}  // namespace

void certify_levels(const PreparedMesh& mesh, SourceTree source, const CanonicalForm& form,
                    std::span<const double> least, LodDag& dag) {
  Certifier(mesh, std::move(source), form, least, dag).run();
}

}  // namespace meshlode::builder
