// SPDX-License-Identifier: GPL-3.0-or-later
// Prepare: a source mesh is put on its grid, welded, freed of exact duplicates and brought into a canonical order, so
// that renumbering the input changes nothing.
//
// The grid comes first, before clustering, and not last as in other builders: every later stage then works on the very
// integers that the asset stores, and borders that two groups share are equal in the file because they were never
// apart.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <meshlode/result.h>

#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Where a mesh's grid lies.
struct GridFrame {
  Vec3d origin{0.0};
  format::PositionGrid grid;
};

struct PrepareOptions {
  std::optional<GridFrame> frame;      ///< that of an asset, instead of one chosen from what is below
  bool separates_needles = true;       ///< thin triangles that the grid would flatten (separate_needles.h)
  bool locks_borders = false;          ///< PreparedMesh::is_border_locked
  std::span<const std::uint8_t> gaps;  ///< MeshGaps::codes of the source mesh; empty: it has none
  double gap_reach = 0.0;
  bool keeps_flat_normals = false;  ///< exact_normals, where the layout's are flat
  double grid_step = 0.0;           ///< object units; 0: chosen from the budgets below
  double position_error = 0.0;  ///< largest distance that the grid may move a vertex, object units; 0: the share below
  /// The same as a share of the diagonal of the bounding box; the grid gets finer where edges are short.
  double position_budget = 2.5e-5;
};

/// Position of the grid for a mesh whose bounding box has the given half extent, diagonal and median edge length.
/// Errors: kUnsupported where the step or the position error asked for needs more than 24 bits.
[[nodiscard]] Result<format::PositionGrid> choose_grid(double largest_half_extent, double diagonal, double median_edge,
                                                       const PrepareOptions& options);

/// The grid that prepare_mesh() will choose, and what it is chosen for.
struct GridPlan {
  format::PositionGrid grid;
  double largest_side = 0.0;  ///< of the bounding box of what is drawn, object units; 0: nothing is
  double median_edge = 0.0;   ///< median_edge_length(), object units
};

/// Errors: those of prepare_mesh().
[[nodiscard]] Result<GridPlan> plan_grid(const scene::SourceMesh& mesh, const PrepareOptions& options);

/// Errors: kUnsupported (the grid needs more than 24 bits, or its step leaves the range of floats; the extent is more
/// than culling spheres hold, or too large or too small for a double to square), kInvalid (a position is not finite),
/// kCheckFailed (it reaches beyond the frame that is given).
[[nodiscard]] Result<PreparedMesh> prepare_mesh(const scene::SourceMesh& mesh, const AttributeLayout& layout,
                                                const PrepareOptions& options);

}  // namespace meshlode::builder
