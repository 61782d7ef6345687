// SPDX-License-Identifier: GPL-3.0-or-later
// A cut may have what one group made beside what another one of the level replaces, where that one's error is larger.
// What the first stood for, and is near to what the second made, has to be near to this cut as well.
#include <limits>

#include "base/parallel.h"
#include "builder/deviation/bounded_search.h"
#include "builder/measure/level_meter.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kPartsOfMoved = 64;

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

/// Of one group: how far they are from what it made, and, where that is too far, from that and what the other group
/// replaced together.
void LevelMeter::measure_moved(const LevelSurface& surface, std::span<Moved> moved) const {
  const std::uint32_t g = moved.front().group;
  const double enough = dag_.groups[g].error / margin_;
  const auto measure = [&](const SurfaceTree& tree, Moved& m) {
    if (tree.size() == 0) {
      m.distance = std::numeric_limits<double>::infinity();
    } else if (m.is_triangle) {
      BoundedSearch search(tree, kTolerance, enough);
      search.add(source_.impl().corners(m.id), TreeSlot());
      (void)search.run(kPartsOfMoved);
      m.distance = search.found().distance;
    } else {
      const Vec3d& point = source_.impl().positions[m.id];
      m.distance = distance_at(tree, point, find_near(tree, point, TreeSlot(), enough).slot);
    }
  };
  const std::uint32_t first = surface.start[g - first_], end = surface.start[g - first_ + 1];
  SurfaceTree own;
  own.build({surface.positions, std::span(surface.triangles).subspan(first, end - first)});
  std::vector<std::uint32_t> others;
  for (Moved& m : moved) {
    measure(own, m);
    if (m.distance > enough) others.push_back(m.to);
  }
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (const std::uint32_t other : others) {
    std::vector<Vec3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const auto add = [&](const TriangleCorners& corners) {
      const auto base = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), corners.begin(), corners.end());
      triangles.push_back({base, base + 1, base + 2});
    };
    for (std::uint32_t k = first; k < end; ++k) add(surface.corners(k));
    const DagGroup& group = dag_.groups[other];
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const DagCluster& cluster = dag_.clusters[c];
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        TriangleCorners corners;
        for (std::size_t k = 0; k < 3; ++k) {
          corners[k] = mesh_.grid.decode(dag_.vertex_position[cluster.first_vertex + dag_.triangles[t][k]]);
        }
        add(corners);
      }
    }
    SurfaceTree both;
    both.build({positions, triangles});
    for (Moved& m : moved) {
      if (m.to == other && m.distance > enough) measure(both, m);
    }
  }
}

/// A group's error is what keeps such a cut true; at most the other group's, so that there is no such cut. What is
/// raised may come to be larger than that of others that it was smaller than: so again, until nothing is.
void LevelMeter::wait_for_others(const LevelSurface& surface, std::span<const UnitChunk> chunks) {
  std::vector<Moved> moved;
  for (const UnitChunk& chunk : chunks) moved.insert(moved.end(), chunk.moved.begin(), chunk.moved.end());
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

/// Those of each group side by side; they are in the order of groups.
void LevelMeter::measure_all_moved(const LevelSurface& surface, std::span<Moved> moved) const {
  std::vector<std::size_t> start;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (i == 0 || moved[i].group != moved[i - 1].group) start.push_back(i);
  }
  start.push_back(moved.size());
  parallel_for_each_index(start.size() - 1, 1, [&](std::size_t i) {
    measure_moved(surface, moved.subspan(start[i], start[i + 1] - start[i]));
  });
}

void LevelMeter::raise_by(std::span<const Moved> moved) {
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (const Moved& m : moved) {
      double& error = dag_.groups[m.group].error;
      const double least = std::min(margin_ * m.distance, dag_.groups[m.to].error);
      if (!(least > error)) continue;
      error = least;
      is_changed = true;
    }
  }
}

}  // namespace meshlode::builder
