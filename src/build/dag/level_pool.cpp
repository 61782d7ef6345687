// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/dag/level_pool.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace meshlode::build {

BuildPool::BuildPool(const PreparedMesh& mesh) : stride_(mesh.layout.stride()) {
  for (const Vec3i& position : mesh.positions) {
    (void)position_id(position);
    witnesses.push_back({{position}, 1});
  }
  for (std::size_t w = 0; w < mesh.wedge_position.size(); ++w) {
    (void)wedge_id(mesh.wedge_position[w], mesh.wedge_attributes.data() + w * stride_);
  }
}

std::uint64_t BuildPool::hash_position(std::uint32_t id) const {
  const Vec3i& p = positions[id];
  std::uint64_t h = 0;
  for (int k = 0; k < 3; ++k) h = hash_word(h, static_cast<std::uint32_t>(p[k]));
  return h;
}

std::uint64_t BuildPool::hash_wedge(std::uint32_t position, const float* attributes) const {
  std::uint64_t h = hash_word(0, position);
  for (std::size_t j = 0; j < stride_; ++j) h = hash_word(h, std::bit_cast<std::uint32_t>(attributes[j]));
  return h;
}

std::uint32_t BuildPool::position_id(const Vec3i& position) {
  const auto next = static_cast<std::uint32_t>(positions.size());
  positions.push_back(position);
  const IdTable::Entry entry = position_table_.find_or_insert(
      hash_position(next), next, [&](std::uint32_t other) { return positions[other] == position; },
      [&](std::uint32_t other) { return hash_position(other); });
  if (!entry.is_new) positions.pop_back();
  return entry.id;
}

std::uint32_t BuildPool::wedge_id(std::uint32_t position, const float* attributes) {
  const auto next = static_cast<std::uint32_t>(wedge_position.size());
  const auto is_same = [&](std::uint32_t other) {
    // Bits, not values: what differs in the sign of a zero is another wedge, as everywhere in the build.
    return wedge_position[other] == position && (stride_ == 0 || std::memcmp(wedge_attributes.data() + other * stride_,
                                                                             attributes, stride_ * sizeof(float)) == 0);
  };
  const IdTable::Entry entry =
      wedge_table_.find_or_insert(hash_wedge(position, attributes), next, is_same, [&](std::uint32_t other) {
        return hash_wedge(wedge_position[other], wedge_attributes.data() + other * stride_);
      });
  if (entry.is_new) {
    wedge_position.push_back(position);
    wedge_attributes.insert(wedge_attributes.end(), attributes, attributes + stride_);
  }
  return entry.id;
}

void BuildPool::add_clusters(const std::vector<WedgeTriangle>& source, const std::vector<std::uint32_t>& materials,
                             const CarriedTruth& carried, const Clustering& clustering, std::uint32_t level,
                             GroupId own_group) {
  const auto first_cluster = clusters.size();
  std::vector<std::uint32_t> start(clustering.count + 1, 0);
  for (const std::uint32_t label : clustering.label) ++start[label + 1];
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  const auto base = static_cast<std::uint32_t>(triangles.size());
  for (std::uint32_t c = 0; c < clustering.count; ++c) {
    clusters.push_back({level, own_group, base + start[c], start[c + 1] - start[c], {}});
  }
  for (const CarriedSample& sample : carried.samples) {
    clusters[first_cluster + clustering.label[sample.triangle]].samples.push_back(sample);
  }
  triangles.resize(base + source.size());
  triangle_material.resize(base + source.size());
  if (!carried.bounds.empty()) triangle_bounds.resize(base + source.size());
  for (std::size_t t = 0; t < source.size(); ++t) {
    const std::uint32_t slot = base + start[clustering.label[t]]++;
    triangles[slot] = source[t];
    triangle_material[slot] = materials[t];
    if (!carried.bounds.empty()) triangle_bounds[slot] = carried.bounds[t];
  }
}

void BuildPool::add_simplified(const SimplifyResult& result, const CarriedTruth& carried, const Clustering& clustering,
                               std::uint32_t level, GroupId own_group) {
  std::vector<std::uint32_t> ids(result.positions.size());
  for (std::size_t p = 0; p < ids.size(); ++p) {
    ids[p] = position_id(result.positions[p]);
    if (ids[p] == witnesses.size()) witnesses.emplace_back();
    // A locked position keeps what it had and takes over what this group left at it, as far as there is room.
    Witnesses& known = witnesses[ids[p]];
    for (std::uint32_t i = 0; i < result.witnesses[p].count; ++i) {
      const Vec3i& point = result.witnesses[p].points[i];
      const auto end = known.points.begin() + known.count;
      if (known.count < Witnesses::kCapacity && std::find(known.points.begin(), end, point) == end) {
        known.points[known.count++] = point;
      }
    }
  }
  std::vector<std::uint32_t> wedges(result.wedge_position.size());
  for (std::size_t w = 0; w < wedges.size(); ++w) {
    wedges[w] = wedge_id(ids[result.wedge_position[w]], result.wedge_attributes.data() + w * stride_);
  }
  std::vector<WedgeTriangle> renumbered = result.triangles;
  for (WedgeTriangle& triangle : renumbered) {
    for (std::uint32_t& wedge : triangle) wedge = wedges[wedge];
  }
  add_clusters(renumbered, result.triangle_material, carried, clustering, level, own_group);
}

void BuildPool::positions_of(ClusterId cluster, std::vector<std::uint32_t>& out) const {
  out.clear();
  const BuildCluster& c = this->cluster(cluster);
  for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
    for (const std::uint32_t wedge : triangles[t]) out.push_back(wedge_position[wedge]);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

std::uint32_t BuildPool::count_wedges(ClusterId cluster) const {
  const BuildCluster& c = this->cluster(cluster);
  std::vector<std::uint32_t> wedges;
  for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
    wedges.insert(wedges.end(), triangles[t].begin(), triangles[t].end());
  }
  std::sort(wedges.begin(), wedges.end());
  return static_cast<std::uint32_t>(std::unique(wedges.begin(), wedges.end()) - wedges.begin());
}

std::uint32_t BuildPool::count_materials(ClusterId cluster) const {
  const BuildCluster& c = this->cluster(cluster);
  const auto first = triangle_material.begin() + c.first_triangle;
  std::vector<std::uint32_t> materials(first, first + c.triangle_count);
  std::sort(materials.begin(), materials.end());
  return static_cast<std::uint32_t>(std::unique(materials.begin(), materials.end()) - materials.begin());
}

}  // namespace meshlode::build
