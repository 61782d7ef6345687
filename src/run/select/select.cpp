// SPDX-License-Identifier: MIT
// The cut of a scene for a camera, by looking at every group (the rule itself) or through the BVH (the same set, I8),
// and the uniform cut of a mesh. One thread, no dependency: this is what an engine ships.
#include "run/select/select.h"

#include <algorithm>
#include <cstdint>
#include <map>

#include "run/select/open_groups.h"

namespace meshlode::run {
namespace {

enum class Answer : std::uint8_t { kUnknown, kPasses, kFails };

// Draws the clusters of a mesh where the own group passes (or there is none) and the coarser one does not (I5).
// `group_passes` is indexed from the mesh's first group.
template <class Draw>
void draw_cut(const SelectTables& tables, const format::MeshRecord& mesh, const std::vector<std::uint8_t>& group_passes,
              const Draw& draw) {
  for (std::uint32_t i = 0; i < mesh.cluster_count; ++i) {
    const std::uint32_t id = mesh.first_cluster + i;
    const format::ClusterRecord& cluster = tables.clusters[id];
    if (group_passes[cluster.coarser_group - mesh.first_group] != 0) continue;
    if (cluster.own_group != format::kNone && group_passes[cluster.own_group - mesh.first_group] == 0) continue;
    draw(id, cluster);
  }
}

}  // namespace

SelectTables tables_of(const Asset& asset) {
  return {asset.meshes(), asset.instances(), asset.groups(), asset.clusters(), asset.nodes()};
}

std::vector<ClusterInstance> select_flat(const SelectTables& tables, const Camera& camera, double pixel_error,
                                         const AttributeBounds& bounds) {
  std::vector<ClusterInstance> cut;
  std::vector<std::uint8_t> group_passes;
  for (std::size_t i = 0; i < tables.instances.size(); ++i) {
    const format::InstanceRecord& instance = tables.instances[i];
    if (!is_drawable(tables, instance)) continue;
    const format::MeshRecord& mesh = tables.meshes[instance.mesh];
    const MetricView view = make_metric_view(camera, pixel_error, instance, mesh, mesh_reach(tables, mesh));
    const AttributeBounds own_bounds = bounds_for(bounds, mesh);
    group_passes.assign(mesh.group_count, 0);
    for (std::uint32_t g = 0; g < mesh.group_count; ++g) {
      const format::GroupRecord& group = tables.groups[mesh.first_group + g];
      group_passes[g] = passes(view, group) && is_within(own_bounds, group) ? 1 : 0;
    }
    draw_cut(tables, mesh, group_passes, [&](std::uint32_t id, const format::ClusterRecord&) {
      cut.push_back({InstanceId(i), ClusterId(id)});
    });
  }
  return cut;
}

namespace {

/// Stops behind the instance that makes the cut larger than `max_clusters`.
std::vector<ClusterInstance> traverse(const SelectTables& tables, const Camera& camera, double pixel_error,
                                      TraversalCount* count, const AttributeBounds& bounds, std::size_t max_clusters,
                                      const Frustum* frustum) {
  std::vector<ClusterInstance> cut;
  OpenGroups open;
  // All unknown between instances: only what was answered is taken back, so that a far instance costs what it looks at.
  std::vector<Answer> answers;
  std::vector<std::uint32_t> answered;
  std::map<std::uint32_t, std::vector<std::uint8_t>> nodes_within_mesh;
  for (std::size_t i = 0; i < tables.instances.size(); ++i) {
    const format::InstanceRecord& instance = tables.instances[i];
    if (!is_drawable(tables, instance)) continue;
    if (cut.size() > max_clusters) break;
    const format::MeshRecord& mesh = tables.meshes[instance.mesh];
    InstanceView view{mesh, make_metric_view(camera, pixel_error, instance, mesh, mesh_reach(tables, mesh)),
                      frustum_of_mesh(frustum, instance, mesh)};
    const AttributeBounds own_bounds = bounds_for(bounds, mesh);
    // Per node of this mesh, where there are bounds at all; instances of a mesh share it.
    if (own_bounds.has_any()) {
      const auto [found, is_new] = nodes_within_mesh.try_emplace(instance.mesh);
      if (is_new) found->second = find_nodes_within(tables, mesh, own_bounds);
      view.nodes_within = found->second.data();
    }
    for (const std::uint32_t g : answered) answers[g] = Answer::kUnknown;
    answered.clear();
    if (answers.size() < mesh.group_count) answers.resize(mesh.group_count, Answer::kUnknown);
    find_open_groups(tables, view, open);
    for (const auto& [g, crossed] : open.groups) {
      answers[g - mesh.first_group] = Answer::kFails;  // a leaf has its group's own bits
      answered.push_back(g - mesh.first_group);
    }
    for (const auto& [g, crossed] : open.groups) {
      const format::GroupRecord& group = tables.groups[g];
      for (std::uint32_t id = group.first_cluster; id < group.first_cluster + group.cluster_count; ++id) {
        ++open.work.clusters;
        const std::uint32_t own = tables.clusters[id].own_group;
        if (own != format::kNone) {
          Answer& answer = answers[own - mesh.first_group];
          if (answer == Answer::kUnknown) {
            const format::GroupRecord& own_group = tables.groups[own];
            answer =
                passes(view.metric, own_group) && is_within(own_bounds, own_group) ? Answer::kPasses : Answer::kFails;
            answered.push_back(own - mesh.first_group);
          }
          if (answer == Answer::kFails) continue;
        }
        if (is_outside(view, crossed, tables.clusters[id])) continue;
        cut.push_back({InstanceId(i), ClusterId(id)});
      }
    }
  }
  if (count != nullptr) *count = open.work;
  return cut;
}

}  // namespace

std::vector<ClusterInstance> select_bvh(const SelectTables& tables, const Camera& camera, double pixel_error,
                                        TraversalCount* count, const AttributeBounds& bounds, const Frustum* frustum) {
  return traverse(tables, camera, pixel_error, count, bounds, SIZE_MAX, frustum);
}

std::optional<std::vector<ClusterInstance>> select_bvh_within(const SelectTables& tables, const Camera& camera,
                                                              double pixel_error, std::size_t max_clusters,
                                                              const AttributeBounds& bounds) {
  std::vector<ClusterInstance> cut = traverse(tables, camera, pixel_error, nullptr, bounds, max_clusters, nullptr);
  if (cut.size() > max_clusters) return std::nullopt;
  return cut;
}

UniformCut select_uniform(const SelectTables& tables, MeshId mesh_id, double error, CutError by,
                          const AttributeBounds& bounds) {
  const format::MeshRecord& mesh = tables.meshes[mesh_id.value];
  const AttributeBounds own_bounds = bounds_for(bounds, mesh);
  std::vector<std::uint8_t> group_passes(mesh.group_count, 0);
  for (std::uint32_t g = 0; g < mesh.group_count; ++g) {
    const format::GroupRecord& group = tables.groups[mesh.first_group + g];
    const float value = by == CutError::kQuadric ? group.quadric_error : group.error;
    // Terminal groups never pass, whatever their other numbers say.
    const bool is_passing = group.error < format::kInfiniteError && double{value} <= error;
    group_passes[g] = is_passing && is_within(own_bounds, group) ? 1 : 0;
  }
  UniformCut cut;
  cut.stored_error = mesh.level0_deviation;
  draw_cut(tables, mesh, group_passes, [&](std::uint32_t id, const format::ClusterRecord& cluster) {
    cut.clusters.push_back(ClusterId(id));
    if (cluster.own_group != format::kNone) {
      cut.stored_error = std::max(cut.stored_error, double{tables.groups[cluster.own_group].error});
    }
  });
  return cut;
}

std::vector<ClusterInstance> select_flat(const Asset& asset, const Camera& camera, double pixel_error,
                                         const AttributeBounds& bounds) {
  return select_flat(tables_of(asset), camera, pixel_error, bounds);
}

std::vector<ClusterInstance> select_bvh(const Asset& asset, const Camera& camera, double pixel_error,
                                        const AttributeBounds& bounds, const Frustum* frustum) {
  return select_bvh(tables_of(asset), camera, pixel_error, nullptr, bounds, frustum);
}

UniformCut select_uniform(const Asset& asset, MeshId mesh, double error, CutError by, const AttributeBounds& bounds) {
  return select_uniform(tables_of(asset), mesh, error, by, bounds);
}

}  // namespace meshlode::run
