// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/texture_set.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "draw/textures/image.h"

namespace meshlode::draw {

namespace {

/// An image as base colours read it and as normals do are two.
struct Wanted {
  std::uint32_t blob = 0;
  bool is_srgb = false;
  std::uint64_t texels = 0, decoder_bytes = 0;  ///< 0 texels: not to be decoded
  std::optional<TextureImage> image;
  std::string warning;
  Status damage = Ok{};
};

/// Takes what the image will need, or says why it is not decoded.
void reserve(const run::Asset& asset, ImageBudget& budget, std::uint64_t& texture_bytes, Wanted& wanted) {
  if (wanted.damage = check_image(asset, wanted.blob); !wanted.damage) return;
  const auto refuse = [&](const std::string& why) { wanted.warning = why + ", not drawn"; };
  const std::string name = image_name(asset, wanted.blob);
  const auto header = read_image_header(asset.blob_bytes(asset.blobs()[wanted.blob]));
  if (!header) return refuse(name + ": " + header.error().message());
  const std::uint64_t texels = count_mip_texels(header->width, header->height);
  const std::uint64_t bytes = 4 * texels + header->decoder_bytes;
  if (texture_bytes + 4 * texels > kMaxTextureBytes) return refuse(name + ": more than 8 GiB of textures");
  if (!budget.take(bytes)) return refuse(budget.refusal(name, *header, bytes));
  texture_bytes += 4 * texels;
  wanted.texels = texels;
  wanted.decoder_bytes = header->decoder_bytes;
}

void load(const run::Asset& asset, Wanted& wanted) {
  if (wanted.texels == 0) return;
  auto decoded = decode_image(asset.blob_bytes(asset.blobs()[wanted.blob]), wanted.texels);
  if (decoded) {
    wanted.image = make_texture_image(std::move(*decoded), wanted.is_srgb);
  } else {
    wanted.warning = image_name(asset, wanted.blob) + ": " + decoded.error().message() + ", not drawn";
  }
}

}  // namespace

bool has_textures(std::span<const MaterialTextures> materials) {
  return std::any_of(materials.begin(), materials.end(), [](const MaterialTextures& m) {
    return (m.base_color && m.base_color->blob != format::kNone) || (m.normal && m.normal->blob != format::kNone);
  });
}

TextureSet load_textures(const run::Asset& asset) {
  ImageBudget budget;
  return load_textures(asset, budget);
}

TextureSet load_textures(const run::Asset& asset, ImageBudget& budget) {
  return load_textures(asset, read_material_textures(asset), budget);
}

TextureSet load_textures(const run::Asset& asset, std::span<const MaterialTextures> materials, ImageBudget& budget) {
  TextureSet out;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> index;  // of (blob, is sRGB)
  std::vector<Wanted> wanted;
  const auto want = [&](const std::optional<TextureUse>& use, bool is_srgb, std::size_t material) {
    std::optional<SampledTexture> sampled;
    if (!use) return sampled;
    if (use->blob == format::kNone) {
      out.warnings.push_back("material " + std::to_string(material) + ": an image is not in the asset, not drawn");
      return sampled;
    }
    const auto [found, is_new] = index.try_emplace({use->blob, is_srgb}, static_cast<std::uint32_t>(wanted.size()));
    if (is_new) wanted.push_back({use->blob, is_srgb, 0, 0, std::nullopt, {}, Ok{}});
    sampled = SampledTexture{*use, found->second};
    return sampled;
  };
  for (std::size_t i = 0; i < materials.size(); ++i) {
    SampledMaterial m;
    m.base_color = want(materials[i].base_color, true, i);
    m.normal = want(materials[i].normal, false, i);
    m.normal_scale = materials[i].normal_scale;
    out.materials.push_back(m);
  }
  std::uint64_t texture_bytes = 0;
  for (Wanted& w : wanted)
    reserve(asset, budget, texture_bytes, w);  // in order: the same images for any number of threads
  parallel_for_each_index(wanted.size(), 1, [&](std::size_t i) { load(asset, wanted[i]); });

  std::vector<std::uint32_t> image_of(wanted.size(), format::kNone);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    budget.give_back(wanted[i].decoder_bytes + (wanted[i].image ? 0 : 4 * wanted[i].texels));
    if (out.damage && !wanted[i].damage) out.damage = wanted[i].damage;
    if (!wanted[i].warning.empty()) out.warnings.push_back(wanted[i].warning);
    if (!wanted[i].image) continue;
    image_of[i] = static_cast<std::uint32_t>(out.images.size());
    out.images.push_back(std::move(*wanted[i].image));
  }
  for (SampledMaterial& m : out.materials) {
    for (std::optional<SampledTexture>* texture : {&m.base_color, &m.normal}) {
      if (!*texture) continue;
      (*texture)->image = image_of[(*texture)->image];
      if ((*texture)->image == format::kNone) texture->reset();
    }
  }
  return out;
}

}  // namespace meshlode::draw
