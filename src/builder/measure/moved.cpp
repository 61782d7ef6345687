// SPDX-License-Identifier: GPL-3.0-or-later
// A cut may have what one group made beside what another one of the level replaces, where that one's error is larger.
// What the first stood for, and is near to what the second made, has to be near to this cut as well.
#include <limits>
#include <queue>
#include <utility>

#include "base/parallel.h"
#include "base/release.h"
#include "builder/deviation/bounded_search.h"
#include "builder/measure/cluster_surface.h"
#include "builder/measure/level_meter.h"

namespace meshlode::builder {

namespace {

/// Parts of a triangle's search against one surface, and against what a group and another one's children are together.
/// Of 7,000 of the second kind in random scenes none made more than 516.
constexpr std::size_t kPartsOfMoved = 64, kPartsOfTogether = 4096;

/// In parallel, those one after another with the same value of a member.
template <class Item, class Turn>
void for_each_run(std::span<Item> all, std::uint32_t Item::*key, const Turn& turn) {
  std::vector<std::size_t> start;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || all[i].*key != all[i - 1].*key) start.push_back(i);
  }
  start.push_back(all.size());
  parallel_for_each_index(start.size() - 1, 1,
                          [&](std::size_t i) { turn(all.subspan(start[i], start[i + 1] - start[i])); });
}

}  // namespace

/// `near`: of the unit's vertices; nullptr: all are near to `near_all`.
void LevelMeter::list_moved(const LevelSurface& surface, const OwnedUnit& unit, const NearVertex* near,
                            std::uint32_t near_all, UnitChunk& chunk) const {
  const SourceUnits::Unit& of = units_.units()[unit.unit];
  const auto from_of = [&](std::uint32_t v) { return dag_.clusters[owner_[of.first_vertex + v]].coarser_group.value; };
  const auto to_of = [&](std::uint32_t v) { return maker(surface, near == nullptr ? near_all : near[v].triangle); };
  bool is_any = false;
  for (std::uint32_t v = 0; v < of.vertex_count; ++v) {
    const std::uint32_t from = from_of(v);
    const GroupId to = to_of(v);
    if (!is_of_level(from) || !to.is_valid() || to.value == from) continue;
    is_any = true;
    chunk.moved.push_back({from, to.value, units_.vertices(of)[v], false});
  }
  if (!is_any) return;
  for (const SourceUnits::Triangle& t : units_.triangles(of)) {
    const std::uint32_t from = from_of(t.corner[0]);
    if (!is_of_level(from) || from_of(t.corner[1]) != from || from_of(t.corner[2]) != from) continue;
    GroupId last;
    for (const std::uint8_t v : t.corner) {
      const GroupId to = to_of(v);
      if (to.is_valid() && to.value != from && to != last) chunk.moved.push_back({from, to.value, t.id, true});
      last = to;
    }
  }
}

/// How far something moved is from a tree at most; 0: not farther than `enough`. Of triangles that may be, some
/// distance beyond will do, unless all is to be known.
double LevelMeter::distance_from(const SurfaceTree& tree, const Moved& m, double enough, bool is_all) const {
  if (tree.size() == 0) return std::numeric_limits<double>::infinity();
  if (!m.is_triangle) {
    const Vec3d& point = source_.impl().positions[m.id];
    const double distance = distance_at(tree, point, find_near(tree, point, TreeSlot(), enough).slot);
    return distance > enough ? distance : 0.0;
  }
  BoundedSearch search(tree, kTolerance, enough);
  search.add(source_.impl().corners(m.id), TreeSlot());
  for (std::size_t parts = 0; parts < kPartsOfMoved && search.found().distance == 0.0 && !search.is_done();) {
    parts += search.run(2);
  }
  if (is_all) (void)search.run(kPartsOfTogether);
  return std::max(search.found().distance, search.bound_of_rest());
}

/// Of one group: how far they are from what it made.
void LevelMeter::measure_from_own(const LevelSurface& surface, std::span<Moved> moved) const {
  const std::uint32_t g = moved.front().group, first = surface.start[g - first_], end = surface.start[g - first_ + 1];
  SurfaceTree own;
  own.build({surface.positions, std::span(surface.triangles).subspan(first, end - first)});
  const Moved* last = nullptr;
  for (Moved& m : moved) {
    const bool is_last = last != nullptr && last->id == m.id && last->is_triangle == m.is_triangle;
    m.distance = is_last ? last->distance : distance_from(own, m, enough(g), false);
    last = &m;
  }
}

/// To one other group, those that are too far from what their own made: how far they are from that and what the other
/// replaced together. No tree of both is made where each is near to the one or the other.
void LevelMeter::measure_from_both(const LevelSurface& surface, std::span<Moved> moved) const {
  ClusterSurface surface_of_both;
  auto& [positions, triangles] = surface_of_both;
  const DagGroup& to = dag_.groups[moved.front().to];
  for (std::uint32_t c = to.first_cluster; c < to.first_cluster + to.cluster_count; ++c) {
    surface_of_both.add(dag_, mesh_.grid, dag_.clusters[c]);
  }
  const std::size_t position_count = positions.size(), triangle_count = triangles.size();
  SurfaceTree tree;
  tree.build({positions, triangles});
  std::vector<Moved*> open;
  for (Moved& m : moved) {
    m.distance = std::min(m.distance, distance_from(tree, m, enough(m.group), false));
    if (m.distance > 0.0 && m.is_triangle) open.push_back(&m);
  }
  for (std::size_t i = 0; i < open.size();) {
    const std::uint32_t g = open[i]->group;
    positions.resize(position_count);
    triangles.resize(triangle_count);
    for (std::uint32_t k = surface.start[g - first_]; k < surface.start[g - first_ + 1]; ++k) {
      const auto base = static_cast<std::uint32_t>(positions.size());
      const TriangleCorners corners = surface.corners(k);
      positions.insert(positions.end(), corners.begin(), corners.end());
      triangles.push_back({base, base + 1, base + 2});
    }
    tree = {};
    tree.build({positions, triangles});
    for (double most = enough(g); i < open.size() && open[i]->group == g; ++i) {
      open[i]->distance = distance_from(tree, *open[i], most, true);
      most = std::max(most, open[i]->distance);
    }
  }
}

/// By the groups that made parts of the surface, in their order.
std::vector<LevelMeter::PartBox> LevelMeter::part_boxes(const LevelSurface& surface) const {
  std::vector<PartBox> parts;
  std::vector<std::uint32_t> part_of(dag_.groups.size(), kNoId);
  for (std::uint32_t k = 0; k < surface.triangles.size(); ++k) {
    const GroupId made = maker(surface, k);
    if (!made.is_valid()) continue;
    std::uint32_t& part = part_of[made.value];
    if (part == kNoId) {
      part = static_cast<std::uint32_t>(parts.size());
      parts.push_back({made.value, {}});
    }
    for (const Vec3d& x : surface.corners(k)) parts[part].box.add(x);
  }
  return parts;
}

/// What a search looked at may be near to any part within the group's error: unless that is enough for the overlay to
/// say what it is near to, or for what the group itself made.
std::vector<LevelMeter::Moved> LevelMeter::list_searched(const LevelSurface& surface,
                                                         std::span<UnitChunk> chunks) const {
  std::vector<Moved> searched, moved;
  for (UnitChunk& chunk : chunks) {
    for (const Moved& m : chunk.searched) {
      if (m.distance > enough(m.group)) searched.push_back(m);
    }
    release(chunk.searched);
  }
  if (searched.empty()) return moved;
  for_each_run(std::span(searched), &Moved::group, [&](std::span<Moved> run) { measure_from_own(surface, run); });
  const std::vector<PartBox> parts = part_boxes(surface);
  for (const Moved& m : searched) {
    if (m.distance == 0.0) continue;
    Box3d box;
    for (const Vec3d& x : source_.impl().corners(m.id)) box.add(x);
    for (const PartBox& part : parts) {
      if (part.group == m.group || !part.box.is_within(box, enough(m.group))) continue;
      moved.push_back({m.group, part.group, m.id, true});
    }
  }
  return moved;
}

/// A group's error is what keeps such a cut true; at most the other group's, so that there is no such cut. What is
/// raised may come to be larger than that of others that it was smaller than: so again, until nothing is.
void LevelMeter::wait_for_others(const LevelSurface& surface, std::span<UnitChunk> chunks) {
  std::vector<Moved> moved = list_searched(surface, chunks);
  std::size_t count = moved.size();
  for (const UnitChunk& chunk : chunks) count += chunk.moved.size();
  moved.reserve(count);
  for (UnitChunk& chunk : chunks) {
    moved.insert(moved.end(), chunk.moved.begin(), chunk.moved.end());
    release(chunk.moved);
  }
  std::sort(moved.begin(), moved.end());
  const auto is_same = [](const Moved& a, const Moved& b) { return !(a < b); };
  moved.erase(std::unique(moved.begin(), moved.end(), is_same), moved.end());
  const auto counts = [&](const Moved& m) { return dag_.groups[m.to].error > dag_.groups[m.group].error; };
  for (auto open = moved.begin();;) {
    const auto end = std::stable_partition(open, moved.end(), counts);
    if (end == open) break;
    measure_all_moved(surface, std::span(open, end));
    open = end;
    raise_by(std::span(moved.begin(), open));
  }
}

void LevelMeter::measure_all_moved(const LevelSurface& surface, std::span<Moved> moved) const {
  for_each_run(moved, &Moved::group, [&](std::span<Moved> of_one) { measure_from_own(surface, of_one); });
  const auto far = std::stable_partition(moved.begin(), moved.end(), [](const Moved& m) { return m.distance == 0.0; });
  std::stable_sort(far, moved.end(), [](const Moved& a, const Moved& b) { return a.to < b.to; });
  for_each_run(std::span(far, moved.end()), &Moved::to,
               [&](std::span<Moved> to_one) { measure_from_both(surface, to_one); });
}

/// From the largest error down: what a group's error is when its turn comes is not raised any more.
void LevelMeter::raise_by(std::span<const Moved> moved) {
  std::vector<std::vector<const Moved*>> moved_to(dag_.groups.size());  // of the level, or of another
  std::priority_queue<std::pair<double, std::uint32_t>> open;
  for (const Moved& m : moved) {
    if (moved_to[m.to].empty()) open.emplace(dag_.groups[m.to].error, m.to);
    moved_to[m.to].push_back(&m);
  }
  for (; !open.empty();) {
    const auto [limit, to] = open.top();
    open.pop();
    if (limit < dag_.groups[to].error) continue;  // it had its turn
    for (const Moved* m : moved_to[to]) {
      double& error = dag_.groups[m->group].error;
      const double least = std::min(margin_ * m->distance, limit);
      if (!(least > error)) continue;
      error = least;
      open.emplace(error, m->group);
    }
  }
}

}  // namespace meshlode::builder
