// SPDX-License-Identifier: GPL-3.0-or-later
// The source against a level's surface.
#include <utility>

#include "builder/deviation/bounded_search.h"
#include "builder/measure/level_meter.h"

namespace meshlode::builder {

namespace {

/// A triangle so near to a vertex, as a share of what is known, will do: none nearer is looked for. 0.8 misses 8% of
/// one group of the dragon.
constexpr double kNearEnough = 0.5;
/// Where the planes of the triangles below its corners are this near, as a share of what is known, a source triangle is
/// not laid over them. 0.3 finds all of what 0 does on the dragon, 0.5 misses 5% of one group of 711.
constexpr double kFlat = 0.4;
/// And this cosine from parallel to them.
constexpr float kFlatCosine = 0.9F;
/// What is left of a source triangle after so many pieces is left to a search in bounds.
constexpr std::size_t kMostPiecesOfUnit = 48;
/// More than a distance in floats is off by.
constexpr double kSlack = 1e-6;

}  // namespace

void LevelMeter::ask_units(const LevelSurface& surface, UnitChunk& chunk) const {
  const SurfaceTree& tree = surface.tree;
  if (tree.size() == 0) return;
  const std::span<const Vec3d> positions = source_.impl().positions;
  TreeSlot place;
  chunk.first_near.assign(chunk.units.size(), kNoId);
  chunk.near_all.assign(chunk.units.size(), 0);
  for (std::size_t i = 0; i < chunk.units.size(); ++i) {
    const SourceUnits::Unit& unit = units_.units()[chunk.units[i].unit];
    Owners owners(*this, chunk.units[i], chunk.raised);
    if (const double within = owners.known(); unit.radius < within) {
      place = find_near(tree, unit.center, place, within - unit.radius).slot;
      if (place.is_valid() && distance_at(tree, unit.center, place) + unit.radius <= within) {
        chunk.near_all[i] = tree.triangle_at(place);
        list_moved(surface, chunk.units[i], nullptr, chunk.near_all[i], chunk);
        continue;
      }
    }
    chunk.first_near[i] = static_cast<std::uint32_t>(chunk.near.size());
    for (const std::uint32_t v : units_.vertices(unit)) {
      const double within = owners.known();
      const SurfaceTree::Hit hit = find_near(tree, positions[v], place, kNearEnough * within);
      if (hit.slot.is_valid()) place = hit.slot;
      if (!place.is_valid()) place = TreeSlot(0U);  // farther than floats reach: not on any real mesh
      double distance = std::sqrt(static_cast<double>(hit.distance2)) / tree.scale();
      if (distance > 0.99 * within) {  // as floats say
        distance = distance_at(tree, positions[v], place);
        owners.raise(surface, distance, tree.triangle_at(place));
      }
      chunk.near.push_back({tree.triangle_at(place), static_cast<float>(distance)});
    }
    list_moved(surface, chunk.units[i], chunk.near.data() + chunk.first_near[i], 0, chunk);
  }
  chunk.near.shrink_to_fit();
  chunk.moved.shrink_to_fit();
}

/// Whether two triangles touch. Between two that do not, and that it is near to, the source may leap.
bool LevelMeter::has_common_corner(const LevelSurface& surface, std::uint32_t a, std::uint32_t b) {
  if (a == b) return true;
  const LevelSurface::Triangle& of_b = surface.triangles[b];
  return std::ranges::any_of(surface.triangles[a],
                             [&](std::uint32_t v) { return v == of_b[0] || v == of_b[1] || v == of_b[2]; });
}

/// `normal`: of the source triangle. `is_end`: the source ends there, or leaps to another part of the surface.
void LevelMeter::mark_seen(const LevelSurface& surface, std::uint32_t triangle, const Vec3f& normal, bool is_end) {
  const std::uint8_t before = seen_[triangle].load(std::memory_order_relaxed);
  if (before == (kSeen | kOpen)) return;
  const bool is_open = is_end || glm::dot(normal, surface.normal[triangle]) < kParallel;
  const std::uint8_t flags = is_open ? kSeen | kOpen : kSeen;
  if (before == flags) return;
  seen_[triangle].fetch_or(flags, std::memory_order_relaxed);
}

/// Whether the planes of what its corners are near to tell that a source triangle is near to them where it passes from
/// one to another: along an edge both heights are linear, and where they are equal it passes over.
bool LevelMeter::is_flat(const LevelSurface& surface, const TriangleCorners& corners, const Vec3f& normal,
                         const std::array<std::uint32_t, 3>& near, double within) const {
  std::array<std::array<double, 3>, 3> height;  // of corner i over the plane of triangle j
  for (std::size_t j = 0; j < 3; ++j) {
    if (!(glm::dot(normal, surface.normal[near[j]]) > kFlatCosine)) return false;
    const Vec3d up(surface.normal[near[j]]);
    const Vec3d& foot = surface.positions[surface.triangles[near[j]][0]];
    for (std::size_t i = 0; i < 3; ++i) height[i][j] = glm::dot(up, corners[i] - foot);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (near[i] == near[j]) continue;
    const double at_i = height[i][i] - height[i][j], at_j = height[j][i] - height[j][j];
    double most = 0.0;
    if ((at_i < 0.0) != (at_j < 0.0)) {
      most = std::abs(height[i][i] + (height[j][i] - height[i][i]) * at_i / (at_i - at_j));
    } else {
      most = std::min(std::max(std::abs(height[i][i]), std::abs(height[j][i])),
                      std::max(std::abs(height[j][j]), std::abs(height[i][j])));
    }
    if (most > kFlat * within) return false;
  }
  return true;
}

/// The group of the level that all of its corners belong to, if there is one.
GroupId LevelMeter::owner_of(const SourceUnits::Unit& unit, const SourceUnits::Triangle& triangle) const {
  const auto group = [&](std::size_t k) {
    return dag_.clusters[owner_[unit.first_vertex + triangle.corner[k]]].coarser_group;
  };
  return is_of_level(group(0).value) && group(1) == group(0) && group(2) == group(0) ? group(0) : GroupId();
}

void LevelMeter::check_units(const LevelSurface& surface, UnitChunk& chunk) {
  const SourceTree::Impl& source = source_.impl();
  const LinkedSurface linked = surface.linked();
  Overlay overlay(linked, kMostPiecesOfUnit, Overlay::Cuts::kAll);
  BoundedSearch search(surface.tree, kTolerance, known(chunk.group).known);
  std::size_t searched = 0;
  for (std::size_t i = 0; i < chunk.first_near.size(); ++i) {
    if (chunk.first_near[i] == kNoId) continue;
    const SourceUnits::Unit& unit = units_.units()[chunk.units[i].unit];
    const NearVertex* near = chunk.near.data() + chunk.first_near[i];
    Owners owners(*this, chunk.units[i], chunk.raised);
    for (const SourceUnits::Triangle& t : units_.triangles(unit)) {
      const std::array<NearVertex, 3> n{near[t.corner[0]], near[t.corner[1]], near[t.corner[2]]};
      const std::array<std::uint32_t, 3> k{n[0].triangle, n[1].triangle, n[2].triangle};
      const TriangleCorners corners = source.corners(t.id);
      const double within = owners.known();
      const bool is_leap = !has_common_corner(surface, k[0], k[1]) || !has_common_corner(surface, k[1], k[2]) ||
                           !has_common_corner(surface, k[2], k[0]);
      bool is_at_border = false;
      const Vec3f normal = source_normal_.empty() ? unit_normal(corners) : source_normal_[t.id];
      for (std::size_t j = 0; j < 3; ++j) {
        const bool is_border = units_.is_border(units_.vertices(unit)[t.corner[j]]);
        mark_seen(surface, k[j], normal, is_border || is_leap);
        is_at_border = is_at_border || is_border;
      }
      if (k[0] == k[1] && k[1] == k[2]) continue;
      const float nearest = std::min(n[0].distance, std::min(n[1].distance, n[2].distance));
      if (static_cast<double>(nearest) + (1.0 + kSlack) * longest_edge(corners) <= within) continue;
      if (!is_at_border && !is_leap && is_flat(surface, corners, normal, k, within)) continue;
      // A distance over one group's part says nothing of what another one's is off by.
      const bool is_within = overlay.is_within(corners, k[0], within, owners.is_one());
      const GroupId owner = owners.is_one() ? GroupId(chunk.group) : owner_of(unit, t);
      const auto is_near_to = [&](GroupId to) {
        if (!owner.is_valid() || !to.is_valid() || to == owner) return;
        chunk.moved.push_back({owner.value, to.value, t.id, true});
      };
      for (const std::uint32_t below : overlay.below()) {
        mark_seen(surface, below, normal, is_at_border || is_leap);
        is_near_to(maker(surface, below));
      }
      if (is_within) continue;
      for (const Overlay::Far& far : overlay.far()) is_near_to(maker(surface, far.nearest));
      for (const Overlay::Far& far : overlay.far()) {
        owners.raise(surface, far.distance, far.nearest);
        // Seen from the triangle below, the source may be farther.
        if (!maker(surface, far.below).is_valid() || !is_of_level(maker(surface, far.below).value)) continue;
        const Vec3d foot = nearest_point(far.at, surface.corners(far.below));
        const TreeSlot back = find_near(source.tree, foot, source.place_of(t.id), owners.known()).slot;
        owners.raise(surface, distance_at(source.tree, foot, back), far.below);
      }
      double bound = 0.0;
      for (const Overlay::Rest& rest : overlay.rest()) bound = std::max(bound, rest.bound);
      if (bound > 0.0 && owner.is_valid()) chunk.searched.push_back({owner.value, kNoId, t.id, true, bound});
      if (owners.is_one()) {
        ++searched;
        for (const Overlay::Rest& rest : overlay.rest()) {
          search.add_later(rest.corners, surface.slot[rest.near], rest.bound);
        }
        continue;
      }
      if (overlay.rest().empty()) continue;
      const auto part_of = [this, &surface, groups = owners_of(chunk.units[i])](std::uint32_t triangle) {
        return this->part_of(groups, surface, triangle);
      };
      BoundedSearch shared(surface.tree, kTolerance, owners.known_of_each(), part_of);
      for (const Overlay::Rest& rest : overlay.rest()) {
        shared.add_later(rest.corners, surface.slot[rest.near], rest.bound);
      }
      (void)shared.run(kPartsPerTriangle);
      owners.raise(shared);
      if (!shared.is_done()) chunk.left.push_back({std::move(shared), chunk.group, &chunk.units[i], {}});
    }
  }
  (void)search.run(kPartsPerTriangle * searched);
  if (search.found().distance > 0.0) chunk.raised.push_back({chunk.group, search.found().distance});
  if (!search.is_done()) chunk.left.push_back({std::move(search), chunk.group, nullptr, {}});
}

}  // namespace meshlode::builder
