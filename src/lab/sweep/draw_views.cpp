// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/draw_views.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/compare/pictures.h"
#include "base/try.h"
#include "draw/gpu/render.h"
#include "draw/textures/texture_set.h"
#include "draw/textures/texture_use.h"

namespace meshlode::lab {

namespace {

using Cut = std::vector<run::ClusterInstance>;

Result<Cut> select_cut(const run::Asset& asset, const run::Camera& camera, double pixel_error) {
  auto cut = run::select_bvh_within(run::tables_of(asset), camera, pixel_error,
                                    asset.max_decoded_bytes() / sizeof(run::ClusterInstance));
  if (!cut) return Error{ErrorCode::kUnsupported, "cut", "the clusters of all instances take more than --max-decoded"};
  return std::move(*cut);
}

/// What drawing needs of an asset beside its clusters, read once.
struct Drawable {
  const run::Asset& asset;
  draw::ImageBudget images;
  std::vector<draw::MaterialTextures> materials;
  draw::AlphaMasks masks;
  draw::TextureSet textures;

  Drawable(const run::Asset& of, std::uint64_t max_decoded)
      : asset(of),
        images(max_decoded),
        materials(draw::read_material_textures(of)),
        masks(draw::load_alpha_masks(of, materials, images)),
        textures(draw::load_textures(of, materials, images)) {}

  [[nodiscard]] Result<draw::Image> shade(const Cut& cut, const run::Camera& camera) const {
    if (!masks.damage) return masks.damage.error();
    if (!textures.damage) return textures.damage.error();
    TRY_LET(visibility, draw::draw_cut(asset, cut, camera, masks));
    return draw::shade_view(asset, cut, camera, *visibility, draw::View::kShaded, textures);
  }
};

/// A pixel error of 0 lets only errors of 0 pass: the finest cut.
constexpr double kFullResolution = 0.0;

void raise(std::map<std::string, double>& figures, const char* key, double value) {
  const auto [at, is_new] = figures.try_emplace(key, value);
  if (!is_new) at->second = std::max(at->second, value);
}

Status compare_with_full(const draw::Image& image, const draw::Image& full, const FlipReference& reference,
                         const std::string& name, const WritePicture& write, PictureRow& row) {
  row.psnr = app::compare_pictures(full.rgba, image.rgba).psnr;
  const FlipPicture difference = reference.compare(image.rgba);
  const FlipPool pooled = pool(difference);
  row.flip_mean = pooled.mean;
  row.flip_median = pooled.weighted_median;
  row.flip_max = pooled.max;
  row.picture = name + ".png";
  row.heat = name + "-flip.png";
  if (const Status written = write(row.picture, image); !written) return written;
  return write(row.heat, draw::Image{image.width, image.height, heat_map(difference)});
}

}  // namespace

std::vector<View> make_views(const run::Camera& framing) {
  constexpr double kFar = 3.0;
  std::vector<View> views{{"near", framing}, {"far", framing}};
  run::Camera& far = views[1].camera;
  far.eye = far.target + kFar * (far.eye - far.target);
  return views;
}

Status draw_full(const run::Asset& baseline, ViewSet& set) {
  const Drawable drawable(baseline, set.max_decoded);
  set.full.clear();
  set.references.clear();
  for (const View& view : set.views) {
    TRY_LET(cut, select_cut(baseline, view.camera, kFullResolution));
    TRY_LET(image, drawable.shade(*cut, view.camera));
    set.references.emplace_back(image->rgba, image->width, image->height);
    set.full.push_back(std::move(*image));
  }
  return Ok{};
}

Status draw_point(const run::Asset& asset, const ViewSet& set, double pixel_error, const std::string& id,
                  const WritePicture& write, Measurement& out) {
  const Drawable drawable(asset, set.max_decoded);
  for (std::size_t v = 0; v < set.views.size(); ++v) {
    const View& view = set.views[v];
    TRY_LET(cut, select_cut(asset, view.camera, pixel_error));
    TRY_LET(image, drawable.shade(*cut, view.camera));
    PictureRow row;
    row.view = view.name;
    row.clusters = cut->size();
    for (const run::ClusterInstance& entry : *cut) {
      row.triangles += asset.clusters()[entry.cluster.value].triangle_count();
    }
    const std::string name = "pictures/" + id + "-" + view.name;
    const Status compared = compare_with_full(*image, set.full[v], set.references[v], name, write, row);
    if (!compared) return compared;
    raise(out.figures, "flip", row.flip_mean);
    raise(out.figures, "flip_median", row.flip_median);
    raise(out.figures, "flip_max", row.flip_max);
    if (row.psnr) {
      const auto [at, is_new] = out.figures.try_emplace("psnr", *row.psnr);
      if (!is_new) at->second = std::min(at->second, *row.psnr);
    }
    if (v == 0) out.figures["cut_triangles"] = static_cast<double>(row.triangles);
    out.pictures.push_back(std::move(row));
  }
  return Ok{};
}

Status time_frames(const run::Asset& asset, const ViewSet& set, double pixel_error, bool has_device, Measurement& out) {
  const run::Camera& camera = set.views[0].camera;
  const Drawable drawable(asset, set.max_decoded);
  const auto start = std::chrono::steady_clock::now();
  TRY_LET(cut, select_cut(asset, camera, pixel_error));
  TRY_LET(visibility, draw::draw_cut(asset, *cut, camera, drawable.masks));
  out.figures["frame_cpu_seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!has_device) return Ok{};
  draw::GpuRenderOptions options;
  options.pixel_error = pixel_error;
  options.frames = 4;  // the first ones fill caches and make pipelines
  draw::ImageBudget images(set.max_decoded);
  draw::GpuPicture picture;
  // A frame that a device has no room for is not a failure of the point: the figure is not there.
  if (const Status drawn = draw::render_on_gpu(asset, camera, options, images, picture); !drawn) return Ok{};
  out.figures["frame_vulkan_seconds"] = 1e-3 * picture.frame_milliseconds;
  return Ok{};
}

DeviceAnswer ask_device(const run::Asset& asset, const ViewSet& set) {
  draw::ImageBudget images(set.max_decoded);
  draw::GpuPicture picture;
  const Status drawn = draw::render_on_gpu(asset, set.views[0].camera, {}, images, picture);
  if (!drawn) return {"", drawn.error().message()};
  return {picture.device, ""};
}

}  // namespace meshlode::lab
