// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/level_meter.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/release.h"

namespace meshlode::builder {

namespace {

/// Units that one turn looks after: enough for hints to lead from one to the next.
constexpr std::size_t kUnitsOfChunk = 64;
/// What a search left goes on by so many parts a round; all that are left of a level by so many parts, and so many
/// rounds of each.
constexpr std::size_t kPartsOfRound = 4096, kPartsLeftOfLevel = 1U << 20U, kRoundsOfEach = 4;
/// Of the mesh's diagonal: what arithmetic alone makes of nothing.
constexpr double kNoise = 1e-12;

std::vector<std::uint32_t> level0_clusters(CanonicalForm& form) {
  std::vector<std::uint32_t> clusters;
  clusters.reserve(form.level0_of_source.size());
  for (const CanonicalForm::Level0Triangle& triangle : form.level0_of_source) clusters.push_back(triangle.cluster);
  release(form.level0_of_source);
  return clusters;
}

}  // namespace

LevelMeter::LevelMeter(const PreparedMesh& mesh, SourceTree source, CanonicalForm& form, double margin,
                       std::size_t rounds, std::span<const double> least, LodDag& dag)
    : mesh_(mesh),
      margin_(margin),
      rounds_(rounds),
      least_(least),
      form_(form),
      dag_(dag),
      source_(std::move(source)),
      attributes_(source_, mesh, form, dag),
      outputs_(dag.groups.size()),
      units_of_(dag.clusters.size()) {
  parallel_all([&] { units_ = SourceUnits(source_.impl(), level0_clusters(form), dag.clusters.size()); },
               [&] { find_new_vertices(); });
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].own_group.is_valid()) outputs_[dag.clusters[c].own_group.value].push_back(c);
  }
  owner_.resize(units_.vertex_count());
  parallel_for_each_index(dag.clusters.size(), 64, [&](std::size_t i) {
    const auto c = static_cast<std::uint32_t>(i);
    for (std::uint32_t u = units_.first_unit(c); u < units_.end_unit(c); ++u) {
      units_of_[c].push_back(u);
      const SourceUnits::Unit& unit = units_.units()[u];
      std::fill_n(owner_.begin() + unit.first_vertex, unit.vertex_count, c);
    }
  });
}

void LevelMeter::find_new_vertices() {
  std::vector<std::uint32_t> level_of(form_.position_count, kNoId);  // per position, the finest that has it
  const auto for_each_vertex = [&](const auto& visit) {
    for (const DagCluster& cluster : dag_.clusters) {
      for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
        visit(v, cluster.level, level_of[form_.position_of_vertex[v]]);
      }
    }
  };
  for_each_vertex([](std::uint32_t, std::uint32_t level, std::uint32_t& finest) { finest = std::min(finest, level); });
  is_new_.resize(form_.position_of_vertex.size());
  for_each_vertex([&](std::uint32_t v, std::uint32_t level, std::uint32_t finest) { is_new_[v] = level == finest; });
}

void LevelMeter::link_source() {
  if (!source_neighbor_.empty()) return;
  const SourceTree::Impl& source = source_.impl();
  const auto link = [&] {
    source_neighbor_ = link_edges(source.triangles, source.positions.size(), [&](std::uint32_t position) {
      return source.vertex_of.empty() ? position : source.vertex_of[position];
    });
  };
  const auto find_normals = [&] {
    source_normal_.resize(source.triangles.size());
    parallel_for_each_index(source.triangles.size(), kLoopGrain, [&](std::size_t t) {
      source_normal_[t] = unit_normal(source.corners(static_cast<std::uint32_t>(t)));
    });
  };
  parallel_all(link, find_normals);
}

void LevelMeter::measure_level(std::uint32_t first_group, std::uint32_t end_group) {
  begin_level(first_group, end_group);
  const auto is_terminal = [](const DagGroup& group) { return group.is_terminal; };
  if (std::all_of(dag_.groups.begin() + first_group, dag_.groups.begin() + end_group, is_terminal)) return;
  LevelSurface surface(dag_, mesh_.grid, form_, first_group, end_group, outputs_);
  std::vector<UnitChunk> chunks = chunk_units();
  std::vector<Made> made = made_clusters(surface);
  seen_ = std::vector<std::atomic<std::uint8_t>>(surface.triangles.size());
  parallel_for_each_index(chunks.size(), 1, [&](std::size_t i) { ask_units(surface, chunks[i]); });
  parallel_for_each_index(made.size(), 1, [&](std::size_t i) { ask_vertices(made[i]); });
  merge(chunks);
  merge(made);
  parallel_for_each_index(chunks.size(), 1, [&](std::size_t i) { check_units(surface, chunks[i]); });
  finish_searches(chunks);
  surface.free_search();
  link_source();
  parallel_for_each_index(made.size(), 1, [&](std::size_t i) { check_made(surface, made[i]); });
  finish_searches(made);
  const auto finish = [&] {
    finish_groups(made);
    wait_for_others(surface, chunks);
  };
  parallel_all(finish, [&] { hand_on(surface, chunks); });
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
    k.floor = std::max(mesh_.level0_deviation, least_.empty() ? 0.0 : least_[g]);
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

bool LevelMeter::is_open(Left& left) const {
  if (left.shared == nullptr) {
    left.search.know(known(left.group).known);
  } else {
    std::vector<Raise> none;
    left.search.know(Owners(*this, *left.shared, none).known_of_each());
  }
  return !left.search.is_done();
}

std::size_t LevelMeter::go_on(Left& left) const {
  const std::size_t made = left.search.run(kPartsOfRound);
  if (left.shared != nullptr) {
    Owners(*this, *left.shared, left.raised).raise(left.search);
  } else if (left.search.found().distance > 0.0) {
    left.raised.push_back({left.group, left.search.found().distance});
  }
  return made;
}

/// What a search left at first matters where it may be farther than all that is known by now, and seldom is. It goes on
/// in rounds, so that what one finds ends others.
template <class Item>
void LevelMeter::finish_searches(std::vector<Item>& items) {
  merge(items);
  std::vector<Left> open;
  const auto take_open = [&](std::vector<Left>& left) {
    for (Left& l : left) {
      if (is_open(l)) open.push_back(std::move(l));
    }
    release(left);
  };
  for (Item& item : items) take_open(item.left);
  std::size_t left_to_all = kPartsLeftOfLevel + kRoundsOfEach * kPartsOfRound * open.size();
  for (std::size_t round = 0; round < rounds_ && !open.empty() && left_to_all > 0; ++round) {
    std::vector<std::size_t> made(open.size());
    parallel_for_each_index(open.size(), 1, [&](std::size_t i) { made[i] = go_on(open[i]); });
    for (const std::size_t parts : made) left_to_all -= std::min(left_to_all, parts);
    merge(open);
    std::erase_if(open, [&](Left& left) { return !is_open(left); });
  }
  for (const Left& left : open) {
    const auto count = [&](std::uint32_t g) { known(g).open = std::max(known(g).open, left.search.bound_of_rest()); };
    if (left.shared == nullptr) {
      count(left.group);
    } else {
      for (const std::uint32_t g : owners_of(*left.shared)) count(g);
    }
  }
}

void LevelMeter::finish_groups(std::span<const Made> made) {
  std::vector<std::vector<TreeSlot>> near(end_ - first_);
  for (const Made& m : made) near[m.group - first_].insert(near[m.group - first_].end(), m.near.begin(), m.near.end());
  parallel_for_each_index(near.size(), 1, [&](std::size_t i) {
    const auto g = static_cast<std::uint32_t>(first_ + i);
    DagGroup& group = dag_.groups[g];
    if (group.is_terminal) return;
    const Known& k = known(g);
    group.deviation = k.found;
    group.error = std::max(k.floor, margin_ * (k.open > k.known ? k.open : k.found));
    attributes_.measure(group, outputs_[g], near[i]);
  });
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
