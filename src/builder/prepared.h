// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as the build works on it: on its grid, welded by position, attributes apart in wedges, in canonical order.
//
// A *position* is a point of the grid that at least one triangle uses. A *wedge* is a position with one set of
// attributes: a vertex with a seam through it has one position and several wedges. (Hoppe 1996.)
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "format/grid.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Which attributes a wedge carries and where they lie in its floats: normal xyz, then uv sets, then colour rgba.
struct AttributeLayout {
  bool has_normal = false;
  bool flat_normal = false;  ///< normals are the triangles' own: has_normal is false
  std::uint32_t uv_set_count = 0;
  std::array<std::uint8_t, scene::kMaxUvSets> uv_set_source{};  ///< TEXCOORD_n of stored set k
  bool has_color = false;

  [[nodiscard]] std::uint32_t uv_offset() const { return has_normal ? 3U : 0U; }
  [[nodiscard]] std::uint32_t color_offset() const { return uv_offset() + 2U * uv_set_count; }
  [[nodiscard]] std::uint32_t stride() const { return color_offset() + (has_color ? 4U : 0U); }
};

// What a grid's step may be: below, decoded positions would be denormal floats, above they would overflow.
constexpr int kMinGridLog2 = -126, kMaxGridLog2 = 104;

using WedgeTriangle = std::array<std::uint32_t, 3>;

struct PreparedMesh {
  std::string name;
  Vec3d origin{0.0};
  format::PositionGrid grid;
  double diagonal = 0.0;          ///< of the source's bounding box, object units
  double level0_deviation = 0.0;  ///< largest distance a vertex moved onto the grid, object units
  AttributeLayout layout;
  std::vector<Vec3i> positions;                  ///< distinct
  std::vector<std::uint8_t> is_border_locked;    ///< per position: every cut has it. Empty: none
  std::vector<std::uint32_t> wedge_position;     ///< per wedge, into positions
  std::vector<float> wedge_attributes;           ///< per wedge, layout.stride() floats
  std::vector<WedgeTriangle> triangles;          ///< wedge ids
  std::vector<std::uint32_t> triangle_material;  ///< MaterialId value per triangle, and its gap (gap_label.h)
  double gap_reach = 0.0;                        ///< of the gaps, object units; 0: there are none
  /// The same triangles before the grid: what deviations are measured against. Relative to the origin, object units.
  std::vector<Vec3d> exact_positions;
  std::vector<Vec3i> exact_on_grid;                           ///< where the grid put each of them
  std::vector<std::array<std::uint32_t, 3>> exact_triangles;  ///< as long as triangles, corner by corner
  /// Of the exact triangles, worked out before the origin was taken away, where a thin one would lose its area; 0: it
  /// has none. Empty where nobody asks.
  std::vector<Vec3d> exact_normals;
  std::uint64_t source_triangles = 0;
  std::uint64_t source_vertices = 0;
  /// Without area and no part of the source (docs/reference/format.md, "The source"). A triangle without area that lies
  /// along edges of others stays: its border is not zero, so that taking it away would open a crack (I6).
  std::uint64_t dropped_degenerate = 0;
  std::uint64_t dropped_duplicate = 0;  ///< same positions, winding, wedges and material as an earlier triangle
  std::uint64_t dropped_repaired = 0;
  std::uint64_t piece_count = 0;     ///< parts of the surface that share no position with each other
  std::uint64_t grid_collapsed = 0;  ///< kept triangles that lost their area on the grid
};

}  // namespace meshlode::builder
