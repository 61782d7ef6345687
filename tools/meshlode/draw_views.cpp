// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw_views.h"

#include <utility>

#include "base/try.h"
#include "draw/textures/texture_use.h"
#include "lab/flip/flip.h"
#include "run/select/select.h"

namespace meshlode::cli {

void add_view_options(OptionParser& parser, ViewOptions& options) {
  add_camera_options(parser, options.common, [&](const char* name, const std::string& help) {
    parser.add_values(name, options.cameras, ("may be given several times; " + help).c_str());
  });
}

Result<std::vector<run::Camera>> make_cameras(const ViewOptions& options, const run::Asset& asset) {
  std::vector<run::Camera> cameras;
  CameraOptions one = options.common;
  for (std::size_t i = 0; i == 0 || i < options.cameras.size(); ++i) {
    if (i < options.cameras.size()) one.camera = options.cameras[i];
    TRY_LET(camera, make_camera(one, asset));
    cameras.push_back(*camera);
  }
  return cameras;
}

Result<std::vector<DrawnView>> draw_views(const run::Asset& asset, const std::vector<run::Camera>& cameras,
                                          const ViewOptions& options, std::vector<std::string>& warnings) {
  draw::ImageBudget images(options.max_decoded);
  const std::vector<draw::MaterialTextures> materials = draw::read_material_textures(asset);
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset, materials, images);
  TRY(masks.damage);
  const draw::TextureSet textures = draw::load_textures(asset, materials, images);
  TRY(textures.damage);
  warnings.insert(warnings.end(), masks.warnings.begin(), masks.warnings.end());
  warnings.insert(warnings.end(), textures.warnings.begin(), textures.warnings.end());
  std::vector<DrawnView> views;
  for (const run::Camera& camera : cameras) {
    const auto cut = run::select_bvh_within(run::tables_of(asset), camera, options.common.pixel_error,
                                            asset.max_decoded_bytes() / sizeof(run::ClusterInstance));
    if (!cut)
      return Error{ErrorCode::kUnsupported, "cut", "the clusters of all instances take more than --max-decoded"};
    TRY_LET(visibility, draw::draw_cut(asset, *cut, camera, masks));
    TRY_LET(image, draw::shade_view(asset, *cut, camera, *visibility, draw::View::kShaded, textures));
    DrawnView& view = views.emplace_back(DrawnView{std::move(*image), 0, cut->size()});
    for (const run::ClusterInstance& entry : *cut) {
      view.triangles += asset.clusters()[entry.cluster.value].triangle_count();
    }
  }
  return views;
}

ComparedPicture compare_images(const draw::Image& before, const draw::Image& after) {
  ComparedPicture out;
  out.change.width = before.width;
  out.change.height = before.height;
  out.change.difference = app::compare_pictures(before.rgba, after.rgba);
  if (out.change.difference.differing_pixels == 0) return out;  // FLIP is 0 everywhere
  const lab::FlipPicture flip = lab::flip(before.rgba, after.rgba, before.width, before.height);
  const lab::FlipPool pool = lab::pool(flip);
  out.change.flip = {pool.mean, pool.weighted_median, pool.max};
  out.heat = {before.width, before.height, lab::heat_map(flip)};
  return out;
}

}  // namespace meshlode::cli
