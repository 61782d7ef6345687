// SPDX-License-Identifier: GPL-3.0-or-later
// How far a group's attributes are from the source's: what a renderer may weigh beside the distance.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "builder/deviation/deviation.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Attributes of a surface, per wedge as the layout says; triangles parallel to the surface's triangles.
struct SurfaceAttributes {
  std::span<const float> wedge_attributes;
  std::span<const WedgeTriangle> triangles;  ///< of wedges
};

constexpr std::size_t kFewTriangles = 500;

/// Over the group's surface, weighed by area. 0 for an attribute that the layout has not.
struct AttributeDeviation {
  double normal = 0.0;  ///< degrees: the angle whose chord is the root mean square of the chords
  double uv = 0.0;      ///< UV units: 95% of the surface is within it, in the set that is farthest off
};

/// Compares the group's attributes with the source's where the source is nearest: at three points of each triangle of
/// the group (Hammer, Marlowe and Stroud 1956, exact for squares of linear functions), of more than kFewTriangles at
/// one of the three. What comes of it is a mean and a quantile, which a few hundred points tell to some percent. `near`
/// is GroupDeviation::places, or nothing.
[[nodiscard]] AttributeDeviation measure_attributes(const SourceTree& source,
                                                    const SurfaceAttributes& source_attributes,
                                                    const GroupSurface& group,
                                                    const SurfaceAttributes& group_attributes,
                                                    const AttributeLayout& layout, std::span<const TreeSlot> near = {});

}  // namespace meshlode::builder
