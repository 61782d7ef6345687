// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/measure/read_dag.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "base/try.h"
#include "run/decode/decode.h"
#include "run/unpack/unpack.h"

namespace meshlode::app {

namespace {

using builder::AttributeLayout;
using builder::DagCluster;
using builder::DagGroup;
using builder::LodDag;

DagGroup group_of(const format::GroupRecord& record, const format::MeshRecord& mesh) {
  DagGroup group;
  group.level = record.level;
  group.first_cluster = record.first_cluster - mesh.first_cluster;
  group.cluster_count = record.cluster_count;
  group.is_terminal = (record.flags & format::kGroupTerminal) != 0;
  group.is_aggregate = (record.flags & format::kGroupAggregate) != 0;
  group.quadric_error = group.is_terminal ? std::numeric_limits<double>::infinity() : double{record.quadric_error};
  group.error = group.quadric_error;
  return group;
}

DagCluster cluster_of(const format::ClusterRecord& record, const format::MeshRecord& mesh) {
  DagCluster cluster;
  cluster.level = record.level;
  if (record.own_group != format::kNone) cluster.own_group = GroupId(record.own_group - mesh.first_group);
  cluster.coarser_group = GroupId(record.coarser_group - mesh.first_group);
  return cluster;
}

void append_vertices(const run::DecodedCluster& decoded, const run::ClusterAttributes& attributes, LodDag& dag) {
  const auto append = [&](const auto& vector, int count) {
    for (int k = 0; k < count; ++k) dag.vertex_attributes.push_back(vector[k]);
  };
  for (std::uint32_t v = 0; v < decoded.vertex_count; ++v) {
    dag.vertex_position.push_back(decoded.position(v));
    if (!attributes.normals.empty()) append(attributes.normals[v], 3);
    for (const std::vector<Vec2f>& uvs : attributes.uvs) {
      if (!uvs.empty()) append(uvs[v], 2);
    }
    if (!attributes.colors.empty()) append(attributes.colors[v], 4);
  }
}

/// Clusters are in the order of pages.
Status read_pages(const run::Asset& asset, MeshId mesh, LodDag& dag) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  run::DecodedCluster decoded;
  run::ClusterAttributes attributes;
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const format::PageRecord& stored = asset.pages()[p];
    if (asset.groups()[stored.first_group].mesh != mesh.value) continue;
    TRY_LET(page, run::load_page(asset, PageId{p}));
    for (std::uint32_t id = stored.first_cluster; id < stored.first_cluster + stored.cluster_count; ++id) {
      run::decode_cluster(asset, *page, ClusterId(id), decoded);
      run::decode_attributes(record, decoded, attributes);
      DagCluster& cluster = dag.clusters[id - record.first_cluster];
      cluster.first_vertex = static_cast<std::uint32_t>(dag.vertex_position.size());
      cluster.first_triangle = static_cast<std::uint32_t>(dag.triangles.size());
      cluster.vertex_count = decoded.vertex_count;
      cluster.triangle_count = decoded.triangle_count;
      append_vertices(decoded, attributes, dag);
      dag.triangles.insert(dag.triangles.end(), decoded.triangles.begin(), decoded.triangles.end());
      if (record.material != format::kNone) continue;
      dag.triangle_material.insert(dag.triangle_material.end(), decoded.triangle_material.begin(),
                                   decoded.triangle_material.end());
    }
  }
  return Ok{};
}

}  // namespace

Result<AttributeLayout> layout_of(const format::MeshRecord& mesh) {
  AttributeLayout layout;
  layout.has_normal = mesh.normal_mode == format::NormalMode::kStored;
  layout.flat_normal = mesh.normal_mode == format::NormalMode::kFlat;
  layout.uv_set_count = mesh.uv_set_count;
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    if (mesh.uv_set_source[set] >= scene::kMaxUvSets) {
      return Error{ErrorCode::kInvalid, "field uv_set_source", "names a set that no scene has"};
    }
    layout.uv_set_source[set] = mesh.uv_set_source[set];
  }
  layout.has_color = mesh.has_color != 0;
  return layout;
}

Result<LodDag> read_dag(const run::Asset& asset, MeshId mesh, const AttributeLayout& layout) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  LodDag dag;
  dag.level_count = record.level_count;
  std::size_t vertices = 0, triangles = 0;
  for (const format::ClusterRecord& cluster : asset.clusters().subspan(record.first_cluster, record.cluster_count)) {
    dag.clusters.push_back(cluster_of(cluster, record));
    vertices += cluster.vertex_count();
    triangles += cluster.triangle_count();
  }
  for (const format::GroupRecord& group : asset.groups().subspan(record.first_group, record.group_count)) {
    dag.groups.push_back(group_of(group, record));
  }
  std::vector<std::uint8_t> is_replaced(dag.groups.size(), 0);
  for (const DagCluster& cluster : dag.clusters) {
    if (cluster.own_group.is_valid()) is_replaced[cluster.own_group.value] = 1;
  }
  for (std::size_t g = 0; g < dag.groups.size(); ++g) {
    if (dag.groups[g].is_terminal || is_replaced[g] != 0) continue;
    return Error{ErrorCode::kInvalid, "group " + std::to_string(record.first_group + g), "nothing is made of it"};
  }
  dag.vertex_position.reserve(vertices);
  dag.vertex_attributes.reserve(vertices * layout.stride());
  dag.triangles.reserve(triangles);
  if (record.material == format::kNone) dag.triangle_material.reserve(triangles);
  TRY(read_pages(asset, mesh, dag));
  return dag;
}

}  // namespace meshlode::app
