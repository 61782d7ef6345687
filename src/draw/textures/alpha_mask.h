// SPDX-License-Identifier: GPL-3.0-or-later
// What the alpha test of masked materials reads. It is defined by integers, so that a CPU and a GPU decide alike:
//
//   a  the 8-bit alpha of the base colour texture's nearest texel, base level (255 without a texture)
//   c  the vertex colours' alpha, interpolated and rounded to 8 bits (255 without vertex colours)
//   a sample is drawn iff a · c >= threshold, the least product whose alpha times the factor reaches the cutoff
//
// How the texel is found is draw/raster/alpha_cutoff.h's.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "draw/textures/image_budget.h"
#include "draw/textures/texture_use.h"

namespace meshlode::draw {

/// More than a · c can be: nothing is drawn.
constexpr std::uint32_t kMaskThresholdNever = 255u * 255u + 1u;

/// The alpha of one image, a byte a texel, top row first.
struct AlphaImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> texels;
};

/// One masked material.
struct AlphaMask {
  std::uint32_t threshold = 0;
  std::uint32_t image = format::kNone;     ///< of AlphaMasks::images; kNone: every texel is opaque
  std::uint32_t uv_set = 0;                ///< TEXCOORD_n
  std::array<Wrap, 2> wrap{};              ///< of u, of v
  std::array<double, 3> row_u{}, row_v{};  ///< UVs to texels: TextureUse's rows times width or height
};

struct AlphaMasks {
  std::vector<AlphaMask> masks;
  std::vector<std::uint32_t> of_material;  ///< by index in Asset::materials(): index of masks, or format::kNone
  std::vector<AlphaImage> images;
  std::vector<std::string> warnings;  ///< textures that could not be read; they count as opaque
  Status damage = Ok{};               ///< check_image() of the first image that is not what was written, if any

  /// Nothing has to be tested.
  [[nodiscard]] bool is_empty() const { return masks.empty(); }
};

/// Only images that a masked material samples are decoded, one after the other; of each its alpha is kept. One that the
/// budget has no room for counts as opaque. A mask that every sample passes (cutoff 0) is none.
/// `textures`: read_material_textures() of the asset.
[[nodiscard]] AlphaMasks load_alpha_masks(const run::Asset& asset, std::span<const MaterialTextures> textures,
                                          ImageBudget& budget);
[[nodiscard]] AlphaMasks load_alpha_masks(const run::Asset& asset, ImageBudget& budget);
[[nodiscard]] AlphaMasks load_alpha_masks(const run::Asset& asset);  ///< with a budget of kDefaultMaxDecoded

/// The least product a · c, 0 … 65025, with product / 65025 · factor >= cutoff in floats; kMaskThresholdNever where
/// there is none.
[[nodiscard]] std::uint32_t mask_threshold(float factor, float cutoff);

}  // namespace meshlode::draw
