// SPDX-License-Identifier: GPL-3.0-or-later
// Id pictures: which surface, a mesh and a material, each pixel shows. An error bounds distances; it does not say which
// of two surfaces is in front that are nearer to each other than the error. A picture of ids does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/projection.h"
#include "draw/raster/raster.h"
#include "judge/pictures/source_picture.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::judge {

/// Top row first.
struct IdPicture {
  static constexpr std::uint64_t kBackground = ~std::uint64_t{0};
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t> id;  ///< of the mesh and the material of what is seen, or kBackground
  /// How far on screen what is seen may have moved. Infinite where it may have moved through the near plane, which
  /// opens what it cuts.
  std::vector<float> allowed_px;
};

/// Instances of a mesh are one surface. So are all materials of a mesh that has aggregates: what stands for its leaves
/// has materials of its own.
class IdPainter {
 public:
  /// Cuts are those of `pixel_error`. \pre `asset` outlives this
  IdPainter(const run::Asset& asset, const draw::Projection& projection, double pixel_error);

  /// `drawn`: the picture of `cut`, by the CPU or a GPU. Errors: as CutPages::load().
  [[nodiscard]] Result<IdPicture> of_cut(std::span<const run::ClusterInstance> cut,
                                         const draw::VisibilityBuffer& drawn) const;
  /// `drawn`: draw_source().
  [[nodiscard]] IdPicture of_source(std::span<const SourceSurface> source, const draw::VisibilityBuffer& drawn) const;

 private:
  [[nodiscard]] IdPicture blank(const draw::VisibilityBuffer& drawn) const;
  void paint(std::size_t pixel, std::uint32_t depth, std::uint32_t instance, std::uint32_t material,
             IdPicture& out) const;

  const run::Asset& asset_;
  const draw::Projection& projection_;
  double pixel_error_;
  std::vector<std::uint8_t> is_one_surface_;  ///< of each mesh
};

}  // namespace meshlode::judge
