// SPDX-License-Identifier: GPL-3.0-or-later
// How much of a picture a cut covers, against how much its source does: what an aggregate is judged by
// (docs/guides/foliage.md). Whole meshes, from directions and with a rasterizer that no builder uses.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "base/ids.h"
#include "base/vec.h"
#include "draw/textures/alpha_mask.h"
#include "run/read/asset.h"

namespace meshlode::judge {

struct CoveringTriangle {
  std::array<Vec3d, 3> corners;        ///< object units
  std::array<Vec2d, 3> uv{};           ///< of the mask
  std::uint32_t mask = format::kNone;  ///< of AlphaMasks::masks; kNone: all of it covers
};

/// Of a cut, over all pixels and directions together.
struct CoverageDrift {
  double rms = 0.0;       ///< root mean square of what pixels' coverage changes by, over that of the source's coverage
  double mean = 0.0;      ///< what the sum changes by, over the source's: 0.02 is 2% more
  double contrast = 1.0;  ///< standard deviation of pixels' coverage over the source's
  double worst_direction = 0.0;  ///< the largest change of the sum of one direction, over the source's there: a size
};

/// 37 directions of a hemisphere; pixels are squares of `pixel_size` with at least 64 samples each, every half a pixel,
/// or a quarter where that is less than 8 of them across, and with more where triangles are small against them, or few
/// samples see anything. The side that triangles are seen from does not matter. Nothing where pictures of pixels with 8
/// samples across would have more than 8,192 a side. The same for any thread count. `closer` than 1: so many times as
/// many samples where they are few, of a handful of needles, where a sum has half a percent of luck; and from 149
/// directions, for what a handful of triangles shows hangs on the direction.
[[nodiscard]] std::optional<CoverageDrift> measure_coverage(std::span<const CoveringTriangle> source,
                                                            std::span<const CoveringTriangle> cut,
                                                            const draw::AlphaMasks& masks, double pixel_size,
                                                            double closer = 1.0);

/// The triangles of clusters of a mesh. Vertex colours' alpha is not looked at. Errors: as run::load_page().
[[nodiscard]] Result<std::vector<CoveringTriangle>> covering_triangles(const run::Asset& asset,
                                                                       const draw::AlphaMasks& masks, MeshId mesh,
                                                                       std::span<const ClusterId> clusters);

/// Pixel sizes at which uniform cuts of a mesh are looked at: from its smallest aggregate error to somewhat above the
/// largest, evenly in the logarithm. Empty where it has no aggregate.
[[nodiscard]] std::vector<double> coverage_sizes(const run::Asset& asset, MeshId mesh, std::uint32_t count);

/// Whether some group of the mesh is an aggregate's.
[[nodiscard]] bool has_aggregates(const run::Asset& asset, MeshId mesh);

/// Of clusters those that an aggregate's group has or made: all of a mesh, but for assets of before parts were meshes.
[[nodiscard]] std::vector<ClusterId> clusters_of_aggregates(const run::Asset& asset,
                                                            std::span<const ClusterId> clusters);

}  // namespace meshlode::judge
