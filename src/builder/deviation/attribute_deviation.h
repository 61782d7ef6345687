// SPDX-License-Identifier: GPL-3.0-or-later
// How far a group's attributes are from the source's: what a renderer may weigh beside the distance.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "builder/deviation/deviation.h"
#include "builder/deviation/point_distance.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Attributes of a surface, per wedge as the layout says; triangles parallel to the surface's triangles.
struct SurfaceAttributes {
  std::span<const float> wedge_attributes;
  std::span<const WedgeTriangle> triangles;  ///< of wedges
  /// Per wedge: the chart of the source that it belongs to, kNoId where none is known. Empty: all are one.
  std::span<const std::uint32_t> wedge_chart{};

  [[nodiscard]] std::uint32_t chart_of(std::uint32_t triangle) const {
    return wedge_chart.empty() ? kNoId : wedge_chart[triangles[triangle][0]];
  }
};

/// A triangle, or a point of it, and the area that it stands for.
struct SurfacePart {
  std::uint32_t triangle = 0;
  std::uint32_t number = kNoId;  ///< the point by its number (shares_of()); kNoId: any
  double area = 0.0;
};
/// Barycentric coordinates of a point of the sequence: any run of it covers a triangle evenly (Roberts 2018, R2).
[[nodiscard]] std::array<double, 3> shares_of(std::uint32_t number);
/// Points of a group that are compared, where it has texture coordinates: with 1024, 2048 and 4096 of them the quantile
/// is off by more than a tenth in 21, 7 and 2 of FlightHelmet's 100 groups (docs/log/measuring.md).
constexpr std::uint32_t kPointsForUvs = 2048;
/// Where it has normals alone: a mean is known sooner.
constexpr std::uint32_t kPointsForNormals = 1024;
/// `count` points of equal areas of the parts, in their order; none where there is no area.
[[nodiscard]] std::vector<SurfacePart> spread_points(std::span<const SurfacePart> parts, std::uint32_t count);
/// Twice it.
[[nodiscard]] double area_of(const TriangleCorners& corners);

/// Over the group's surface, by points of equal areas. 0 for an attribute that the layout has not.
struct AttributeDeviation {
  double normal = 0.0;  ///< degrees: the angle whose chord is the root mean square of the chords
  double uv = 0.0;      ///< UV units: 95% of the surface is within it, in the set that is farthest off
};

/// Compares the group's attributes with those of the nearest point of the source that is of the same chart, or of the
/// nearest where the chart is not known. `near`: per triangle, where the source is near; or nothing.
[[nodiscard]] AttributeDeviation measure_attributes(const SourceTree& source,
                                                    const SurfaceAttributes& source_attributes,
                                                    const GroupSurface& group,
                                                    const SurfaceAttributes& group_attributes,
                                                    const AttributeLayout& layout, std::span<const TreeSlot> near = {});

/// The other way.
struct SourceDeviation {
  double uv = 0.0;
  std::vector<SurfacePart> points;  ///< of the source
  std::vector<std::uint32_t> near;  ///< per point: the group's triangle
};
/// AttributeDeviation::uv over parts of the source against the nearest point of the group that is of the same chart;
/// where the group has nothing of that chart, against the nearest point.
[[nodiscard]] SourceDeviation measure_uvs_from_source(const SourceTree& source,
                                                      const SurfaceAttributes& source_attributes,
                                                      std::span<const SurfacePart> parts, const GroupSurface& group,
                                                      const SurfaceAttributes& group_attributes,
                                                      const AttributeLayout& layout);

}  // namespace meshlode::builder
