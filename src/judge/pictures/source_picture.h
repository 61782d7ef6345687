// SPDX-License-Identifier: GPL-3.0-or-later
// The source's own triangles as a picture, from the camera that a cut is drawn from: neither encoded nor quantized.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "draw/raster/projection.h"
#include "draw/raster/raster.h"
#include "judge/metrics/product_distance.h"
#include "judge/metrics/product_scales.h"
#include "judge/metrics/triangle_tree.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// One mesh of the source, mesh space.
struct SourceSurface {
  Surface surface;
  std::vector<std::uint32_t> material;     ///< of each triangle, of the scene; empty: 0
  std::vector<std::uint8_t> double_sided;  ///< of each triangle; empty: none is
  /// Of each vertex, what alpha masks read; empty where no material of the mesh is masked.
  std::array<std::vector<Vec2f>, scene::kMaxUvSets> uvs;
  std::vector<float> alpha;
  std::optional<TriangleTree> tree;  ///< where distances are asked for, not pictures alone

  explicit SourceSurface(Surface s, bool has_tree = true) : surface(std::move(s)) {
    if (has_tree) tree.emplace(surface);
  }
};

/// Every mesh of the scene, in order.
[[nodiscard]] std::vector<SourceSurface> source_surfaces(const scene::Scene& scene, bool have_trees = true);

/// A mesh of the source with what is painted on it, in the units of the asset's chosen promise.
struct PaintedSurface {
  ProductScales scales;
  ProductSurface surface;  ///< its first triangles are those of the SourceSurface
  double rounding = 0.0;   ///< rounding_of()
};

/// Every mesh of the scene that the asset has, in order; none where positions alone are promised.
[[nodiscard]] std::vector<PaintedSurface> painted_surfaces(const run::Asset& asset, const scene::Scene& scene);

/// How a source is drawn.
struct SourceDrawing {
  draw::Sides sides = draw::Sides::kOfMaterial;
  /// Of one mesh and one of its materials alone, where they are given.
  std::optional<std::uint32_t> mesh, material;
};

/// The source drawn for each instance of the asset, as draw_cut() draws the asset. Items are instances, triangles those
/// of their mesh's surface. Meshes that `source` does not have are not drawn. `masks`: load_alpha_masks() of the asset.
[[nodiscard]] draw::VisibilityBuffer draw_source(const run::Asset& asset, std::span<const SourceSurface> source,
                                                 const draw::Projection& projection, const draw::AlphaMasks& masks = {},
                                                 const SourceDrawing& drawing = {});

/// Corner `k` of a triangle of the source as it was drawn.
[[nodiscard]] draw::ClipVertex project_source(const draw::Projection& projection,
                                              const format::InstanceRecord& instance, const Vec3d& position);

}  // namespace meshlode::judge
