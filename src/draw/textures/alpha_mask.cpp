// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/alpha_mask.h"

#include <algorithm>
#include <map>
#include <utility>

#include "draw/textures/image.h"

namespace meshlode::draw {

namespace {

/// Alpha of a blob's image; empty texels where all are opaque, a warning where there is none.
AlphaImage load_image(const run::Asset& asset, std::uint32_t blob, const std::string& material, ImageBudget& budget,
                      AlphaMasks& masks) {
  AlphaImage out;
  if (blob >= asset.blobs().size()) {
    masks.warnings.push_back("material " + material + ": the image of its mask is not in the asset, drawn opaque");
    return out;
  }
  const auto refuse = [&](const std::string& why) {
    masks.warnings.push_back("material " + material + ": " + why + ", drawn opaque");
    return AlphaImage{};
  };
  if (Status intact = check_image(asset, blob); !intact) {
    if (masks.damage) masks.damage = std::move(intact);
    return out;
  }
  const auto bytes = asset.blob_bytes(asset.blobs()[blob]);
  const auto header = read_image_header(bytes);
  if (!header) return refuse(header.error().message());
  const std::uint64_t texel_count = std::uint64_t{header->width} * header->height;
  const std::uint64_t passing = 4 * texel_count + header->decoder_bytes;
  if (!budget.take(passing + texel_count)) {
    return refuse(budget.refusal(image_name(asset, blob), *header, passing + texel_count));
  }
  const auto image = decode_image(bytes);
  if (image) {
    out.width = image->width;
    out.height = image->height;
    out.texels.resize(image->texels.size());
    for (std::size_t i = 0; i < out.texels.size(); ++i)
      out.texels[i] = static_cast<std::uint8_t>(image->texels[i] >> 24U);
    if (std::all_of(out.texels.begin(), out.texels.end(), [](std::uint8_t a) { return a == 255; })) out.texels = {};
  }
  budget.give_back(passing + (out.texels.empty() ? texel_count : 0));
  if (!image) return refuse(image.error().message());
  return out;
}

std::string name_of(const run::Asset& asset, std::size_t material) {
  const std::string_view name = asset.string(asset.materials()[material].name);
  return name.empty() ? std::to_string(material) : "'" + std::string(name) + "'";
}

}  // namespace

std::uint32_t mask_threshold(float factor, float cutoff) {
  const auto passes = [&](std::uint32_t product) {
    return static_cast<float>(product) / 65025.0F * std::max(factor, 0.0F) >= cutoff;
  };
  std::uint32_t low = 0, high = kMaskThresholdNever;  // what passes grows with the product
  while (low < high) {
    const std::uint32_t middle = (low + high) / 2;
    if (middle < kMaskThresholdNever && passes(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return std::min(low, kMaskThresholdNever);
}

AlphaMasks load_alpha_masks(const run::Asset& asset) {
  ImageBudget budget;
  return load_alpha_masks(asset, budget);
}

AlphaMasks load_alpha_masks(const run::Asset& asset, ImageBudget& budget) {
  return load_alpha_masks(asset, read_material_textures(asset), budget);
}

AlphaMasks load_alpha_masks(const run::Asset& asset, std::span<const MaterialTextures> textures, ImageBudget& budget) {
  AlphaMasks out;
  const auto is_masked = [](const format::MaterialRecord& m) { return m.alpha_mode == format::AlphaMode::kMask; };
  if (std::none_of(asset.materials().begin(), asset.materials().end(), is_masked)) return out;
  out.of_material.assign(asset.materials().size(), format::kNone);
  std::map<std::uint32_t, std::uint32_t> image_of_blob;
  for (std::size_t i = 0; i < asset.materials().size(); ++i) {
    const format::MaterialRecord& material = asset.materials()[i];
    if (!is_masked(material)) continue;
    AlphaMask mask;
    mask.threshold = mask_threshold(material.base_color[3], material.alpha_cutoff);
    if (mask.threshold == 0) continue;
    if (const std::optional<TextureUse>& use = textures[i].base_color) {
      const auto [found, is_new] = image_of_blob.try_emplace(use->blob, static_cast<std::uint32_t>(out.images.size()));
      if (is_new) out.images.push_back(load_image(asset, use->blob, name_of(asset, i), budget, out));
      const AlphaImage& image = out.images[found->second];
      if (!image.texels.empty()) mask.image = found->second;
      mask.uv_set = use->uv_set;
      mask.wrap = {use->wrap_u, use->wrap_v};
      for (std::size_t k = 0; k < 3; ++k) {
        mask.row_u[k] = use->row_u[k] * image.width;
        mask.row_v[k] = use->row_v[k] * image.height;
      }
    } else if (material.base_color_texture != format::kNone) {
      out.warnings.push_back("material " + name_of(asset, i) + ": its texture is not in the asset, drawn opaque");
    }
    out.of_material[i] = static_cast<std::uint32_t>(out.masks.size());
    out.masks.push_back(mask);
  }
  return out;
}

}  // namespace meshlode::draw
