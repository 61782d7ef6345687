// SPDX-License-Identifier: GPL-3.0-or-later
// The textures that colours call for: base colours and normals. Metallic, roughness, occlusion and emission are not
// drawn.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "draw/textures/image_budget.h"
#include "draw/textures/texture_image.h"
#include "draw/textures/texture_use.h"

namespace meshlode::draw {

struct SampledTexture {
  TextureUse use;
  std::uint32_t image = 0;  ///< of TextureSet::images
};

struct SampledMaterial {
  std::optional<SampledTexture> base_color, normal;
  double normal_scale = 1.0;
};

struct TextureSet {
  std::vector<SampledMaterial> materials;  ///< by index in Asset::materials(); empty: nothing is sampled
  std::vector<TextureImage> images;
  std::vector<std::string> warnings;  ///< images that could not be read: their materials have no such texture
  Status damage = Ok{};               ///< check_image() of the first image that is not what was written, if any

  [[nodiscard]] bool is_empty() const { return images.empty(); }
};

/// Decodes each image once, in the order in which materials name them: one that the budget has no room for, its mip
/// levels included, counts as not there. So do images beyond kMaxTextureBytes of texels, whatever the budget.
constexpr std::uint64_t kMaxTextureBytes = std::uint64_t{8} << 30;
/// `materials`: read_material_textures() of the asset.
[[nodiscard]] TextureSet load_textures(const run::Asset& asset, std::span<const MaterialTextures> materials,
                                       ImageBudget& budget);
[[nodiscard]] TextureSet load_textures(const run::Asset& asset, ImageBudget& budget);
[[nodiscard]] TextureSet load_textures(const run::Asset& asset);  ///< with a budget of kDefaultMaxDecoded

/// Whether load_textures() would find anything to decode.
[[nodiscard]] bool has_textures(std::span<const MaterialTextures> materials);

}  // namespace meshlode::draw
