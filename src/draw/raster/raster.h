// SPDX-License-Identifier: GPL-3.0-or-later
// Raster: the CPU reference rasterizer. What it draws is defined by integers, so that another machine can draw the
// same:
//
//   grid integers → clip coordinates (doubles, + and * in a fixed order; projection.h)
//   → 1/256 pixel and 32-bit depth (quantized once per vertex, then exact integer division; screen.h)
//   → coverage by int64 edge functions with the top-left rule, depth by exact integer interpolation (coverage.h)
//   → the alpha test of masked materials, its texel found by integers too (alpha_test.h)
//   → a visibility buffer: the nearest triangle of each pixel, ties broken by (item of the cut, triangle).
//
// Back faces are culled unless the material is double sided; a mirrored instance flips the sense. Blended materials are
// drawn as opaque. There is no antialiasing: one sample in the middle of a pixel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/textures/alpha_mask.h"
#include "draw/textures/texture_set.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::draw {

enum class View : std::uint8_t {
  kShaded,     ///< base colour, normals, one directional light from the camera's upper left, ambient
  kClusters,   ///< a colour per cluster
  kTriangles,  ///< a colour per triangle
  kLevels,     ///< a ramp from fine (blue) to coarse (red) with a legend
};

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 bytes a pixel, top row first
};

/// What is seen in each pixel, top row first. The same bits for every number of threads.
struct VisibilityBuffer {
  static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;
  std::uint32_t width = 0, height = 0;
  /// Larger is nearer. Perspective: 2^32 · near / distance along the view. Orthographic: linear from the near distance
  /// (2^32 - 1) to the far end of the scene (0).
  std::vector<std::uint32_t> depth;
  std::vector<std::uint32_t> item;      ///< index into the cut, or kNothing
  std::vector<std::uint32_t> triangle;  ///< of the item's cluster

  [[nodiscard]] std::size_t pixel_count() const { return depth.size(); }
  bool operator==(const VisibilityBuffer&) const = default;
};

/// An empty buffer of this size.
[[nodiscard]] VisibilityBuffer make_visibility_buffer(std::uint32_t width, std::uint32_t height);

/// Which sides of a triangle are drawn.
enum class Sides : std::uint8_t { kOfMaterial, kBoth };

/// Draws the given cut; the order of its entries decides between equal depths, so pass it as selection returns it.
/// `masks`: load_alpha_masks() of the asset; without them masked materials are drawn as opaque.
/// Errors: kUsage for a camera that is not finite, has no direction, or is out of range (size 1 … 16384, near distance
/// 1e-100 … 1e100) and for ids that the asset does not have; kInvalid for a broken page.
[[nodiscard]] Result<VisibilityBuffer> draw_cut(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                                const run::Camera& camera, const AlphaMasks& masks = {},
                                                Sides sides = Sides::kOfMaterial);

/// Colours what draw_cut() found. `textures`: load_textures() of the asset, for kShaded; without, base colours are
/// factors and vertex colours alone. \pre `visibility` was drawn from the same asset, cut and camera
[[nodiscard]] Result<Image> shade_view(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                       const run::Camera& camera, const VisibilityBuffer& visibility, View view,
                                       const TextureSet& textures = {});

/// draw_cut() and shade_view().
[[nodiscard]] Result<Image> render_cut(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                       const run::Camera& camera, View view, const AlphaMasks& masks = {});

/// The same bytes for the same image everywhere; without alpha where all of it is opaque.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace meshlode::draw
