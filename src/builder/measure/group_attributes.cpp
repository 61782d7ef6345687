// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/group_attributes.h"

#include <algorithm>
#include <array>
#include <vector>

#include <meshlode/format.h>

#include "builder/deviation/attribute_deviation.h"
#include "builder/measure/cluster_surface.h"

namespace meshlode::builder {

void measure_group_attributes(const SourceTree& source, const PreparedMesh& mesh, const CanonicalForm& form,
                              std::span<const std::uint32_t> made, std::span<const TreeSlot> near, const LodDag& dag,
                              DagGroup& group) {
  group.normal_deviation = group.uv_deviation = 0.0;
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    const GroupId own = dag.clusters[c].own_group;
    if (!own.is_valid()) continue;
    group.normal_deviation = std::max(group.normal_deviation, dag.groups[own.value].normal_deviation);
    group.uv_deviation = std::max(group.uv_deviation, dag.groups[own.value].uv_deviation);
  }
  ClusterSurface surface;
  std::vector<std::array<std::uint32_t, 3>> vertices;  // of the DAG
  for (const std::uint32_t c : made) {
    const DagCluster& cluster = dag.clusters[c];
    surface.add(dag, mesh.grid, cluster);
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      const auto& l = dag.triangles[t];
      vertices.push_back({cluster.first_vertex + l[0], cluster.first_vertex + l[1], cluster.first_vertex + l[2]});
    }
  }
  const AttributeDeviation found =
      measure_attributes(source, {dag.vertex_attributes, form.vertices_of_source},
                         {surface.positions, surface.triangles}, {dag.vertex_attributes, vertices}, mesh.layout, near);
  group.normal_deviation = std::max(group.normal_deviation, found.normal);
  // Of texture coordinates as large as floats it may be beyond them, where the format says that nothing was measured.
  constexpr double kMost = 0.999 * double{format::kInfiniteError};
  group.uv_deviation = std::max(group.uv_deviation, std::min(found.uv, kMost));
}

}  // namespace meshlode::builder
