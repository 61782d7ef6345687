// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/kept_topology.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/id_table.h"
#include "format/grid.h"

namespace meshlode::builder {

namespace {

/// Of the ring's triangles those that have `v`.
std::ptrdiff_t count_with(const CollapseMesh& mesh, const Ring& ring, std::uint32_t v) {
  return std::count_if(ring.corners().begin(), ring.corners().end(),
                       [&](std::uint32_t corner) { return mesh.has(corner / 3, v); });
}

/// Whether b brings the shared a no edge to another shared vertex, and no triangle with two of them.
bool joins_no_shared(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star) {
  const auto is_shared = [&](std::uint32_t v) { return locks.is_vertex_shared[v] != 0; };
  const auto is_neighbor_of_a = [&](std::uint32_t v) { return count_with(mesh, star.a, v) != 0; };
  return std::none_of(star.b.corners().begin(), star.b.corners().end(), [&](std::uint32_t corner) {
    const auto [x, y] = mesh.others(corner);
    const bool is_new_edge = (x != star.a.vertex && is_shared(x) && !is_neighbor_of_a(x)) ||
                             (y != star.a.vertex && is_shared(y) && !is_neighbor_of_a(y));
    return is_new_edge || (x != star.a.vertex && y != star.a.vertex && is_shared(x) && is_shared(y));
  });
}

/// Whether the edge has one triangle, and that has no neighbour across its other edges either.
bool is_lone_triangle(const CollapseMesh& mesh, const CollapseStar& star) {
  return star.on_edge == 1 && count_with(mesh, star.a, star.tips[0]) == 1 &&
         count_with(mesh, star.b, star.tips[0]) == 1;
}

/// All that are at most a step off along each axis, the nearest first.
constexpr std::array<std::array<int, 3>, 27> make_steps() {
  std::array<std::array<int, 3>, 27> steps{};
  std::size_t count = 0;
  for (int axes = 0; axes <= 3; ++axes) {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x * x + y * y + z * z == axes) steps[count++] = {x, y, z};
        }
      }
    }
  }
  return steps;
}
constexpr auto kSteps = make_steps();

bool is_on_grid(const Vec3i& place) {
  return std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) <= format::kMaxGridCoordinate;
}

}  // namespace

bool keeps_to_itself(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star) {
  if (is_lone_triangle(mesh, star)) return false;
  return locks.is_vertex_shared[star.a.vertex] == 0 || joins_no_shared(mesh, locks, star);
}

std::size_t HashOfPlace::operator()(const Vec3i& place) const {
  return static_cast<std::size_t>(hash_point(place));
}

OwnPlaces::OwnPlaces(const SimplifyInput& input) : input_(input), now_(2 * input.positions.size()) {
  now_.insert(input.positions.begin(), input.positions.end());
  for (std::size_t p = 0; p < input.positions.size(); ++p) {
    if (input.is_locked[p] == 0) given_.insert(input.positions[p]);
  }
}

bool OwnPlaces::is_free(const Vec3i& place, const Vec3i& a, const Vec3i& b) const {
  if (place == a || place == b) return true;
  if (now_.contains(place)) return false;
  return given_.contains(place) || !input_.is_place_taken || !input_.is_place_taken(place);
}

bool OwnPlaces::find_free(const Vec3i& a, const Vec3i& b, Vec3i& wanted) const {
  for (const auto& [x, y, z] : kSteps) {
    const Vec3i place = wanted + Vec3i(x, y, z);
    if (!is_on_grid(place) || !is_free(place, a, b)) continue;
    wanted = place;
    return true;
  }
  return false;
}

void OwnPlaces::join(const Vec3i& a, const Vec3i& b, const Vec3i& to) {
  now_.erase(a);
  now_.erase(b);
  now_.insert(to);
}

std::vector<Vec3i> new_places(const SimplifyInput& input, const SimplifyResult& result) {
  const PlaceSet before(input.positions.begin(), input.positions.end());
  std::vector<Vec3i> places;
  for (const Vec3i& place : result.positions) {
    if (!before.contains(place)) places.push_back(place);
  }
  return places;
}

}  // namespace meshlode::builder
