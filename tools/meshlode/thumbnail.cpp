// SPDX-License-Identifier: GPL-3.0-or-later
#include "thumbnail.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "app/textures/encode.h"
#include "app/textures/shrink.h"
#include "base/try.h"
#include "camera_options.h"
#include "draw/raster/raster.h"
#include "draw/textures/texture_use.h"
#include "run/select/select.h"

namespace meshlode::cli {

namespace {

/// Samples of a pixel along each side: the rasterizer has one, and edges of a small picture need more.
constexpr std::uint32_t kSamples = 2;
/// Of FlightHelmet, dragon, spot and the scenes of data/ 90 takes 1.5 times the bytes and looks the same.
constexpr std::uint32_t kQuality = 70;

std::optional<std::vector<run::ClusterInstance>> select_pixel_cut(const run::Asset& asset, const run::Camera& camera) {
  return run::select_bvh_within(run::tables_of(asset), camera, 1.0,
                                asset.max_decoded_bytes() / sizeof(run::ClusterInstance));
}

/// Pixels that show nothing are transparent: the page has a ground of its own.
draw::DecodedImage cut_out(const draw::Image& image, const draw::VisibilityBuffer& visibility) {
  draw::DecodedImage out;
  out.width = image.width;
  out.height = image.height;
  out.texels.resize(visibility.pixel_count());
  for (std::size_t i = 0; i < out.texels.size(); ++i) {
    const std::uint8_t* const rgba = image.rgba.data() + 4 * i;
    const bool is_drawn = visibility.item[i] != draw::VisibilityBuffer::kNothing;
    out.texels[i] = std::uint32_t{rgba[0]} | std::uint32_t{rgba[1]} << 8U | std::uint32_t{rgba[2]} << 16U |
                    (is_drawn ? 0xFF000000U : 0U);
  }
  return out;
}

}  // namespace

std::optional<std::uint64_t> count_pixel_triangles(const run::Asset& asset) {
  const CameraOptions usual;
  const Result<run::Camera> camera = make_camera(usual, asset);
  if (!camera) return std::nullopt;
  const auto cut = select_pixel_cut(asset, *camera);
  if (!cut) return std::nullopt;
  std::uint64_t triangles = 0;
  for (const run::ClusterInstance& entry : *cut) triangles += asset.clusters()[entry.cluster.value].triangle_count();
  return triangles;
}

Result<Thumbnail> draw_thumbnail(const run::Asset& asset) {
  const run::Camera camera = frame_scene(asset, kSamples * kThumbnailWidth, kSamples * kThumbnailHeight);
  const auto cut = select_pixel_cut(asset, camera);
  if (!cut) return Error{ErrorCode::kUnsupported, "thumbnail", "the cut has too many clusters"};
  std::vector<draw::MaterialTextures> materials = draw::read_material_textures(asset);
  for (draw::MaterialTextures& material : materials) material.normal.reset();  // not seen so small, and as large
  draw::ImageBudget images(kThumbnailImageBytes);
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset, materials, images);
  TRY(masks.damage);
  const draw::TextureSet textures = draw::load_textures(asset, materials, images);
  TRY(textures.damage);
  TRY_LET(visibility, draw::draw_cut(asset, *cut, camera, masks));
  TRY_LET(image, draw::shade_view(asset, *cut, camera, *visibility, draw::View::kShaded, textures));
  draw::DecodedImage small =
      app::shrink(cut_out(*image, *visibility), kThumbnailWidth, kThumbnailHeight, app::TexelKind::kColor);
  Thumbnail thumbnail;
  TRY_LET(webp, app::encode_webp_file(small, kQuality));
  thumbnail.webp = std::move(*webp);
  for (const auto* warnings : {&masks.warnings, &textures.warnings}) {
    for (const std::string& warning : *warnings) thumbnail.note += (thumbnail.note.empty() ? "" : "; ") + warning;
  }
  return thumbnail;
}

}  // namespace meshlode::cli
