// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/aggregate_dag.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "base/local_ids.h"
#include "base/release.h"
#include "builder/aggregate/thin_mesh.h"
#include "builder/dag/level_pool.h"

namespace meshlode::builder {

namespace {

/// A group that keeps more than this share of its triangles is none: levels are as close as 0.71 together.
constexpr double kStuckRatio = 0.9;

/// Triangles in their order, as many to a cluster as fit. `wedges_of`: of a triangle.
template <class WedgesOf>
void pack_in_order(std::size_t first_label, std::span<const std::uint32_t> triangles, const ClusterCaps& caps,
                   const WedgesOf& wedges_of, Clustering& out) {
  std::vector<std::uint32_t> used;  // by the cluster at work, ascending
  std::uint32_t in_cluster = 0;
  out.count = static_cast<std::uint32_t>(first_label);
  for (const std::uint32_t t : triangles) {
    std::vector<std::uint32_t> with = used;
    for (const std::uint32_t wedge : wedges_of(t)) {
      const auto at = std::lower_bound(with.begin(), with.end(), wedge);
      if (at == with.end() || *at != wedge) with.insert(at, wedge);
    }
    if (in_cluster == 0 || in_cluster == caps.max_triangles || with.size() > caps.max_vertices) {
      ++out.count;
      in_cluster = 0;
      with.clear();
      for (const std::uint32_t wedge : wedges_of(t)) {
        const auto at = std::lower_bound(with.begin(), with.end(), wedge);
        if (at == with.end() || *at != wedge) with.insert(at, wedge);
      }
    }
    used = std::move(with);
    ++in_cluster;
    out.label[t] = out.count - 1;
  }
}

using IsTaken = std::function<bool(const Vec3i& place)>;

/// Twice the triangle's area, along its normal.
Vec3d vector_area(const std::array<Vec3i, 3>& corners) {
  return glm::cross(Vec3d(corners[1] - corners[0]), Vec3d(corners[2] - corners[0]));
}

/// Moves corners by a step or two until no edge can be one that others have: on a coarse grid small cards meet them by
/// chance, and an edge of two groups is no border any more. Of the free places that one is taken which changes area and
/// direction least: a needle may be a step wide. Where there is no room they stay.
void keep_apart(const IsTaken& is_taken, std::array<Vec3i, 3>& corners) {
  constexpr int kFarthest = 2;
  const Vec3d area = vector_area(corners);
  const auto is_free = [&](const Vec3i& place) {
    const auto [low, high] = std::minmax({place.x, place.y, place.z});
    return low >= -format::kMaxGridCoordinate && high <= format::kMaxGridCoordinate && !is_taken(place) &&
           std::find(corners.begin(), corners.end(), place) == corners.end();
  };
  const auto move = [&](std::size_t corner) {
    const Vec3i from = corners[corner];
    Vec3i best = from;
    double least = std::numeric_limits<double>::infinity();
    for (int far = 1; far <= kFarthest && best == from; ++far) {
      for (int x = -far; x <= far; ++x) {
        for (int y = -far; y <= far; ++y) {
          for (int z = -far; z <= far; ++z) {
            const Vec3i place = from + Vec3i(x, y, z);
            if (!is_free(place)) continue;
            std::array<Vec3i, 3> moved = corners;
            moved[corner] = place;
            const double change = glm::length(vector_area(moved) - area);
            if (change >= least) continue;
            least = change;
            best = place;
          }
        }
      }
    }
    corners[corner] = best;
  };
  std::array<bool, 3> taken{};
  for (std::size_t k = 0; k < 3; ++k) taken[k] = is_taken(corners[k]);
  auto left = std::count(taken.begin(), taken.end(), true);
  for (std::size_t k = 0; k < 3 && left > 1; ++k) {
    if (!taken[k]) continue;
    move(k);
    --left;
  }
}

/// The group's triangles on the mesh's grid, each with corners of its own. One that falls together there is left out:
/// it covers nothing.
SimplifyResult on_grid(const ThinGroup& group, const PreparedMesh& mesh, const IsTaken& is_taken) {
  SimplifyResult result;
  const std::size_t stride = mesh.layout.stride();
  constexpr double kMost = format::kMaxGridCoordinate;
  const double step = mesh.grid.step();
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    std::array<Vec3i, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = glm::clamp(group.triangles[t][k] / step, Vec3d(-kMost), Vec3d(kMost));
      corners[k] = Vec3i(static_cast<int>(std::floor(p.x + 0.5)), static_cast<int>(std::floor(p.y + 0.5)),
                         static_cast<int>(std::floor(p.z + 0.5)));
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    keep_apart(is_taken, corners);
    WedgeTriangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = static_cast<std::uint32_t>(result.positions.size());
      result.wedge_position.push_back(triangle[k]);
      result.positions.push_back(corners[k]);
      const auto first = group.attributes.begin() + static_cast<std::ptrdiff_t>(t * stride);
      result.wedge_attributes.insert(result.wedge_attributes.end(), first, first + static_cast<std::ptrdiff_t>(stride));
    }
    result.triangles.push_back(triangle);
    result.triangle_material.push_back(group.material[t]);
  }
  return result;
}

/// Every triangle has corners of its own.
CoarserLevels levels_of(const ThinMesh& thin) {
  std::size_t triangles = 0;
  for (const std::vector<ThinGroup>& level : thin.levels) {
    for (const ThinGroup& group : level) triangles += group.triangles.size();
  }
  return {3 * triangles, 3 * triangles, triangles, false};
}

/// What is live of a run of leaves: clusters, and how good they are.
struct Node {
  std::vector<ClusterId> clusters;
  double pixel_size = 0.0;  ///< the error of the group that they were made from; 0 at level 0
  std::uint32_t triangles = 0;
  bool is_live = true;  ///< nothing has replaced them so far, and something may
};

class AggregateDag {
 public:
  AggregateDag(PreparedMesh& mesh, const DagOptions& options, ThinMesh thin)
      : mesh_(mesh), options_(options), thin_(std::move(thin)), pool_(mesh, levels_of(thin_)) {}

  Result<LodDag> run() {
    add_level0();
    for (std::uint32_t level = 1; level <= thin_.levels.size(); ++level) {
      if (!report(level - 1)) return Error{ErrorCode::kBuildFailed, "", "cancelled"};
      add_level(level);
    }
    end_all();
    pool_.finish();
    return assemble_dag(std::move(pool_), mesh_);
  }

 private:
  [[nodiscard]] bool report(std::uint32_t level) const {
    if (!options_.on_level) return true;
    std::uint64_t triangles = 0;
    for (const Node& node : nodes_) triangles += node.triangles;
    return options_.on_level(level, triangles);
  }

  void add_level0() {
    const ByPiece& leaves = thin_.leaf_triangles;
    leaf_of_position_.resize(pool_.positions.size());
    for (std::uint32_t leaf = 0; leaf < leaves.size(); ++leaf) {
      for (const std::uint32_t t : leaves.of(leaf)) {
        for (const std::uint32_t wedge : mesh_.triangles[t]) leaf_of_position_[pool_.wedge_position[wedge]] = leaf;
      }
    }
    Clustering clustering;
    clustering.label.resize(mesh_.triangles.size());
    std::uint32_t first = 0;
    for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf) {
      pack_in_order(
          first, leaves.of(leaf), options_.caps, [&](std::uint32_t t) { return mesh_.triangles[t]; }, clustering);
      Node node;
      for (std::uint32_t c = first; c < clustering.count; ++c) node.clusters.push_back(ClusterId(c));
      node.triangles = static_cast<std::uint32_t>(leaves.of(leaf).size());
      first = clustering.count;
      nodes_.push_back(std::move(node));
    }
    pool_.add_level0(mesh_.triangles, mesh_.triangle_material, clustering);
    release(mesh_.triangles, mesh_.triangle_material);
    thin_.leaf_triangles = {};
  }

  /// Nodes of the next level: two of this one, or one where all leaves are in one node already.
  void add_level(std::uint32_t level) {
    const std::vector<ThinGroup>& groups = thin_.levels[level - 1];
    const std::size_t children = nodes_.size() / groups.size();
    std::vector<Node> next;
    pool_.begin_round();
    for (std::size_t g = 0; g < groups.size(); ++g) {
      Node all;
      for (std::size_t k = 0; k < children; ++k) {
        const Node& child = nodes_[g * children + k];
        all.clusters.insert(all.clusters.end(), child.clusters.begin(), child.clusters.end());
        all.pixel_size = std::max(all.pixel_size, child.pixel_size);
        all.triangles += child.triangles;
        all.is_live = all.is_live && child.is_live;
      }
      if (replaced(groups[g], all)) {
        next.push_back(std::move(made_));
      } else {
        // The level above may have a way for the same leaves.
        const bool has_another =
            level < thin_.levels.size() ? thin_.levels[level].size() == groups.size() : children == 1;  // or the end
        next.push_back(has_another ? std::move(all) : ended(g * children, children));
      }
    }
    pool_.end_round();
    nodes_ = std::move(next);
    for (ThinGroup& group : thin_.levels[level - 1]) group = {};
  }

  /// Makes `made_` of a group and its children; false where they stay.
  bool replaced(const ThinGroup& thin, const Node& children) {
    if (!children.is_live || children.clusters.empty() ||
        !(thin.pixel_size < std::numeric_limits<double>::infinity())) {
      return false;
    }
    const SimplifyResult result = on_grid(thin, mesh_, [&](const Vec3i& place) {
      const std::uint32_t id = pool_.find_position(place);
      // What stands where its own pieces stood meets nobody.
      return id != kNoId && (leaf_of_position_[id] < thin.first_leaf || leaf_of_position_[id] >= thin.end_leaf);
    });
    if (result.triangles.empty() || static_cast<double>(result.triangles.size()) > kStuckRatio * children.triangles)
      return false;
    std::size_t bytes = 0;
    for (const ClusterId c : children.clusters) bytes += bytes_of(c);
    if (does_not_fit(bytes)) return false;  // what stayed so far, or pieces that no leaf parts
    Clustering clustering;
    clustering.label.resize(result.triangles.size());
    std::vector<std::uint32_t> order(result.triangles.size());
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    pack_in_order(
        0, order, options_.caps, [&](std::uint32_t t) { return result.triangles[t]; }, clustering);
    made_ = {};
    BuildGroup group;
    group.is_aggregate = true;
    group.clusters = children.clusters;
    made_.pixel_size = std::max(thin.pixel_size, children.pixel_size);
    for (const ClusterId c : group.clusters) group.level = std::max(group.level, pool_.cluster(c).level);
    group.quadric_error = made_.pixel_size;
    const auto first = static_cast<std::uint32_t>(pool_.clusters.size());
    for (std::uint32_t c = 0; c < clustering.count; ++c) made_.clusters.push_back(ClusterId(first + c));
    made_.triangles = static_cast<std::uint32_t>(result.triangles.size());
    const NewClusters added{result, clustering, group.level + 1, GroupId(pool_.groups.size())};
    pool_.groups.push_back(std::move(group));
    pool_.add_simplified({&added, 1});
    leaf_of_position_.resize(pool_.positions.size(), thin.first_leaf);
    // What two have is nobody's own.
    for (const Vec3i& place : result.positions) {
      std::uint32_t& leaf = leaf_of_position_[pool_.find_position(place)];
      if (leaf < thin.first_leaf || leaf >= thin.end_leaf) leaf = kNoId;
    }
    return true;
  }

  /// Of a page, at most; 0 where pages have no limit.
  [[nodiscard]] std::size_t bytes_of(ClusterId cluster) const {
    if (options_.max_group_bytes == 0) return 0;
    const BuildCluster& asked = pool_.cluster(cluster);
    return options_.cluster_bytes(asked.vertex_count, asked.triangle_count, pool_.count_materials(asked));
  }
  [[nodiscard]] bool does_not_fit(std::size_t bytes) const {
    return options_.max_group_bytes > 0 && bytes > options_.max_group_bytes;
  }

  /// What stays of a run of nodes becomes terminal groups.
  Node ended(std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) end(nodes_[k], StuckReason::kComponents);
    Node node;
    node.is_live = false;
    for (std::size_t k = first; k < first + count; ++k) node.triangles += nodes_[k].triangles;
    return node;
  }

  /// As many groups as its clusters need pages.
  void end(Node& node, StuckReason reason) {
    BuildGroup group;
    group.is_terminal = true;
    group.stuck_reason = reason;
    std::size_t bytes = 0;
    const auto end_group = [&] {
      if (!group.clusters.empty()) pool_.groups.push_back(group);
      group.clusters.clear();
      group.level = 0;
      bytes = 0;
    };
    for (const ClusterId c : std::exchange(node.clusters, {})) {
      const std::size_t more = bytes_of(c);
      if (does_not_fit(bytes + more)) end_group();
      bytes += more;
      group.clusters.push_back(c);
      group.level = std::max(group.level, pool_.cluster(c).level);
    }
    end_group();
  }

  void end_all() {
    const auto live =
        std::count_if(nodes_.begin(), nodes_.end(), [](const Node& node) { return !node.clusters.empty(); });
    for (Node& node : nodes_) {
      const bool is_top = live == 1 && node.clusters.size() == 1;
      end(node, is_top ? StuckReason::kNotStuck : StuckReason::kComponents);
    }
  }

  PreparedMesh& mesh_;
  const DagOptions& options_;
  ThinMesh thin_;
  BuildPool pool_;
  std::vector<std::uint32_t> leaf_of_position_;  ///< of the pool: a leaf of the group that has it; kNoId: of two
  std::vector<Node> nodes_;
  Node made_;
};

/// So many triangles of the source in a finest group that its clusters fit a page, and those of any coarser group too.
std::uint32_t leaf_triangles(const DagOptions& options) {
  ThinOptions usual;
  if (options.max_group_bytes == 0) return usual.leaf_triangles;
  // A triangle has at most three vertices of its own, in every level, and clusters of a group are full but for the
  // last.
  const std::uint32_t loose = std::max(1U, std::min(options.caps.max_triangles, options.caps.max_vertices / 3));
  const double bytes = options.cluster_bytes(3 * loose, loose, 2) / static_cast<double>(loose);
  const double most = 0.9 / kMostOfLeaf * options.max_group_bytes / bytes;
  return std::min(usual.leaf_triangles, static_cast<std::uint32_t>(most));
}

}  // namespace

Result<LodDag> build_aggregate_dag_and_free(PreparedMesh& mesh, std::span<const SourceMaterial> materials,
                                            const DagOptions& options) {
  if (mesh.triangles.empty()) return LodDag{};
  ThinMesh thin = thin_mesh(mesh, materials, {.leaf_triangles = leaf_triangles(options)});
  return AggregateDag(mesh, options, std::move(thin)).run();
}

}  // namespace meshlode::builder
