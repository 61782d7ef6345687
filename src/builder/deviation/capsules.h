// SPDX-License-Identifier: GPL-3.0-or-later
// Where very many triangles meet in one vertex, each box around some of them holds that vertex, and most boxes hold
// most of the surface: whoever asks for what is nearest would look at everything. A few neighbours of such a fan are a
// long thin thing that lies across the axes. A capsule, all points within a radius of a segment, is close around it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/vec.h"
#include "builder/deviation/lanes.h"

namespace meshlode::builder {

/// From so many triangles in one vertex on, a tree has capsules beside its boxes. Meshes that are modelled or scanned
/// have none: theirs are the trees that they were.
inline constexpr std::uint32_t kHubTriangles = 256;

/// Whether so many triangles meet in one position.
[[nodiscard]] bool has_hub(std::span<const std::array<std::uint32_t, 3>> triangles, std::size_t position_count);

/// In a tree's frame. What it was made around lies inside, and the rounding of distances_to() is allowed for.
struct Capsule {
  Vec3f from{0.0F}, along{0.0F};
  float radius = -1.0F;  ///< negative: there is nothing

  [[nodiscard]] bool is_empty() const { return radius < 0.0F; }
};

/// Around the triangles of a leaf: along the mean of their longest edges.
[[nodiscard]] Capsule capsule_around(std::span<const std::array<Vec3f, 3>> triangles);
/// Around capsules: along their mean.
[[nodiscard]] Capsule capsule_around(std::span<const Capsule> capsules);

/// Those of a node's four children.
struct FourCapsules {
  std::array<std::array<float, 4>, 3> from{}, along{};  ///< [axis][child]
  std::array<float, 4> radius{};

  void set(std::size_t child, const Capsule& capsule) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      from[axis][child] = capsule.from[static_cast<int>(axis)];
      along[axis][child] = capsule.along[static_cast<int>(axis)];
    }
    radius[child] = capsule.radius;
  }
  [[nodiscard]] Capsule get(std::size_t child) const {
    return {{from[0][child], from[1][child], from[2][child]},
            {along[0][child], along[1][child], along[2][child]},
            radius[child]};
  }
};

/// Squared distances from a point to four capsules, not above the true ones. Nothing is as near as can be.
[[nodiscard]] Lanes distances2_to_capsules(const FourCapsules& four, const Vec3f& point);

}  // namespace meshlode::builder
