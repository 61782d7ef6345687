// SPDX-License-Identifier: GPL-3.0-or-later
// The growing store of a build: positions, wedges and clusters of all levels so far. Used by the dag room alone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/id_table.h"
#include "base/ids.h"
#include "base/unset_vector.h"
#include "builder/cluster/cluster.h"
#include "builder/dag/triangle_materials.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// A cluster under construction: ranges of BuildPool::triangles and BuildPool::vertices.
struct BuildCluster {
  std::uint32_t level = 0;
  GroupId own_group;  ///< of BuildPool::groups; invalid at level 0
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_vertex = 0, vertex_count = 0;
};

/// A group that has been replaced by coarser clusters.
struct BuildGroup {
  std::uint32_t level = 0;
  std::vector<ClusterId> clusters;  ///< of BuildPool::clusters
  double quadric_error = 0.0;       ///< the simplifier's own estimate, of an aggregate its coverage's; running maximum
  bool is_terminal = false;
  bool is_aggregate = false;
  StuckReason stuck_reason = StuckReason::kNotStuck;
};

/// What a group became, on its way into the pool.
struct NewClusters {
  const SimplifyResult& result;
  const Clustering& clustering;
  std::uint32_t level = 0;
  GroupId own_group;
};

/// Witnesses are points of level 0: their ids; kNoId where there are fewer.
using WitnessIds = std::array<std::uint32_t, Witnesses::kCapacity>;

/// What coarser levels will add to a pool, about.
struct CoarserLevels {
  std::size_t positions = 0, wedges = 0, triangles = 0;
  bool has_witnesses = true;  ///< whether anybody asks for witnesses_at()
};
/// Every level has about half of the finer one's.
[[nodiscard]] CoarserLevels halved_levels(const PreparedMesh& mesh);

class BuildPool {
 public:
  /// Takes the mesh's positions and wedges: here they keep their ids.
  BuildPool(PreparedMesh& mesh, const CoarserLevels& coarser);

  /// Adds the clusters of level 0, in the clustering's order. `triangles` are of wedges of this pool.
  void add_level0(const std::vector<WedgeTriangle>& triangles, const std::vector<std::uint32_t>& materials,
                  const Clustering& clustering);

  /// Adds what groups became, one after the other. Positions and wedges that are already known (locked ones, or a
  /// coincidence on the grid) keep their id, so that equal integers are equal ids at every level, and equal attributes
  /// with them. Witnesses of positions that were there at begin_round() change at end_round(): until then every group
  /// of a round sees the same.
  void add_simplified(std::span<const NewClusters> added);
  void begin_round() { round_positions_ = positions.size(); }
  /// The vertex of any level that is there; kNoId: none.
  [[nodiscard]] std::uint32_t find_position(const Vec3i& position) const;
  /// Whether one was when the round began.
  [[nodiscard]] bool had_place(const Vec3i& position) const;
  void end_round();
  /// Nothing will be added or simplified any more: frees what only that needs.
  void finish();

  [[nodiscard]] std::span<const std::uint32_t> vertices_of(const BuildCluster& cluster) const {
    return std::span(vertices).subspan(cluster.first_vertex, cluster.vertex_count);
  }
  /// The distinct positions of a cluster, ascending.
  [[nodiscard]] std::vector<std::uint32_t> positions_of(const BuildCluster& cluster) const;
  [[nodiscard]] std::uint32_t count_materials(const BuildCluster& cluster) const;

  [[nodiscard]] Witnesses witnesses_at(std::uint32_t position) const;
  [[nodiscard]] BuildCluster& cluster(ClusterId id) { return clusters[id.value]; }
  [[nodiscard]] const BuildCluster& cluster(ClusterId id) const { return clusters[id.value]; }
  [[nodiscard]] const BuildGroup& group(GroupId id) const { return groups[id.value]; }

  std::vector<Vec3i> positions;
  std::vector<WitnessIds> witnesses;  ///< per position; empty where there are none
  std::vector<std::uint32_t> wedge_position;
  std::vector<float> wedge_attributes;
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< of the vertices of their cluster
  std::vector<std::uint32_t> vertices;                 ///< of each cluster its wedges, by first use
  TriangleMaterials triangle_material;
  std::vector<BuildCluster> clusters;
  std::vector<BuildGroup> groups;

 private:
  /// Ids in the pool of what a group became; kNoId: not known yet.
  struct Ids {
    std::vector<std::uint32_t> positions, wedges;
  };
  [[nodiscard]] Ids find_known(const SimplifyResult& result) const;
  void insert_new(const SimplifyResult& result, Ids& ids);
  void prefetch_wedge(const SimplifyResult& result, const Ids& ids, std::size_t wedge) const;
  void add_witnesses(std::uint32_t position, const WitnessIds& more);
  /// Adds clusters and makes room for their triangles. Returns the first one.
  ClusterId add_clusters(const Clustering& clustering, std::uint32_t level, GroupId own_group);
  /// Fills clusters from `first` on. `wedges`: pool ids by the ids in `source`, or nothing where they are pool ids
  /// already. Returns the clusters' vertices, one after the other in parts, for add_vertices().
  std::vector<std::vector<std::uint32_t>> fill_clusters(std::span<const WedgeTriangle> source,
                                                        std::span<const std::uint32_t> wedges,
                                                        std::span<const std::uint32_t> materials,
                                                        const Clustering& clustering, ClusterId first);
  void add_vertices(const std::vector<std::vector<std::uint32_t>>& parts, ClusterId first, std::uint32_t count);

  std::uint32_t position_id(const Vec3i& position);
  std::uint32_t wedge_id(std::uint32_t position, const float* attributes);
  [[nodiscard]] bool is_wedge(std::uint32_t wedge, std::uint32_t position, const float* attributes) const;
  [[nodiscard]] std::uint64_t hash_wedge(std::uint32_t position, const float* attributes) const;

  std::size_t stride_;
  bool has_witnesses_;
  IdTable position_table_, wedge_table_;
  std::size_t round_positions_ = 0;                                   ///< how many there were when the round began
  std::vector<std::pair<std::uint32_t, WitnessIds>> late_witnesses_;  ///< of older positions, in order
};

/// The pool as a LodDag: groups from coarse to fine, clusters by group, vertices by first use. Takes the pool apart.
[[nodiscard]] LodDag assemble_dag(BuildPool&& pool, const PreparedMesh& mesh);

}  // namespace meshlode::builder
