// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/level_pool.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "base/local_ids.h"
#include "base/parallel.h"
#include "base/release.h"
#include "builder/gap_label.h"

namespace meshlode::builder {

namespace {

/// Takes a mesh's array and gives it room for more. Room that is never written to takes no memory.
template <class T>
void take_level0(std::vector<T>& level0, std::size_t more, std::vector<T>& taken) {
  taken = std::exchange(level0, {});
  taken.reserve(taken.size() + more);
}

/// Side by side, in tasks of many.
constexpr auto kForEachId = [](std::uint32_t count, const auto& visit) {
  parallel_for_each_index(count, kLoopGrain, [&](std::size_t id) { visit(static_cast<std::uint32_t>(id)); });
};

/// What is looked up is fetched so many turns before.
constexpr std::size_t kAhead = 12;

constexpr WitnessIds kNoWitnesses{kNoId, kNoId, kNoId};

WitnessIds ids_of(const Witnesses& witnesses) {
  WitnessIds ids = kNoWitnesses;
  std::copy_n(witnesses.ids.begin(), witnesses.count, ids.begin());
  return ids;
}

/// As far as there is room.
void add_distinct(WitnessIds& known, const WitnessIds& more) {
  for (const std::uint32_t id : more) {
    const auto same_or_free =
        std::find_if(known.begin(), known.end(), [&](std::uint32_t other) { return other == id || other == kNoId; });
    if (same_or_free != known.end()) *same_or_free = id;
  }
}

}  // namespace

CoarserLevels halved_levels(const PreparedMesh& mesh) {
  const auto coarser = [](std::size_t level0) { return level0 + level0 / 8; };
  return {coarser(mesh.positions.size()), coarser(mesh.wedge_position.size()), coarser(mesh.triangles.size())};
}

BuildPool::BuildPool(PreparedMesh& mesh, const CoarserLevels& coarser)
    : stride_(mesh.layout.stride()), has_witnesses_(coarser.has_witnesses) {
  triangles.reserve(mesh.triangles.size() + coarser.triangles);
  vertices.reserve(triangles.capacity());
  triangle_material.expect(triangles.capacity());
  const auto take_positions = [&] {
    take_level0(mesh.positions, coarser.positions, positions);
    const auto hash_of = [&](std::uint32_t id) { return hash_point(positions[id]); };
    position_table_.fill(static_cast<std::uint32_t>(positions.size()), coarser.positions, kForEachId, hash_of);
    if (!has_witnesses_) return;
    witnesses.reserve(positions.capacity());
    for (std::uint32_t p = 0; p < positions.size(); ++p) witnesses.push_back({p, kNoId, kNoId});
  };
  const auto take_wedges = [&] {
    take_level0(mesh.wedge_position, coarser.wedges, wedge_position);
    take_level0(mesh.wedge_attributes, coarser.wedges * stride_, wedge_attributes);
    wedge_table_.fill(
        static_cast<std::uint32_t>(wedge_position.size()), coarser.wedges, kForEachId,
        [&](std::uint32_t id) { return hash_wedge(wedge_position[id], wedge_attributes.data() + id * stride_); });
  };
  parallel_all(take_positions, take_wedges);
}

std::uint64_t BuildPool::hash_wedge(std::uint32_t position, const float* attributes) const {
  std::uint64_t h = hash_word(0, position);
  for (std::size_t j = 0; j < stride_; ++j) h = hash_word(h, std::bit_cast<std::uint32_t>(attributes[j]));
  return h;
}

bool BuildPool::is_wedge(std::uint32_t wedge, std::uint32_t position, const float* attributes) const {
  // Bits, not values: what differs in the sign of a zero is another wedge, as everywhere in the build.
  return wedge_position[wedge] == position && (stride_ == 0 || std::memcmp(wedge_attributes.data() + wedge * stride_,
                                                                           attributes, stride_ * sizeof(float)) == 0);
}

std::uint32_t BuildPool::position_id(const Vec3i& position) {
  const auto next = static_cast<std::uint32_t>(positions.size());
  const IdTable::Entry entry = position_table_.find_or_insert(
      hash_point(position), next, [&](std::uint32_t other) { return positions[other] == position; },
      [&](std::uint32_t other) { return hash_point(positions[other]); });
  if (entry.is_new) {
    positions.push_back(position);
    if (has_witnesses_) witnesses.push_back(kNoWitnesses);
  }
  return entry.id;
}

std::uint32_t BuildPool::find_position(const Vec3i& position) const {
  return position_table_.find(hash_point(position), [&](std::uint32_t other) { return positions[other] == position; });
}

bool BuildPool::had_place(const Vec3i& position) const {
  return find_position(position) < round_positions_;  // kNoId is greater
}

std::uint32_t BuildPool::wedge_id(std::uint32_t position, const float* attributes) {
  const auto next = static_cast<std::uint32_t>(wedge_position.size());
  const IdTable::Entry entry = wedge_table_.find_or_insert(
      hash_wedge(position, attributes), next,
      [&](std::uint32_t other) { return is_wedge(other, position, attributes); },
      [&](std::uint32_t other) {
        return hash_wedge(wedge_position[other], wedge_attributes.data() + other * stride_);
      });
  if (entry.is_new) {
    wedge_position.push_back(position);
    wedge_attributes.insert(wedge_attributes.end(), attributes, attributes + stride_);
  }
  return entry.id;
}

ClusterId BuildPool::add_clusters(const Clustering& clustering, std::uint32_t level, GroupId own_group) {
  const ClusterId first(clusters.size());
  clusters.resize(clusters.size() + clustering.count, {level, own_group});
  for (const std::uint32_t label : clustering.label) ++clusters[first.value + label].triangle_count;
  auto next = static_cast<std::uint32_t>(triangles.size());
  for (std::size_t c = first.value; c < clusters.size(); ++c) {
    clusters[c].first_triangle = next;
    next += clusters[c].triangle_count;
  }
  triangles.resize(next);
  return first;
}

std::vector<std::vector<std::uint32_t>> BuildPool::fill_clusters(std::span<const WedgeTriangle> source,
                                                                 std::span<const std::uint32_t> wedges,
                                                                 std::span<const std::uint32_t> materials,
                                                                 const Clustering& clustering, ClusterId first) {
  constexpr std::size_t kClusters = 64;  // a task
  const std::span<BuildCluster> filled = std::span(clusters).subspan(first.value, clustering.count);
  std::vector<std::uint32_t> members(source.size()), next(clustering.count);
  const std::uint32_t base = filled.empty() ? 0 : filled.front().first_triangle;
  for (std::size_t c = 0; c < filled.size(); ++c) next[c] = filled[c].first_triangle - base;
  for (std::uint32_t t = 0; t < source.size(); ++t) members[next[clustering.label[t]]++] = t;
  std::vector<std::vector<std::uint32_t>> parts(chunk_count(filled.size(), kClusters));
  parallel_for_each_chunk(filled.size(), kClusters, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    LocalIds local(256);
    std::vector<std::uint32_t>& part = parts[chunk];
    for (BuildCluster& cluster : filled.subspan(begin, end - begin)) {
      local.clear();
      for (std::uint32_t at = cluster.first_triangle; at < cluster.first_triangle + cluster.triangle_count; ++at) {
        const std::uint32_t t = members[at - base];
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t wedge = wedges.empty() ? source[t][k] : wedges[source[t][k]];
          triangles[at][k] = static_cast<std::uint8_t>(local.add(wedge));
        }
        triangle_material.set(at, materials[t]);
      }
      cluster.vertex_count = static_cast<std::uint32_t>(local.size());
      part.insert(part.end(), local.numbers().begin(), local.numbers().end());
    }
  });
  return parts;
}

void BuildPool::add_vertices(const std::vector<std::vector<std::uint32_t>>& parts, ClusterId first,
                             std::uint32_t count) {
  auto next = static_cast<std::uint32_t>(vertices.size());
  for (BuildCluster& cluster : std::span(clusters).subspan(first.value, count)) {
    cluster.first_vertex = next;
    next += cluster.vertex_count;
  }
  for (const std::vector<std::uint32_t>& part : parts) vertices.insert(vertices.end(), part.begin(), part.end());
}

void BuildPool::add_level0(const std::vector<WedgeTriangle>& source, const std::vector<std::uint32_t>& materials,
                           const Clustering& clustering) {
  const ClusterId first = add_clusters(clustering, 0, GroupId());
  triangle_material.add(materials);
  add_vertices(fill_clusters(source, {}, materials, clustering, first), first, clustering.count);
}

BuildPool::Ids BuildPool::find_known(const SimplifyResult& result) const {
  Ids ids;
  ids.positions.resize(result.positions.size());
  for (std::size_t p = 0; p < ids.positions.size(); ++p) {
    if (p + kAhead < ids.positions.size()) position_table_.prefetch(hash_point(result.positions[p + kAhead]));
    ids.positions[p] = find_position(result.positions[p]);
  }
  ids.wedges.resize(result.wedge_position.size());
  for (std::size_t w = 0; w < ids.wedges.size(); ++w) {
    if (w + kAhead < ids.wedges.size()) prefetch_wedge(result, ids, w + kAhead);
    const std::uint32_t position = ids.positions[result.wedge_position[w]];
    const float* const attributes = result.wedge_attributes.data() + w * stride_;
    ids.wedges[w] =
        position == kNoId ? kNoId : wedge_table_.find(hash_wedge(position, attributes), [&](std::uint32_t other) {
          return is_wedge(other, position, attributes);
        });
  }
  return ids;
}

/// A locked position keeps what it had and takes over what a group left at it, as far as there is room.
void BuildPool::add_witnesses(std::uint32_t position, const WitnessIds& more) {
  WitnessIds known = witnesses[position];
  add_distinct(known, more);
  if (known == witnesses[position]) return;
  if (position < round_positions_) {
    late_witnesses_.emplace_back(position, more);
  } else {
    witnesses[position] = known;
  }
}

Witnesses BuildPool::witnesses_at(std::uint32_t position) const {
  Witnesses out;
  for (const std::uint32_t id : witnesses[position]) {
    if (id == kNoId) break;
    out.points[out.count] = positions[id];
    out.ids[out.count++] = id;
  }
  return out;
}

void BuildPool::prefetch_wedge(const SimplifyResult& result, const Ids& ids, std::size_t wedge) const {
  const std::uint32_t position = ids.positions[result.wedge_position[wedge]];
  if (position != kNoId) wedge_table_.prefetch(hash_wedge(position, result.wedge_attributes.data() + wedge * stride_));
}

void BuildPool::insert_new(const SimplifyResult& result, Ids& ids) {
  for (std::size_t p = 0; p < ids.positions.size(); ++p) {
    if (p + kAhead < ids.positions.size() && ids.positions[p + kAhead] == kNoId)
      position_table_.prefetch(hash_point(result.positions[p + kAhead]));
    if (ids.positions[p] == kNoId) ids.positions[p] = position_id(result.positions[p]);
    if (has_witnesses_) add_witnesses(ids.positions[p], ids_of(result.witnesses[p]));
  }
  for (std::size_t w = 0; w < ids.wedges.size(); ++w) {
    if (w + kAhead < ids.wedges.size() && ids.wedges[w + kAhead] == kNoId) prefetch_wedge(result, ids, w + kAhead);
    if (ids.wedges[w] != kNoId) continue;
    ids.wedges[w] = wedge_id(ids.positions[result.wedge_position[w]], result.wedge_attributes.data() + w * stride_);
  }
}

void BuildPool::add_simplified(std::span<const NewClusters> added) {
  std::vector<Ids> ids(added.size());
  parallel_for_each_index(added.size(), 1, [&](std::size_t g) { ids[g] = find_known(added[g].result); });
  std::vector<ClusterId> first(added.size());
  for (std::size_t g = 0; g < added.size(); ++g) {
    insert_new(added[g].result, ids[g]);
    first[g] = add_clusters(added[g].clustering, added[g].level, added[g].own_group);
    triangle_material.add(added[g].result.triangle_material);
  }
  std::vector<std::vector<std::vector<std::uint32_t>>> parts(added.size());
  parallel_for_each_index(added.size(), 1, [&](std::size_t g) {
    const SimplifyResult& result = added[g].result;
    parts[g] = fill_clusters(result.triangles, ids[g].wedges, result.triangle_material, added[g].clustering, first[g]);
  });
  for (std::size_t g = 0; g < added.size(); ++g) add_vertices(parts[g], first[g], added[g].clustering.count);
}

void BuildPool::end_round() {
  for (const auto& [position, more] : late_witnesses_) add_distinct(witnesses[position], more);
  late_witnesses_.clear();
}

void BuildPool::finish() {
  position_table_ = {};
  wedge_table_ = {};
  release(witnesses, late_witnesses_);
}

std::vector<std::uint32_t> BuildPool::positions_of(const BuildCluster& cluster) const {
  std::vector<std::uint32_t> ids;
  ids.reserve(cluster.vertex_count);
  for (const std::uint32_t wedge : vertices_of(cluster)) ids.push_back(wedge_position[wedge]);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::uint32_t BuildPool::count_materials(const BuildCluster& cluster) const {
  std::vector<std::uint32_t> materials;
  for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
    const std::uint32_t material = material_of(triangle_material[t]);
    if (materials.empty() || material != materials.back()) materials.push_back(material);
  }
  std::sort(materials.begin(), materials.end());
  return static_cast<std::uint32_t>(std::unique(materials.begin(), materials.end()) - materials.begin());
}

}  // namespace meshlode::builder
