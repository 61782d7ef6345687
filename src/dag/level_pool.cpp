// SPDX-License-Identifier: GPL-3.0-or-later
#include "dag/level_pool.h"

#include <algorithm>

namespace meshlode {

namespace {

constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;

std::uint64_t mix(const Vec3i& p) {
  std::uint64_t h = static_cast<std::uint32_t>(p.x);
  h = h * 0x9E3779B97F4A7C15ULL + static_cast<std::uint32_t>(p.y);
  h = (h ^ h >> 29U) * 0xBF58476D1CE4E5B9ULL + static_cast<std::uint32_t>(p.z);
  h = (h ^ h >> 32U) * 0x94D049BB133111EBULL;
  return h ^ h >> 29U;
}

}  // namespace

BuildPool::BuildPool(const PreparedMesh& mesh)
    : positions(mesh.positions),
      wedge_position(mesh.wedge_position),
      wedge_attributes(mesh.wedge_attributes),
      stride_(mesh.layout.stride()) {
  grow_table();
}

void BuildPool::grow_table() {
  std::size_t size = 64;
  while (size < 4 * positions.size()) size *= 2;
  table_.assign(size, kEmpty);
  for (std::uint32_t id = 0; id < positions.size(); ++id) {
    std::size_t slot = mix(positions[id]) & (size - 1);
    while (table_[slot] != kEmpty) slot = (slot + 1) & (size - 1);
    table_[slot] = id;
  }
}

std::uint32_t BuildPool::position_id(const Vec3i& position) {
  if (2 * positions.size() > table_.size()) grow_table();
  std::size_t slot = mix(position) & (table_.size() - 1);
  while (table_[slot] != kEmpty) {
    if (positions[table_[slot]] == position) return table_[slot];
    slot = (slot + 1) & (table_.size() - 1);
  }
  table_[slot] = static_cast<std::uint32_t>(positions.size());
  positions.push_back(position);
  return table_[slot];
}

void BuildPool::add_clusters(const std::vector<WedgeTriangle>& source, const std::vector<std::uint32_t>& materials,
                             const Clustering& clustering, std::uint32_t level, std::uint32_t own_group) {
  std::vector<std::uint32_t> start(clustering.count + 1, 0);
  for (const std::uint32_t label : clustering.label) ++start[label + 1];
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  const auto base = static_cast<std::uint32_t>(triangles.size());
  for (std::uint32_t c = 0; c < clustering.count; ++c) {
    clusters.push_back({level, own_group, base + start[c], start[c + 1] - start[c]});
  }
  triangles.resize(base + source.size());
  triangle_material.resize(base + source.size());
  for (std::size_t t = 0; t < source.size(); ++t) {
    const std::uint32_t slot = base + start[clustering.label[t]]++;
    triangles[slot] = source[t];
    triangle_material[slot] = materials[t];
  }
}

void BuildPool::add_simplified(const SimplifyResult& result, const Clustering& clustering, std::uint32_t level,
                               std::uint32_t own_group) {
  std::vector<std::uint32_t> ids(result.positions.size());
  for (std::size_t p = 0; p < ids.size(); ++p) ids[p] = position_id(result.positions[p]);
  const auto first_wedge = static_cast<std::uint32_t>(wedge_position.size());
  for (const std::uint32_t p : result.wedge_position) wedge_position.push_back(ids[p]);
  wedge_attributes.insert(wedge_attributes.end(), result.wedge_attributes.begin(), result.wedge_attributes.end());
  std::vector<WedgeTriangle> shifted = result.triangles;
  for (WedgeTriangle& triangle : shifted) {
    for (std::uint32_t& wedge : triangle) wedge += first_wedge;
  }
  add_clusters(shifted, result.triangle_material, clustering, level, own_group);
}

void BuildPool::positions_of(std::uint32_t cluster, std::vector<std::uint32_t>& out) const {
  out.clear();
  const BuildCluster& c = clusters[cluster];
  for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
    for (const std::uint32_t wedge : triangles[t]) out.push_back(wedge_position[wedge]);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

std::uint32_t BuildPool::count_wedges(std::uint32_t cluster) const {
  const BuildCluster& c = clusters[cluster];
  std::vector<std::uint32_t> wedges;
  for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
    wedges.insert(wedges.end(), triangles[t].begin(), triangles[t].end());
  }
  std::sort(wedges.begin(), wedges.end());
  return static_cast<std::uint32_t>(std::unique(wedges.begin(), wedges.end()) - wedges.begin());
}

std::uint32_t BuildPool::count_materials(std::uint32_t cluster) const {
  const BuildCluster& c = clusters[cluster];
  const auto first = triangle_material.begin() + c.first_triangle;
  std::vector<std::uint32_t> materials(first, first + c.triangle_count);
  std::sort(materials.begin(), materials.end());
  return static_cast<std::uint32_t>(std::unique(materials.begin(), materials.end()) - materials.begin());
}

}  // namespace meshlode
