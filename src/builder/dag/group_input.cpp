// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/group_input.h"

#include <vector>

#include "base/local_ids.h"

namespace meshlode::builder {

SimplifyInput group_input(const BuildPool& pool, const PreparedMesh& mesh, const std::vector<ClusterId>& clusters,
                          const Shared& shared) {
  SimplifyInput input;
  input.grid = mesh.grid;
  input.layout = mesh.layout;
  const std::size_t stride = mesh.layout.stride();
  std::size_t triangle_count = 0;
  for (const ClusterId c : clusters) triangle_count += pool.cluster(c).triangle_count;
  input.triangles.reserve(triangle_count);
  input.triangle_material.reserve(triangle_count);
  LocalIds wedges(triangle_count);
  std::vector<std::uint32_t> met;  // of the vertices of all clusters, by local id
  for (const ClusterId c : clusters) {
    for (const std::uint32_t wedge : pool.vertices_of(pool.cluster(c))) met.push_back(wedges.add(wedge));
  }
  const std::vector<std::uint32_t> wedge_place = wedges.sort();
  for (std::uint32_t& wedge : met) wedge = wedge_place[wedge];
  const std::uint32_t* own = met.data();
  for (const ClusterId c : clusters) {
    const BuildCluster& cluster = pool.cluster(c);
    for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count;
         ++t) {
      const auto [i, j, k] = pool.triangles[t];
      input.triangles.push_back({own[i], own[j], own[k]});
      input.triangle_material.push_back(pool.triangle_material[t]);
    }
    own += cluster.vertex_count;
  }
  LocalIds positions(wedges.size());
  input.wedge_position.reserve(wedges.size());
  input.is_wedge_shared.reserve(wedges.size());
  input.wedge_attributes.resize(stride * wedges.size());
  float* attributes = input.wedge_attributes.data();
  for (const std::uint32_t w : wedges.numbers()) {
    input.wedge_position.push_back(positions.add(pool.wedge_position[w]));
    input.is_wedge_shared.push_back(shared.wedge(w));
    for (std::size_t j = 0; j < stride; ++j) *attributes++ = pool.wedge_attributes[w * stride + j];
  }
  const std::vector<std::uint32_t> position_place = positions.sort();
  for (std::uint32_t& position : input.wedge_position) position = position_place[position];
  input.positions.reserve(positions.size());
  input.is_locked.reserve(positions.size());
  input.witnesses.reserve(positions.size());
  for (const std::uint32_t p : positions.numbers()) {
    input.positions.push_back(pool.positions[p]);
    input.is_locked.push_back(shared.position(p));
    if (!mesh.is_border_locked.empty()) {
      input.is_border_locked.push_back(p < mesh.is_border_locked.size() ? mesh.is_border_locked[p] : 0);
    }
    input.witnesses.push_back(pool.witnesses_at(p));
  }
  return input;
}

}  // namespace meshlode::builder
