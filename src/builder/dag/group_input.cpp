// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/group_input.h"

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
  for (const ClusterId c : clusters) {
    const BuildCluster& cluster = pool.cluster(c);
    const auto first = static_cast<std::ptrdiff_t>(cluster.first_triangle);
    const auto last = first + static_cast<std::ptrdiff_t>(cluster.triangle_count);
    input.triangles.insert(input.triangles.end(), pool.triangles.begin() + first, pool.triangles.begin() + last);
    for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count;
         ++t) {
      input.triangle_material.push_back(pool.triangle_material[t]);
    }
  }
  LocalIds wedges(input.triangles.size());
  for (WedgeTriangle& triangle : input.triangles) {
    for (std::uint32_t& wedge : triangle) wedge = wedges.add(wedge);
  }
  const std::vector<std::uint32_t> wedge_place = wedges.sort();
  for (WedgeTriangle& triangle : input.triangles) {
    for (std::uint32_t& wedge : triangle) wedge = wedge_place[wedge];
  }
  LocalIds positions(wedges.size());
  input.wedge_position.reserve(wedges.size());
  input.is_wedge_shared.reserve(wedges.size());
  input.wedge_attributes.reserve(stride * wedges.size());
  for (const std::uint32_t w : wedges.numbers()) {
    input.wedge_position.push_back(positions.add(pool.wedge_position[w]));
    input.is_wedge_shared.push_back(shared.wedge(w));
    const auto first = pool.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(w * stride);
    input.wedge_attributes.insert(input.wedge_attributes.end(), first, first + static_cast<std::ptrdiff_t>(stride));
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
