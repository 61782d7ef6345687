// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/group_attributes.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <meshlode/format.h>

#include "builder/deviation/source_tree.h"
#include "builder/measure/cluster_surface.h"

namespace meshlode::builder {

GroupAttributes::GroupAttributes(const SourceTree& source, const PreparedMesh& mesh, const CanonicalForm& form,
                                 LodDag& dag)
    : source_(source), mesh_(mesh), form_(form), dag_(dag) {
  if (mesh.layout.uv_set_count == 0) return;
  charts_.emplace(mesh, form, dag);
  carried_.resize(dag.clusters.size());
  first_.assign(dag.clusters.size() + 1, 0);
  for (const CanonicalForm::Level0Triangle& triangle : form.level0_of_source) ++first_[triangle.cluster + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  triangles_.resize(form.level0_of_source.size());
  const SurfaceTree& tree = source.impl().tree;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {  // neighbours one after the other
    const std::uint32_t t = tree.triangle_at(TreeSlot(i));
    triangles_[next[form.level0_of_source[t].cluster]++] = t;
  }
}

/// What its members stand for, chart by chart.
std::vector<SurfacePart> GroupAttributes::take_parts(const DagGroup& group) {
  std::vector<SurfacePart> parts;
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    for (std::uint32_t i = first_[c]; i < first_[c + 1]; ++i) {
      parts.push_back({triangles_[i], kNoId, area_of(source_.impl().corners(triangles_[i]))});
    }
    const std::vector<SurfacePart> own = std::exchange(carried_[c], {});
    parts.insert(parts.end(), own.begin(), own.end());
  }
  const auto chart_of = [&](const SurfacePart& part) {
    return charts_->of_vertex()[form_.vertices_of_source[part.triangle][0]];
  };
  std::stable_sort(parts.begin(), parts.end(),
                   [&](const SurfacePart& a, const SurfacePart& b) { return chart_of(a) < chart_of(b); });
  return parts;
}

void GroupAttributes::measure(DagGroup& group, std::span<const std::uint32_t> made, std::span<const TreeSlot> near) {
  group.normal_deviation = group.uv_deviation = 0.0;
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    const GroupId own = dag_.clusters[c].own_group;
    if (!own.is_valid()) continue;
    group.normal_deviation = std::max(group.normal_deviation, dag_.groups[own.value].normal_deviation);
    group.uv_deviation = std::max(group.uv_deviation, dag_.groups[own.value].uv_deviation);
  }
  ClusterSurface surface;
  std::vector<WedgeTriangle> vertices;  // of the DAG
  std::vector<std::uint32_t> cluster_of;
  for (const std::uint32_t c : made) {
    const DagCluster& cluster = dag_.clusters[c];
    surface.add(dag_, mesh_.grid, cluster);
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      const auto& l = dag_.triangles[t];
      vertices.push_back({cluster.first_vertex + l[0], cluster.first_vertex + l[1], cluster.first_vertex + l[2]});
      cluster_of.push_back(c);
    }
  }
  if (charts_) charts_->label(group, made);
  const SurfaceAttributes of_source{dag_.vertex_attributes, form_.vertices_of_source, chart_of_vertex()};
  const SurfaceAttributes of_group{dag_.vertex_attributes, vertices, chart_of_vertex()};
  const GroupSurface drawn{surface.positions, surface.triangles};
  // Of texture coordinates as large as floats it may be beyond them, where the format says that nothing was measured.
  constexpr double kMost = 0.999 * double{format::kInfiniteError};
  if (charts_ && !vertices.empty()) {
    const SourceDeviation back =
        measure_uvs_from_source(source_, of_source, take_parts(group), drawn, of_group, mesh_.layout);
    group.uv_deviation = std::max(group.uv_deviation, std::min(back.uv, kMost));
    for (std::size_t i = 0; i < back.points.size(); ++i) {
      if (back.near[i] != kNoId) carried_[cluster_of[back.near[i]]].push_back(back.points[i]);
    }
  }
  const AttributeDeviation found = measure_attributes(source_, of_source, drawn, of_group, mesh_.layout, near);
  group.normal_deviation = std::max(group.normal_deviation, found.normal);
  group.uv_deviation = std::max(group.uv_deviation, std::min(found.uv, kMost));
}

}  // namespace meshlode::builder
