// SPDX-License-Identifier: GPL-3.0-or-later
// The source with what is painted on it, kept for the measuring of promises while the DAG takes the mesh apart, and the
// units that make texture coordinates and normals lengths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "builder/plan/texel_sizes.h"
#include "builder/prepared.h"
#include "builder/promise/painted_units.h"
#include "scene/scene.h"

namespace meshlode::builder {

struct PaintedSource {
  AttributeLayout layout;
  std::vector<Vec3d> positions;                         ///< before the grid, relative to the origin
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of positions
  std::vector<WedgeTriangle> wedges;                    ///< the same triangles, of attributes
  std::vector<float> attributes;                        ///< per wedge, layout.stride() floats
  std::vector<Vec3d> flat_normals;    ///< PreparedMesh::exact_normals, where the layout's normals are flat
  std::vector<Vec3i> on_grid;         ///< per wedge, where the grid has its position; empty where nobody asks
  format::PromiseMeshRecord units{};  ///< promises and level0_… are not set
};

/// U and V of each stored UV set, object units of a UV unit; 0 0: it is no part.
using UvUnits = std::array<std::array<double, 2>, scene::kMaxUvSets>;

/// `extents`: of each of the scene's materials; 0 0 where no texture of it samples a set. Units
/// (docs/reference/selection.md):
///   U = s · W, V = s · H with the largest extents of the mesh's materials, s = √(area of the surface that samples the
///       set / the texels that it samples)
/// A set that nothing samples, or that covers no texel, is no part. Of the source as it came: about an origin, what is
/// thinner than the last bits of doubles would have no area. \pre indices are in range, and UVs as many as positions
[[nodiscard]] UvUnits uv_units_of(const scene::SourceMesh& mesh, const AttributeLayout& layout,
                                  std::span<const TexelExtents> extents);

/// With N = diagonal / 8. Takes the mesh's exact_normals. `keeps_grid`: what proving asks for, not measuring. \pre
/// where normals are wanted and flat, the mesh has exact_normals
[[nodiscard]] PaintedSource keep_painted_source(PreparedMesh& mesh, const UvUnits& uv_units, bool has_normals,
                                                bool keeps_grid);

/// What the simplifier is to weigh by its largest distance. Where texels alone are promised, normals count a little all
/// the same: else shading would pay for what the texture gains.
[[nodiscard]] PaintedUnits units_to_simplify_by(const PaintedSource& painted, double diagonal);

}  // namespace meshlode::builder
