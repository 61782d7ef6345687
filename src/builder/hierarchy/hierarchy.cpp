// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/hierarchy/hierarchy.h"

#include "base/parallel.h"
#include "builder/hierarchy/bvh.h"
#include "builder/hierarchy/culling_bounds.h"
#include "builder/hierarchy/lod_bounds.h"

namespace meshlode::builder {

Hierarchy build_hierarchy(const LodDag& dag, const PreparedMesh& mesh, EnclosingBall enclose) {
  Hierarchy hierarchy;
  const std::size_t cluster_count = dag.clusters.size();
  hierarchy.cluster_spheres.resize(cluster_count);
  hierarchy.cluster_cones.resize(cluster_count);
  parallel_for_each_index(cluster_count, 16, [&](std::size_t i) {
    hierarchy.cluster_spheres[i] = culling_sphere(dag, dag.clusters[i], mesh.grid, enclose);
    hierarchy.cluster_cones[i] = normal_cone(dag, dag.clusters[i]);
  });

  hierarchy.sphere_log2 = choose_sphere_log2(hierarchy.cluster_spheres);
  for (Hierarchy::Sphere& sphere : hierarchy.cluster_spheres) sphere = snap_sphere(sphere, hierarchy.sphere_log2);

  LodBounds bounds = nest_lod_bounds(dag, hierarchy.cluster_spheres, enclose);
  std::vector<std::uint32_t> levels(dag.groups.size());
  for (std::size_t g = 0; g < levels.size(); ++g) levels[g] = dag.groups[g].level;
  hierarchy.nodes = build_bvh(bounds.spheres, bounds.errors, levels);
  hierarchy.group_spheres = std::move(bounds.spheres);
  hierarchy.group_errors = std::move(bounds.errors);
  return hierarchy;
}

}  // namespace meshlode::builder
