// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of a cut against the source, from the same camera: how far anything moved, and what shows through.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/raster.h"
#include "judge/pictures/source_picture.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::judge {

struct PictureReport {
  std::uint64_t covered = 0;                    ///< pixels of the cut
  std::uint64_t covered_source = 0;             ///< pixels of the source's own triangles
  std::uint64_t only_cut = 0, only_source = 0;  ///< covered in one alone, cut or level 0: the silhouettes differ there
  /// Background in the cut where the source covers every pixel within `kHoleRadius` and the ray hits the cut from
  /// behind: it came in through a hole. Where it hits nothing, two parts of a mesh that hid each other's borders have
  /// moved apart, which the promise allows; so it does where the surface may have moved through the near plane, which
  /// opens what it cuts. \pre of closed meshes; a masked material is no closed surface
  std::uint64_t holes = 0;
  /// Displacement of any pixel's surface point: of the cut's picture to the source, and of the source's picture to the
  /// cut. By the asset's chosen promise: in the product space of positions and what is painted, where that is one.
  double largest_px = 0.0;
  double largest_share = 0.0;        ///< of what is allowed at its point: above the tolerance, it exceeds
  double mean_px = 0.0;              ///< over the cut's pixels
  double allowed_px = 0.0;           ///< the largest that the promise allows at that pixel's distance: see judge
  std::uint64_t exceeded = 0;        ///< pixels displaced by more than max(t, level 0's own deviation) allows
  std::uint64_t points = 0;          ///< compared, both ways
  double largest_depth = 0.0;        ///< difference over distance, where both are covered
  double mean_normal_degrees = 0.0;  ///< between shading normals (faces', where none are stored), where both cover
  double largest_normal_degrees = 0.0;
  std::uint64_t normals = 0;  ///< compared
  /// Heat maps, a value a pixel: of the cut's pixels; of those that both cover; -1 elsewhere.
  std::vector<float> displacement_px, depth_difference, normal_degrees;
};

/// Silhouettes may move by a pixel, and a pixel is one sample.
constexpr int kHoleRadius = 2;

/// What pictures of an asset are judged by.
struct PictureSource {
  std::span<const SourceSurface> meshes;         ///< the source, one a mesh of the asset, with trees
  std::span<const run::DecodedCluster> decoded;  ///< decode_all() of the asset
  double tolerance = 1.0;                        ///< of the promise, 1.05 where it is measured
  std::span<const PaintedSurface> painted{};     ///< painted_surfaces()
};

/// `cut` was drawn into `drawn`. Displacement and holes are judged by the source's own triangles, normals and
/// silhouettes by level 0, which has the same materials and masks. `masks`: those that `cut` was drawn with.
[[nodiscard]] Result<PictureReport> judge_picture(const run::Asset& asset, const PictureSource& source,
                                                  std::span<const run::ClusterInstance> cut,
                                                  const draw::VisibilityBuffer& drawn, const run::Camera& camera,
                                                  double pixel_error, const draw::AlphaMasks& masks = {});

/// Blue at 0, red at `full` and above, grey where there is nothing.
[[nodiscard]] draw::Image heat_map(std::span<const float> values, std::uint32_t width, std::uint32_t height,
                                   float full);

}  // namespace meshlode::judge
