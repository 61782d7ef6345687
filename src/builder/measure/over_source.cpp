// SPDX-License-Identifier: GPL-3.0-or-later
// What the groups of a level made against the source.
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "builder/deviation/bounded_search.h"
#include "builder/measure/level_meter.h"

namespace meshlode::builder {

namespace {

/// What is left of a triangle after so many pieces is left to a search in bounds. With 64 and 256 crystal.glb takes 4.2
/// and 1.0 s to build for 0.7; with 16384 as long.
constexpr std::size_t kMostPiecesOfMade = 1024;

/// A part of a triangle is divided while it is wider than so many times what is known, and while that is more than this
/// share of the source triangle below: one source triangle is then near to all of a part soon, and the many beside it
/// are not looked at. Without, rocker-arm takes 0.54 s for 0.40, homer 0.27 for 0.20; 1 to 2 times and shares of 0.15
/// to 0.5 are within 10% of that, a share of 0 takes fandisk from 0.3 to 1.15 s.
constexpr double kDivided = 1.5, kShareOfSource = 0.25;
/// Divided so often at most: into 4096 parts, about as many as source triangles an overlay would pass.
constexpr std::uint32_t kMostDivisions = 6;
/// For a point inside of a triangle any source triangle so near will do, as a share of what is known.
constexpr double kNearPoint = 0.25;

struct PartOfMade {
  TriangleCorners corners;
  TreeSlot near;
  std::uint32_t divisions = 0;
};

/// The distance to one triangle is convex: what its corners are near to, all of a part is near to. `longest`: edge of
/// the triangle. Most parts are larger than it, and reach far beyond: that is seen without the triangle's inside.
bool is_within_of(const TriangleCorners& below, double longest, const TriangleCorners& part, double within) {
  constexpr double kRounding = 1e-9;  // far more than doubles are off by
  const double reach = (1.0 + kRounding) * (within + longest);
  const auto is_beyond = [&](const Vec3d& x) { return glm::dot(x - below[0], x - below[0]) > reach * reach; };
  if (std::any_of(part.begin(), part.end(), is_beyond)) return false;
  const TriangleDistance distance(below);
  return std::all_of(part.begin(), part.end(),
                     [&](const Vec3d& x) { return distance.squared_to(x) <= within * within; });
}

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
  std::vector<PartOfMade> parts;
  for (std::uint32_t i = 0; i < made.triangle_count; ++i) {
    const std::uint32_t k = made.first_triangle + i;
    if (!made.near[i].is_valid()) continue;
    const std::uint8_t seen = seen_[k].load(std::memory_order_relaxed);
    if (seen == kSeen) continue;
    const auto [a, b, c] = surface.corners(k);
    bool is_searched = false;
    parts.assign(1, {{a, b, c}, made.near[i], 0});
    while (!parts.empty()) {
      const PartOfMade part = parts.back();
      parts.pop_back();
      const auto& [x, y, z] = part.corners;
      const TreeSlot near = find_near(source, (x + y + z) / 3.0, part.near, kNearPoint * within).slot;
      const TriangleCorners below = impl.corners(source.triangle_at(near));
      const double longest = longest_edge(below);
      if (is_within_of(below, longest, part.corners, within)) continue;
      if (part.divisions < kMostDivisions && longest_edge(part.corners) > kDivided * within &&
          within > kShareOfSource * longest) {
        const Vec3d xy = 0.5 * (x + y), yz = 0.5 * (y + z), zx = 0.5 * (z + x);
        for (const TriangleCorners& corners : {TriangleCorners{x, xy, zx}, {xy, y, yz}, {zx, yz, z}, {xy, yz, zx}}) {
          parts.push_back({corners, near, part.divisions + 1});
        }
        continue;
      }
      if (overlay.is_within(part.corners, source.triangle_at(near), within)) continue;
      for (const Overlay::Far& far : overlay.far()) raise(far.distance);
      is_searched = is_searched || !overlay.rest().empty();
      for (const Overlay::Rest& rest : overlay.rest())
        search.add_later(rest.corners, impl.place_of(rest.near), rest.bound);
    }
    searched += is_searched ? 1 : 0;
  }
  (void)search.run(kPartsPerTriangle * searched);
  raise(search.found().distance);
  if (!search.is_done()) made.left.push_back({std::move(search), made.group, nullptr, {}});
}

}  // namespace meshlode::builder
