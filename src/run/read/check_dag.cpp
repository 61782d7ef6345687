// SPDX-License-Identifier: MIT
// Groups, clusters and BVH nodes: what makes a walk over them end.
#include <cmath>
#include <string>
#include <vector>

#include "run/read/check_tables.h"
#include "run/read/file_place.h"

namespace meshlode::run {

namespace {

using format::SectionId;

bool is_sphere(const float center[3], float radius) {
  return std::isfinite(center[0]) && std::isfinite(center[1]) && std::isfinite(center[2]) && std::isfinite(radius) &&
         radius >= 0.0F;
}

bool is_error(float error) {
  return std::isfinite(error) && error >= 0.0F;
}

Status check_group(const RawTables& tables, std::size_t g, std::uint32_t mesh_id) {
  const format::GroupRecord& group = tables.groups[g];
  const auto fail = [&](const char* field, const char* detail) {
    return invalid_record(SectionId::kGroups, g, field, detail);
  };
  if (group.mesh != mesh_id) return fail("mesh", "is not the mesh whose range holds the group");
  if (!is_sphere(group.center, group.radius)) {
    return fail("radius", "center and radius must be finite, radius not negative");
  }
  if (!is_error(group.error)) return fail("error", "must be finite and not negative");
  if (!is_error(group.quadric_error)) return fail("quadric_error", "must be finite and not negative");
  if (!is_error(group.deviation)) return fail("deviation", "must be finite and not negative");
  if (!is_error(group.normal_deviation)) return fail("normal_deviation", "must be finite and not negative");
  if (!is_error(group.uv_deviation)) return fail("uv_deviation", "must be finite and not negative");
  if (group.page >= tables.pages.size()) return fail("page", "is out of range");
  const std::uint16_t aggregate = tables.version == format::kPlainVersion ? 0 : format::kGroupAggregate;
  if ((group.flags & ~(format::kGroupTerminal | format::kGroupStuck | aggregate)) != 0) {
    return fail("flags", "has an unknown bit");
  }
  const bool is_terminal = (group.flags & format::kGroupTerminal) != 0;
  if (is_terminal && (group.flags & format::kGroupAggregate) != 0)
    return fail("flags", "a terminal group is no aggregate");
  const bool is_stuck = (group.flags & format::kGroupStuck) != 0;
  if (is_stuck && !is_terminal) return fail("flags", "a stuck group must be terminal");
  if (group.stuck_reason > format::StuckReason::kBorder) return fail("stuck_reason", "is unknown");
  if (is_stuck != (group.stuck_reason != format::StuckReason::kNotStuck)) {
    return fail("stuck_reason", "does not match the flags");
  }
  if (is_terminal != (group.error == format::kInfiniteError)) {
    return fail("error", "must be infinite in terminal groups and nowhere else");
  }
  if (group.level >= tables.meshes[mesh_id].level_count) return fail("level", "is not below the mesh's level_count");
  return Ok{};
}

}  // namespace

Status check_groups(const RawTables& tables) {
  std::uint64_t cluster_end = 0;
  for (std::size_t m = 0; m < tables.meshes.size(); ++m) {
    const format::MeshRecord& mesh = tables.meshes[m];
    const std::uint64_t mesh_cluster_end = std::uint64_t{mesh.first_cluster} + mesh.cluster_count;
    for (std::size_t g = mesh.first_group; g < std::size_t{mesh.first_group} + mesh.group_count; ++g) {
      const format::GroupRecord& group = tables.groups[g];
      if (Status status = check_group(tables, g, static_cast<std::uint32_t>(m)); !status) return status;
      if (group.first_cluster != cluster_end || group.cluster_count < 1 ||
          group.cluster_count > mesh_cluster_end - cluster_end) {
        return invalid_record(SectionId::kGroups, g, "first_cluster", "groups do not partition the mesh's clusters");
      }
      cluster_end += group.cluster_count;
      if (g > mesh.first_group && group.level > tables.groups[g - 1].level) {
        return invalid_record(SectionId::kGroups, g, "level", "groups must go from coarse to fine");
      }
    }
    if (cluster_end != mesh_cluster_end) {
      return invalid_record(SectionId::kMeshes, m, "cluster_count", "clusters are left over behind the last group");
    }
  }
  return Ok{};
}

Status check_clusters(const RawTables& tables) {
  for (std::size_t g = 0; g < tables.groups.size(); ++g) {
    const format::GroupRecord& group = tables.groups[g];
    const format::MeshRecord& mesh = tables.meshes[group.mesh];
    std::uint32_t largest_level = 0;
    for (std::size_t c = group.first_cluster; c < std::size_t{group.first_cluster} + group.cluster_count; ++c) {
      const format::ClusterRecord& cluster = tables.clusters[c];
      const auto fail = [&](const char* field, const char* detail) {
        return invalid_record(SectionId::kClusters, c, field, detail);
      };
      if (cluster.vertex_count() > 3U * cluster.triangle_count()) {
        return fail("vertices_less_1", "is more than the triangles can use");
      }
      if (cluster.coarser_group != g) return fail("coarser_group", "is not the group whose range holds the cluster");
      if (cluster.level > group.level) return fail("level", "is larger than its group's");
      if (cluster.level > largest_level) largest_level = cluster.level;
      if (cluster.own_group == format::kNone) {
        if (cluster.level != 0) return fail("own_group", "only clusters of level 0 have none");
        continue;
      }
      // Made from a finer group, which stands behind its own in the table: so nothing can go round in circles.
      if (cluster.own_group <= g || cluster.own_group - mesh.first_group >= mesh.group_count) {
        return fail("own_group", "must be a later group of the same mesh");
      }
      const format::GroupRecord& own = tables.groups[cluster.own_group];
      if ((own.flags & format::kGroupTerminal) != 0) return fail("own_group", "nothing is made from a terminal group");
      if (cluster.level <= own.level) return fail("level", "must be above the level of the group it was made from");
    }
    if (largest_level != group.level) {
      return invalid_record(SectionId::kGroups, g, "level", "is not the largest level of a member");
    }
  }
  return Ok{};
}

Status check_nodes(const RawTables& tables) {
  for (const format::MeshRecord& mesh : tables.meshes) {
    const std::uint64_t end = std::uint64_t{mesh.first_node} + mesh.node_count;
    std::vector<std::uint8_t> depth(mesh.node_count, 0);  // 0: no parent yet
    if (!depth.empty()) depth[0] = 1;
    for (std::uint64_t n = mesh.first_node; n < end; ++n) {
      const format::NodeRecord& node = tables.nodes[n];
      const auto fail = [&](const char* field, const char* detail) {
        return invalid_record(SectionId::kNodes, n, field, detail);
      };
      const std::uint8_t own_depth = depth[n - mesh.first_node];
      if (own_depth == 0) return fail("first", "no earlier node has this one as a child");
      if (own_depth > kMaxBvhDepth) return fail("first", "the tree is more than 64 nodes deep");
      if (!is_sphere(node.center, node.radius)) {
        return fail("radius", "center and radius must be finite, radius not negative");
      }
      if (!is_error(node.error)) return fail("error", "must be finite and not negative");
      if (node.child_count > format::kBvhWidth) return fail("child_count", "must be 0 to 8");
      if (node.child_count == 0) {
        if (node.first < mesh.first_group || node.first - mesh.first_group >= mesh.group_count) {
          return fail("first", "is not a group of the same mesh");
        }
        continue;
      }
      // Children stand behind their parent and have no other: a tree, so that a traversal ends and visits each once.
      if (node.first <= n || node.first >= end || node.child_count > end - node.first) {
        return fail("first", "children must be later nodes of the same mesh");
      }
      for (std::uint64_t child = node.first; child < std::uint64_t{node.first} + node.child_count; ++child) {
        std::uint8_t& child_depth = depth[child - mesh.first_node];
        if (child_depth != 0) return fail("first", "a child has two parents");
        child_depth = static_cast<std::uint8_t>(own_depth + 1U);
      }
    }
  }
  return Ok{};
}

}  // namespace meshlode::run
