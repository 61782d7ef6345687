// SPDX-License-Identifier: GPL-3.0-or-later
// Id pictures: which surface, a mesh and a material, each pixel shows. An error bounds distances; it does not say which
// of two surfaces is in front that are nearer to each other than the error. A picture of ids does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/raster.h"
#include "judge/pictures/source_picture.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::judge {

/// A value a pixel, top row first.
struct IdPicture {
  static constexpr std::uint64_t kBackground = ~std::uint64_t{0};
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint64_t> id;     ///< of the mesh and the material of what is seen, or kBackground
  std::vector<std::uint32_t> depth;  ///< as in VisibilityBuffer
  /// Level 0's own deviation of what is seen, world units. Infinite of an aggregate: where its leaves are is judged by
  /// what they cover (V208).
  std::vector<float> level0;
  std::vector<std::uint64_t> also;  ///< a second surface that may be seen there as well, or kBackground; empty: nowhere
};

/// What id a mesh and a material of the asset have, in `IdPicture::id`.
[[nodiscard]] constexpr std::uint64_t id_of(std::uint32_t mesh, std::uint32_t material) {
  return std::uint64_t{mesh} << 32 | material;
}

/// Instances of a mesh are one surface. So are all materials of a mesh that has aggregates: what stands for its leaves
/// has materials of its own.
class IdPainter {
 public:
  /// \pre `asset` outlives this
  explicit IdPainter(const run::Asset& asset);

  /// `drawn`: the picture of `cut`, by the CPU or a GPU. Errors: as CutPages::load().
  [[nodiscard]] Result<IdPicture> of_cut(std::span<const run::ClusterInstance> cut,
                                         const draw::VisibilityBuffer& drawn) const;
  /// `drawn`: draw_source().
  [[nodiscard]] IdPicture of_source(std::span<const SourceSurface> source, const draw::VisibilityBuffer& drawn) const;

 private:
  void paint(std::size_t pixel, std::uint32_t instance, std::uint32_t material, IdPicture& out) const;

  const run::Asset& asset_;
  std::vector<std::uint8_t> is_one_surface_;  ///< of each mesh
};

}  // namespace meshlode::judge
