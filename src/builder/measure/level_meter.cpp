// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/level_meter.h"

#include "base/id_table.h"
#include "base/parallel.h"
#include "builder/deviation/attribute_deviation.h"

namespace meshlode::builder {

namespace {

/// Units that one turn looks after: enough for hints to lead from one to the next.
constexpr std::size_t kUnitsOfChunk = 64;
/// Of the mesh's diagonal: what arithmetic alone makes of nothing.
constexpr double kNoise = 1e-12;

std::vector<std::uint32_t> wedges_of_exact(const PreparedMesh& mesh) {
  std::vector<std::uint32_t> wedge_of;
  if (mesh.exact_triangles == mesh.triangles) return wedge_of;
  wedge_of.resize(mesh.exact_positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) wedge_of[mesh.exact_triangles[t][k]] = mesh.triangles[t][k];
  }
  return wedge_of;
}

/// LinkedSurface::neighbor of the source.
std::vector<LinkedSurface::Triangle> link_source(const SourceTree::Impl& source) {
  std::vector<LinkedSurface::Triangle> neighbor(source.triangles.size());
  parallel_for_each_index(neighbor.size(), kLoopGrain, [&](std::size_t t) {
    const auto corner = source.vertices(static_cast<std::uint32_t>(t));
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = corner[e], b = corner[(e + 1) % 3];
      std::uint32_t beyond = kNoId, count = 0;
      for (const std::uint32_t other : source.triangles_around(a)) {
        if (other == t) continue;
        const auto c = source.vertices(other);
        for (std::uint32_t k = 0; k < 3; ++k) {
          if ((c[k] == a && c[(k + 1) % 3] == b) || (c[k] == b && c[(k + 1) % 3] == a)) {
            beyond = 4 * other + k;
            ++count;
          }
        }
      }
      neighbor[t][e] = count == 1 ? beyond : kNoId;
    }
  });
  return neighbor;
}

std::uint64_t hash_position(const Vec3i& q) {
  std::uint64_t h = 0;
  for (int k = 0; k < 3; ++k) h = hash_word(h, static_cast<std::uint32_t>(q[k]));
  return h;
}

}  // namespace

LevelMeter::LevelMeter(const PreparedMesh& mesh, std::span<const std::uint32_t> level0_cluster, double margin,
                       LodDag& dag)
    : mesh_(mesh),
      margin_(margin),
      dag_(dag),
      source_(mesh.exact_positions, mesh.exact_triangles),
      units_(source_.impl(), level0_cluster, dag.clusters.size()),
      source_neighbor_(link_source(source_.impl())),
      wedge_of_exact_(wedges_of_exact(mesh)),
      outputs_(dag.groups.size()),
      units_of_(dag.clusters.size()) {
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].own_group.is_valid()) outputs_[dag.clusters[c].own_group.value].push_back(c);
    for (std::uint32_t u = units_.first_unit(c); u < units_.end_unit(c); ++u) {
      units_of_[c].push_back(u);
      owner_.resize(owner_.size() + units_.units()[u].vertex_count, c);
    }
  }
  list_vertices();
}

/// Which vertices of the DAG are in one place, and at which level it was first taken.
void LevelMeter::list_vertices() {
  const std::vector<Vec3i>& positions = dag_.vertex_position;
  IdTable table(positions.size() / 2);
  std::vector<std::uint32_t> level_of(positions.size(), kNoId);
  vertex_of_.resize(positions.size());
  for (const DagCluster& cluster : dag_.clusters) {
    for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
      const auto is_same = [&](std::uint32_t other) { return positions[other] == positions[v]; };
      const auto hash = [&](std::uint32_t other) { return hash_position(positions[other]); };
      vertex_of_[v] = table.find_or_insert(hash(v), v, is_same, hash).id;
      level_of[vertex_of_[v]] = std::min(level_of[vertex_of_[v]], cluster.level);
    }
  }
  is_new_.resize(positions.size());
  for (const DagCluster& cluster : dag_.clusters) {
    for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
      is_new_[v] = level_of[vertex_of_[v]] == cluster.level ? 1 : 0;
    }
  }
}

void LevelMeter::measure_level(std::uint32_t first_group, std::uint32_t end_group) {
  begin_level(first_group, end_group);
  const auto is_terminal = [](const DagGroup& group) { return group.is_terminal; };
  if (std::all_of(dag_.groups.begin() + first_group, dag_.groups.begin() + end_group, is_terminal)) return;
  const LevelSurface surface(dag_, mesh_.grid, vertex_of_, first_group, end_group, outputs_);
  std::vector<UnitChunk> chunks = chunk_units();
  std::vector<Made> made = made_clusters(surface);
  seen_ = std::vector<std::atomic<std::uint8_t>>(surface.triangles.size());
  parallel_for_each_index(chunks.size(), 1, [&](std::size_t i) { ask_units(surface, chunks[i]); });
  parallel_for_each_index(made.size(), 1, [&](std::size_t i) { ask_vertices(made[i]); });
  merge(chunks);
  merge(made);
  parallel_for_each_index(chunks.size(), 1,
                          [&](std::size_t i) { check_units(surface, chunks[i], kPartsOfLevel / chunks.size()); });
  merge(chunks);
  parallel_for_each_index(made.size(), 1,
                          [&](std::size_t i) { check_made(surface, made[i], kPartsOfLevel / made.size()); });
  merge(made);
  finish_groups(made);
  wait_for_others(surface, chunks);
  hand_on(surface, chunks);
}

void LevelMeter::begin_level(std::uint32_t first_group, std::uint32_t end_group) {
  first_ = first_group;
  end_ = end_group;
  known_.assign(end_group - first_group, {});
  owned_.assign(end_group - first_group, {});
  owners_.clear();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // unit, group
  for (std::uint32_t g = first_group; g < end_group; ++g) {
    const DagGroup& group = dag_.groups[g];
    if (group.is_terminal) continue;
    Known& k = known(g);
    k.floor = mesh_.level0_deviation;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      for (const std::uint32_t u : units_of_[c]) pairs.emplace_back(u, g);
      units_of_[c] = {};
      const GroupId own = dag_.clusters[c].own_group;
      if (own.is_valid()) k.floor = std::max(k.floor, dag_.groups[own.value].error);
    }
    k.known = std::max(k.floor / margin_, kNoise * mesh_.diagonal);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (std::size_t i = 0; i < pairs.size();) {
    const auto [unit, group] = pairs[i];
    const auto first = static_cast<std::uint32_t>(owners_.size());
    for (; i < pairs.size() && pairs[i].first == unit; ++i) owners_.push_back(pairs[i].second);
    owned_[group - first_].push_back({unit, first, static_cast<std::uint32_t>(owners_.size()) - first});
  }
}

std::vector<LevelMeter::UnitChunk> LevelMeter::chunk_units() const {
  std::vector<UnitChunk> chunks;
  for (std::uint32_t g = first_; g < end_; ++g) {
    const std::span<const OwnedUnit> units(owned_[g - first_]);
    for (std::size_t i = 0; i < units.size(); i += kUnitsOfChunk) {
      chunks.emplace_back();
      chunks.back().group = g;
      chunks.back().units = units.subspan(i, std::min(kUnitsOfChunk, units.size() - i));
    }
  }
  return chunks;
}

std::vector<LevelMeter::Made> LevelMeter::made_clusters(const LevelSurface& surface) const {
  std::vector<Made> made;
  for (std::uint32_t g = first_; g < end_; ++g) {
    std::uint32_t triangle = surface.start[g - first_];
    for (const std::uint32_t c : outputs_[g]) {
      made.emplace_back();
      made.back().group = g;
      made.back().cluster = c;
      made.back().first_triangle = triangle;
      made.back().triangle_count = dag_.clusters[c].triangle_count;
      triangle += dag_.clusters[c].triangle_count;
    }
  }
  return made;
}

template <class Item>
void LevelMeter::merge(std::vector<Item>& items) {
  for (Item& item : items) {
    for (const auto& [group, distance] : item.raised) {
      known(group).found = std::max(known(group).found, distance);
      known(group).known = std::max(known(group).known, distance);
    }
    item.raised.clear();
  }
}

void LevelMeter::finish_groups(std::span<const Made> made) {
  std::vector<std::vector<TreeSlot>> near(end_ - first_);
  for (const Made& m : made) near[m.group - first_].insert(near[m.group - first_].end(), m.near.begin(), m.near.end());
  parallel_for_each_index(near.size(), 1, [&](std::size_t i) {
    const auto g = static_cast<std::uint32_t>(first_ + i);
    DagGroup& group = dag_.groups[g];
    if (group.is_terminal) return;
    group.deviation = known(g).found;
    group.error = std::max(known(g).floor, margin_ * known(g).found);
    measure_attributes_of(g, near[i]);
  });
}

void LevelMeter::measure_attributes_of(std::uint32_t g, std::span<const TreeSlot> near) {
  DagGroup& group = dag_.groups[g];
  double normal_floor = 0.0, uv_floor = 0.0;
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    const GroupId own = dag_.clusters[c].own_group;
    if (!own.is_valid()) continue;
    normal_floor = std::max(normal_floor, dag_.groups[own.value].normal_deviation);
    uv_floor = std::max(uv_floor, dag_.groups[own.value].uv_deviation);
  }
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<float> attributes;
  const std::size_t stride = mesh_.layout.stride();
  for (const std::uint32_t c : outputs_[g]) {
    const DagCluster& cluster = dag_.clusters[c];
    const auto base = static_cast<std::uint32_t>(positions.size());
    for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
      positions.push_back(mesh_.grid.decode(dag_.vertex_position[v]));
    }
    const auto from = dag_.vertex_attributes.begin() + static_cast<std::ptrdiff_t>(cluster.first_vertex * stride);
    attributes.insert(attributes.end(), from, from + static_cast<std::ptrdiff_t>(cluster.vertex_count * stride));
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      const auto& l = dag_.triangles[t];
      triangles.push_back({base + l[0], base + l[1], base + l[2]});
    }
  }
  const AttributeDeviation a =
      measure_attributes(source_, {mesh_.wedge_attributes, mesh_.exact_triangles, wedge_of_exact_},
                         {positions, triangles}, {attributes, triangles}, mesh_.layout, near);
  group.normal_deviation = std::max(normal_floor, a.normal);
  group.uv_deviation = std::max(uv_floor, a.uv);
}

/// Where what a vertex of the source belonged to was replaced, it belongs to the cluster that it is near to now.
void LevelMeter::hand_on(const LevelSurface& surface, std::span<const UnitChunk> chunks) {
  for (const UnitChunk& chunk : chunks) {
    for (std::size_t i = 0; i < chunk.first_near.size(); ++i) {
      const std::uint32_t u = chunk.units[i].unit;
      const SourceUnits::Unit& unit = units_.units()[u];
      std::uint32_t last = kNoId;
      for (std::uint32_t v = 0; v < unit.vertex_count; ++v) {
        std::uint32_t& owner = owner_[unit.first_vertex + v];
        const std::uint32_t from = dag_.clusters[owner].coarser_group.value;
        if (from < first_ || from >= end_) continue;
        owner = surface.cluster[chunk.first_near[i] == kNoId ? chunk.near_all[i]
                                                             : chunk.near[chunk.first_near[i] + v].triangle];
        if (owner != last) units_of_[owner].push_back(u);
        last = owner;
      }
    }
  }
}

}  // namespace meshlode::builder
