// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle under one pixel: where the pixel looks at it, how that changes to the next pixels, and the textures there.
// Derivatives are those of the perspective map itself (quotient rule), not differences between pixels: they need no
// neighbour and are right at edges.
#pragma once

#include "draw/raster/legend.h"
#include "draw/raster/screen.h"
#include "draw/textures/texture_set.h"
#include "run/decode/decode.h"

namespace meshlode::draw {

struct PixelWeights {
  Vec3d at{1.0 / 3.0};          ///< of the corners, perspective-correct, not negative, of sum 1
  Vec3d right{0.0}, down{0.0};  ///< their change to the next pixel
};

/// At a picture point, pixels from the picture's middle: the solution of sum(b · (x, y, w)) ∝ (px, py, 1). Works for
/// triangles that cross the near plane too.
[[nodiscard]] PixelWeights find_pixel_weights(const ClipVertex& a, const ClipVertex& b, const ClipVertex& c, double px,
                                              double py);

/// What textures make of a pixel.
class PixelTextures {
 public:
  /// Nothing is sampled where the set or the mesh has no such texture or UVs. All have to outlive this.
  PixelTextures(const TextureSet& textures, const format::MeshRecord& mesh, const run::ClusterAttributes& attributes)
      : textures_(textures), mesh_(mesh), attributes_(attributes) {}

  /// Times the base colour's texel.
  void tint(std::uint32_t material, const std::array<std::uint8_t, 3>& triangle, const PixelWeights& weights,
            Rgb& color) const;
  /// `normal`: the interpolated one, unit, world; `right`, `down`: how the surface's point changes to the next pixels,
  /// world, any common scale. The tangents are those of the UVs' own derivatives, made perpendicular to the normal.
  [[nodiscard]] Vec3d bend(std::uint32_t material, const std::array<std::uint8_t, 3>& triangle,
                           const PixelWeights& weights, const Vec3d& normal, const Vec3d& right,
                           const Vec3d& down) const;
  [[nodiscard]] bool bends(std::uint32_t material) const;

 private:
  [[nodiscard]] std::optional<TextureFootprint> footprint(const TextureUse& use,
                                                          const std::array<std::uint8_t, 3>& triangle,
                                                          const PixelWeights& weights) const;

  const TextureSet& textures_;
  const format::MeshRecord& mesh_;
  const run::ClusterAttributes& attributes_;
};

}  // namespace meshlode::draw
