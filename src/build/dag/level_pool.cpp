// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/dag/level_pool.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace meshlode::build {

namespace {

constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;

std::uint64_t mix(std::uint64_t h, std::uint32_t value) {
  h = (h ^ value) * 0x9E3779B97F4A7C15ULL;
  return h ^ h >> 29U;
}

/// Finds the id that `is_same` accepts, or inserts `next`. `hash_of` gives the hash of an id that is already in.
template <class Table, class IsSame, class HashOf>
std::uint32_t find_or_insert(Table& table, std::uint64_t hash, std::uint32_t next, const IsSame& is_same,
                             const HashOf& hash_of) {
  if (2 * (table.used + 1) > table.slots.size()) {
    const std::vector<std::uint32_t> old = std::move(table.slots);
    table.slots.assign(std::max<std::size_t>(64, 4 * old.size()), kEmpty);
    for (const std::uint32_t id : old) {
      if (id == kEmpty) continue;
      std::size_t slot = hash_of(id) & (table.slots.size() - 1);
      while (table.slots[slot] != kEmpty) slot = (slot + 1) & (table.slots.size() - 1);
      table.slots[slot] = id;
    }
  }
  std::size_t slot = hash & (table.slots.size() - 1);
  while (table.slots[slot] != kEmpty) {
    if (is_same(table.slots[slot])) return table.slots[slot];
    slot = (slot + 1) & (table.slots.size() - 1);
  }
  table.slots[slot] = next;
  ++table.used;
  return next;
}

}  // namespace

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
  return mix(mix(mix(1, static_cast<std::uint32_t>(p.x)), static_cast<std::uint32_t>(p.y)), static_cast<std::uint32_t>(p.z));
}

std::uint64_t BuildPool::hash_wedge(std::uint32_t position, const float* attributes) const {
  std::uint64_t h = mix(2, position);
  for (std::size_t j = 0; j < stride_; ++j) h = mix(h, std::bit_cast<std::uint32_t>(attributes[j]));
  return h;
}

std::uint32_t BuildPool::position_id(const Vec3i& position) {
  const auto next = static_cast<std::uint32_t>(positions.size());
  positions.push_back(position);
  const std::uint32_t id = find_or_insert(
      position_table_, hash_position(next), next, [&](std::uint32_t other) { return positions[other] == position; },
      [&](std::uint32_t other) { return hash_position(other); });
  if (id != next) positions.pop_back();
  return id;
}

std::uint32_t BuildPool::wedge_id(std::uint32_t position, const float* attributes) {
  const auto next = static_cast<std::uint32_t>(wedge_position.size());
  const auto is_same = [&](std::uint32_t other) {
    // Bits, not values: what differs in the sign of a zero is another wedge, as everywhere in the build.
    return wedge_position[other] == position &&
           (stride_ == 0 || std::memcmp(wedge_attributes.data() + other * stride_, attributes, stride_ * sizeof(float)) == 0);
  };
  const std::uint32_t id = find_or_insert(wedge_table_, hash_wedge(position, attributes), next, is_same, [&](std::uint32_t other) {
    return hash_wedge(wedge_position[other], wedge_attributes.data() + other * stride_);
  });
  if (id == next) {
    wedge_position.push_back(position);
    wedge_attributes.insert(wedge_attributes.end(), attributes, attributes + stride_);
  }
  return id;
}

void BuildPool::add_clusters(const std::vector<WedgeTriangle>& source, const std::vector<std::uint32_t>& materials,
                             const CarriedTruth& carried, const Clustering& clustering, std::uint32_t level, std::uint32_t own_group) {
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
                               std::uint32_t level, std::uint32_t own_group) {
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

}  // namespace meshlode::build
