// SPDX-License-Identifier: GPL-3.0-or-later
// What the groups of a level made against the source.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "builder/deviation/bounded_search.h"
#include "builder/measure/level_meter.h"

namespace meshlode::builder {

namespace {

/// What is left of a triangle after so many pieces is left to a search in bounds. With 64 and 256 crystal.glb takes 3.8
/// and 1.2 s to build for 0.7; with 16384 as long.
constexpr std::size_t kMostPiecesOfMade = 1024;

}  // namespace

void LevelMeter::ask_vertices(Made& made) const {
  const SurfaceTree& source = source_.impl().tree;
  const DagCluster& cluster = dag_.clusters[made.cluster];
  double within = known(made.group).known;
  std::vector<TreeSlot> near(cluster.vertex_count);
  TreeSlot place;
  const auto ask = [&](std::uint32_t v) {
    if (is_new_[cluster.first_vertex + v] != 0 || !place.is_valid()) {
      const Vec3d at = mesh_.grid.decode(dag_.vertex_position[cluster.first_vertex + v]);
      const SurfaceTree::Hit hit = find_near(source, at, place, within);
      if (hit.slot.is_valid()) place = hit.slot;
      if (hit.distance2 > 0.98F * source.squared_in_frame(within)) {  // as floats say
        const double distance = distance_at(source, at, place);
        if (distance > within) made.raised.push_back({made.group, distance});
        within = std::max(within, distance);
      }
    }
    near[v] = place;
  };
  made.near.resize(cluster.triangle_count);
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {  // the order of triangles is canonical, of vertices not
    for (const std::uint8_t v : dag_.triangles[cluster.first_triangle + t]) {
      if (!near[v].is_valid()) ask(v);
    }
    made.near[t] = near[dag_.triangles[cluster.first_triangle + t][0]];
  }
}

void LevelMeter::check_made(const LevelSurface& surface, Made& made) const {
  const SourceTree::Impl& impl = source_.impl();
  const SurfaceTree& source = impl.tree;
  double within = known(made.group).known;
  const auto raise = [&](double distance) {
    if (distance <= within) return;
    made.raised.push_back({made.group, distance});
    within = distance;
  };
  BoundedSearch search(source, kTolerance, within);
  std::size_t searched = 0;
  const LinkedSurface linked{impl.positions, impl.triangles, source_neighbor_, source_normal_, source, impl.place};
  Overlay overlay(linked, kMostPiecesOfMade, Overlay::Cuts::kNeeded);
  for (std::uint32_t i = 0; i < made.triangle_count; ++i) {
    const std::uint32_t k = made.first_triangle + i;
    if (!made.near[i].is_valid()) continue;
    const std::uint8_t seen = seen_[k].load(std::memory_order_relaxed);
    if (seen == kSeen) continue;
    const TriangleCorners corners = surface.corners(k);
    const Vec3d middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const std::uint32_t below = source.triangle_at(find_near(source, middle, made.near[i], within).slot);
    if (overlay.is_within(corners, below, within)) continue;
    for (const Overlay::Far& far : overlay.far()) raise(far.distance);
    for (const Overlay::Rest& rest : overlay.rest())
      search.add_later(rest.corners, impl.place_of(rest.near), rest.bound);
    searched += overlay.rest().empty() ? 0 : 1;
  }
  (void)search.run(kPartsPerTriangle * searched);
  raise(search.found().distance);
  if (!search.is_done()) made.left.push_back({std::move(search), made.group, nullptr, {}});
}

}  // namespace meshlode::builder
