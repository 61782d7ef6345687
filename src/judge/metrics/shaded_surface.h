// SPDX-License-Identifier: GPL-3.0-or-later
// A surface with what it is shaded by: normals and UVs per vertex, of a source mesh or of a cut.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "judge/metrics/metrics.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// Vertices with other attributes are other vertices. Arrays are empty or as long as surface.positions; an entry that
/// is not finite is unknown there.
struct ShadedSurface {
  Surface surface;
  std::vector<Vec3f> normals;                             ///< of any length above 0
  std::array<std::vector<Vec2f>, scene::kMaxUvSets> uvs;  ///< by TEXCOORD_n
  std::size_t undrawn = 0;                                ///< so many of the last triangles draw nothing
};

/// Triangles with area alone, as surface_of_source. A primitive without normals is shaded flat (glTF 2.0, 3.7.2.1): its
/// triangles get vertices of their own.
[[nodiscard]] ShadedSurface shaded_surface_of_source(const scene::SourceMesh& mesh);

/// All that belongs into level 0 (drawn_triangles.h): behind these, in the same order, the triangles without area that
/// lie along edges of others, which draw nothing (`undrawn`). On the asset's grid they may.
[[nodiscard]] ShadedSurface painted_surface_of_source(const scene::SourceMesh& mesh);

/// Clusters of one mesh as decoded, in mesh space (origin included). No normals where the asset has none by option, a
/// flat normal per triangle where it says flat. UV sets lie where the source had them.
[[nodiscard]] ShadedSurface shaded_surface_of_clusters(const run::Asset& asset,
                                                       std::span<const run::DecodedCluster> decoded, MeshId mesh,
                                                       std::span<const ClusterId> clusters);

/// The same, decoded here, page by page. Errors: as run::load_page().
[[nodiscard]] Result<ShadedSurface> shaded_surface_of_clusters(const run::Asset& asset, MeshId mesh,
                                                               std::span<const ClusterId> clusters);

}  // namespace meshlode::judge
