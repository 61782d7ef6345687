// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/plan/texel_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/image_size.h"

namespace meshlode::builder {

std::vector<std::array<double, scene::kMaxUvSets>> texels_of_materials(const scene::Scene& scene) {
  std::map<std::uint32_t, std::optional<ImageSize>> sizes;  // by blob: each image is looked at once
  std::vector<std::array<double, scene::kMaxUvSets>> out;
  for (const scene::SceneMaterial& material : scene.materials) {
    std::array<double, scene::kMaxUvSets>& texels = out.emplace_back();
    for (const scene::TextureUse& use : material.textures) {
      if (use.uv_set >= scene::kMaxUvSets || use.blob >= scene.blobs.size()) continue;
      const auto [known, is_new] = sizes.try_emplace(use.blob);
      if (is_new) known->second = read_image_size(scene.blobs[use.blob].bytes);
      if (!known->second) continue;
      const double most =
          std::max(known->second->width * std::abs(use.scale[0]), known->second->height * std::abs(use.scale[1]));
      if (std::isfinite(most)) texels[use.uv_set] = std::max(texels[use.uv_set], most);
    }
  }
  return out;
}

std::vector<TexelExtents> texel_extents_of_materials(const scene::Scene& scene) {
  constexpr std::uint32_t kUnknownSide = 2048;
  std::map<std::uint32_t, std::optional<ImageSize>> sizes;
  std::vector<TexelExtents> out;
  for (const scene::SceneMaterial& material : scene.materials) {
    TexelExtents& extents = out.emplace_back();
    for (const scene::TextureUse& use : material.textures) {
      if (use.uv_set >= scene::kMaxUvSets) continue;
      std::optional<ImageSize> size;
      if (use.blob < scene.blobs.size()) {
        const auto [known, is_new] = sizes.try_emplace(use.blob);
        if (is_new) known->second = read_image_size(scene.blobs[use.blob].bytes);
        size = known->second;
      }
      const double width = (size ? size->width : kUnknownSide) * std::abs(use.scale[0]);
      const double height = (size ? size->height : kUnknownSide) * std::abs(use.scale[1]);
      if (!std::isfinite(width) || !std::isfinite(height)) continue;
      extents[use.uv_set][0] = std::max(extents[use.uv_set][0], width);
      extents[use.uv_set][1] = std::max(extents[use.uv_set][1], height);
    }
  }
  return out;
}

std::array<double, scene::kMaxUvSets> texels_per_unit(
    std::span<const std::array<double, scene::kMaxUvSets>> of_materials, const scene::SourceMesh& mesh) {
  std::array<double, scene::kMaxUvSets> out{};
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.material.value >= of_materials.size()) continue;
    for (std::size_t set = 0; set < out.size(); ++set) {
      out[set] = std::max(out[set], of_materials[primitive.material.value][set]);
    }
  }
  return out;
}

std::array<double, scene::kMaxUvSets> texels_per_unit(const scene::Scene& scene, const scene::SourceMesh& mesh) {
  return texels_per_unit(texels_of_materials(scene), mesh);
}

}  // namespace meshlode::builder
