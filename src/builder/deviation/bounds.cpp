// SPDX-License-Identifier: GPL-3.0-or-later
// Group to source, second part: by bounds, where bounds say much. The points of measure_to_source() may miss a narrow
// peak: beside the riser of a step one stood a quarter above all of them. Where the source's triangles are large
// against the deviation, a triangle of the group mostly lies within it of a single one, and then all of it does; only
// where that is not so it is divided, and little is left after little work. On smooth scans much would be left: a few
// triangles of the group say so, and the points, which tell enough there, are believed.
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "builder/deviation/bounded_search.h"
#include "builder/deviation/group_measure.h"

namespace meshlode::builder {

namespace {

/// One triangle of so many is tried first, but so many at least. No more than this share of them may be left.
constexpr std::size_t kTriedOf = 16, kFewestTried = 32;
constexpr double kMostLeft = 1.0 / 3.0;
/// Parts that a group may be divided into: for each triangle, and besides.
constexpr std::size_t kPartsPerTriangle = 8, kPartsPerGroup = 1000;

}  // namespace

Farthest search_by_bounds(const SurfaceTree& source, const GroupSurface& group, std::span<const TreeSlot> places,
                          double margin, Farthest farthest) {
  const std::size_t count = group.triangles.size();
  const auto corners_of = [&](std::size_t triangle) -> std::array<Vec3d, 3> {
    const auto& ids = group.triangles[triangle];
    return {group.positions[ids[0]], group.positions[ids[1]], group.positions[ids[2]]};
  };
  BoundedSearch search(source, margin, farthest.to_beat());
  const std::size_t step = std::clamp<std::size_t>(count / kFewestTried, 1, kTriedOf);
  std::size_t tried = 0, left = 0;
  for (std::size_t t = 0; t < count; t += step, ++tried) {
    if (!search.is_within(corners_of(t), places[t])) ++left;
  }
  if (static_cast<double>(left) <= kMostLeft * static_cast<double>(tried)) {
    for (std::size_t t = 0; t < count; ++t) search.add(corners_of(t), places[t]);
    search.run(kPartsPerTriangle * count + kPartsPerGroup);
  }
  farthest.take(search.found().distance);
  return farthest;
}

}  // namespace meshlode::builder
