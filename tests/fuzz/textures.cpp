// SPDX-License-Identifier: GPL-3.0-or-later
// Images on any bytes, and an asset's textures and masks with the budget that `render` has, made small. The first byte
// chooses: an image file, or an asset.
#include <span>
#include <vector>

#include "asset_mutator.h"
#include "draw/textures/alpha_mask.h"
#include "draw/textures/texture_set.h"
#include "harness.h"

namespace {

using namespace meshlode;

constexpr std::uint64_t kBudget = std::uint64_t{8} << 20U;

void look_at_image(std::span<const std::uint8_t> bytes) {
  const auto header = draw::read_image_header(bytes);
  if (!header) return fuzz::require(!header.error().detail.empty(), "a refusal without a reason");
  fuzz::require(header->width >= 1 && header->height >= 1, "an image without texels");
  fuzz::require(header->width <= draw::kMaxTextureSide && header->height <= draw::kMaxTextureSide,
                "an image larger than the limit");
  const std::uint64_t texels = draw::count_mip_texels(header->width, header->height);
  if (4 * texels + header->decoder_bytes > kBudget) return;
  auto image = draw::decode_image(bytes, texels);
  if (!image) return fuzz::require(!image.error().detail.empty(), "a refusal without a reason");
  fuzz::require(image->width == header->width && image->height == header->height, "the head said another size");
  fuzz::require(image->texels.size() == std::size_t{image->width} * image->height, "texels are missing");
  const draw::TextureImage texture = draw::make_texture_image(std::move(*image), bytes.size() % 2 == 0);
  fuzz::require(texture.texels.size() == texels, "levels are missing");
  draw::TextureFootprint footprint;
  footprint.right = {0.37, 0.0};
  for (const draw::Wrap wrap : {draw::Wrap::kRepeat, draw::Wrap::kMirror, draw::Wrap::kClamp}) {
    footprint.at = {footprint.at[0] - 1.3, footprint.at[1] + 2.7};
    for (const double c : draw::sample_texture(texture, wrap, draw::Wrap::kClamp, footprint)) {
      fuzz::require(c >= 0.0 && c <= 1.0 + 1e-6, "a sample outside 0 to 1");
    }
  }
}

void look_at_asset(const std::vector<std::uint8_t>& bytes) {
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset || asset->materials().size() > 1000) return;
  draw::ImageBudget budget(kBudget);
  const draw::AlphaMasks masks = draw::load_alpha_masks(*asset, budget);
  const std::uint64_t before = budget.left();
  const draw::TextureSet set = draw::load_textures(*asset, budget);
  std::uint64_t taken = 0;
  for (const draw::TextureImage& image : set.images) taken += 4 * image.texels.size();
  fuzz::require(taken == before - budget.left(), "the budget is not what textures take");
  for (const draw::AlphaMask& mask : masks.masks) {
    fuzz::require(mask.image == format::kNone || mask.image < masks.images.size(), "a mask of no image");
  }
  for (const draw::SampledMaterial& material : set.materials) {
    for (const auto* texture : {&material.base_color, &material.normal}) {
      fuzz::require(!*texture || (*texture)->image < set.images.size(), "a texture of no image");
    }
  }
}

#ifdef MESHLODE_FUZZ
/// Checksums of a PNG's chunks made true, as far as they can be found.
void seal_png(std::span<std::uint8_t> png) {
  const auto load = [&](std::size_t at) {
    return std::uint32_t{png[at]} << 24U | std::uint32_t{png[at + 1]} << 16U | std::uint32_t{png[at + 2]} << 8U |
           png[at + 3];
  };
  for (std::size_t at = 8; png.size() >= 12 && at <= png.size() - 12;) {
    const std::uint32_t bytes = load(at);
    if (bytes > png.size() - 12 - at) return;
    std::uint32_t crc = 0xFFFFFFFFU;
    for (std::size_t i = at + 4; i < at + 8 + bytes; ++i) {
      crc ^= png[i];
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1U ^ (0xEDB88320U & (0U - (crc & 1U)));
    }
    at += 8 + std::size_t{bytes};
    for (unsigned k = 0; k < 4; ++k) png[at + k] = static_cast<std::uint8_t>(~crc >> (24 - 8 * k));
    at += 4;
  }
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::vector<std::uint8_t> bytes(data + 1, data + size);
  if (data[0] % 2 == 0) {
    look_at_image(bytes);
  } else {
    look_at_asset(bytes);
  }
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  if (size > 0 && data[0] % 2 == 0) {
    size = LLVMFuzzerMutate(data, size, max_size);
    if (seed % 16 != 0 && size > 1) seal_png(std::span(data, size).subspan(1));
    return size;
  }
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, 1);
}
#endif
