// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw_pair.h"
#include "base/try.h"

#include <utility>

#include "draw/raster/raster.h"
#include "draw/textures/texture_use.h"
#include "run/select/select.h"

namespace meshlode::cli {

namespace {

struct Drawn {
  draw::Image image;
  std::uint64_t triangles = 0, clusters = 0;  ///< of the cut
};

Result<Drawn> draw_one(const run::Asset& asset, const run::Camera& camera, double pixel_error,
                       std::uint64_t max_decoded, std::vector<std::string>& warnings) {
  const auto cut = run::select_bvh_within(run::tables_of(asset), camera, pixel_error,
                                          asset.max_decoded_bytes() / sizeof(run::ClusterInstance));
  if (!cut) return Error{ErrorCode::kUnsupported, "cut", "the clusters of all instances take more than --max-decoded"};
  draw::ImageBudget images(max_decoded);
  const std::vector<draw::MaterialTextures> materials = draw::read_material_textures(asset);
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset, materials, images);
  if (!masks.damage) return masks.damage.error();
  TRY_LET(visibility, draw::draw_cut(asset, *cut, camera, masks));
  const draw::TextureSet textures = draw::load_textures(asset, materials, images);
  if (!textures.damage) return textures.damage.error();
  TRY_LET(image, draw::shade_view(asset, *cut, camera, *visibility, draw::View::kShaded, textures));
  Drawn drawn{std::move(*image), 0, cut->size()};
  for (const run::ClusterInstance& entry : *cut) {
    drawn.triangles += asset.clusters()[entry.cluster.value].triangle_count();
  }
  warnings.insert(warnings.end(), masks.warnings.begin(), masks.warnings.end());
  warnings.insert(warnings.end(), textures.warnings.begin(), textures.warnings.end());
  return drawn;
}

}  // namespace

Result<app::PictureChange> draw_pair(const PairToDraw& pair, const CameraOptions& options,
                                     std::vector<std::string>& warnings) {
  TRY_LET(camera, make_camera(options, pair.before));
  TRY_LET(before, draw_one(pair.before, *camera, options.pixel_error, pair.max_decoded, warnings));
  TRY_LET(after, draw_one(pair.after, *camera, options.pixel_error, pair.max_decoded, warnings));
  app::PictureChange picture;
  picture.width = camera->width;
  picture.height = camera->height;
  picture.pixel_error = options.pixel_error;
  picture.changes = {{"clusters", static_cast<double>(before->clusters), static_cast<double>(after->clusters)},
                     {"triangles", static_cast<double>(before->triangles), static_cast<double>(after->triangles)}};
  picture.difference = app::compare_pictures(before->image.rgba, after->image.rgba);
  return picture;
}

}  // namespace meshlode::cli
