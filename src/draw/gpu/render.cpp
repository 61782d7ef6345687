// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/render.h"

#include <algorithm>
#include <utility>

#include "base/try.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/gpu_scene.h"
#include "draw/gpu/pass_plan.h"
#include "draw/gpu/renderer.h"
#include "draw/gpu/shaders/frame.h"
#include "draw/gpu/vulkan/vulkan.h"
#include "draw/raster/legend.h"
#include "draw/textures/texture_set.h"

namespace meshlode::draw {

namespace {

void append(std::vector<std::string>& list, const std::vector<std::string>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

/// The plan of a scene, with what the view itself asks for.
Result<PassPlan> plan_view(const GpuScene& scene, const DeviceInfo& device, const run::Camera& camera,
                           const GpuRenderOptions& options) {
  const bool has_colors = options.view == VIEW_SHADED || options.view == VIEW_NORMALS;
  TRY_LET(plan, plan_passes(scene, device, camera.width, camera.height, options.force, has_colors));
  plan->options.overdraw = options.view == VIEW_OVERDRAW;
  if (options.view == VIEW_OCCLUDED) plan->options.occlusion = true;
  return plan;
}

/// From a little to the side: what a frame from here could not see, the second pass of the next one brings back.
run::Camera beside(const run::Camera& camera) {
  run::Camera out = camera;
  const Vec3d ahead = camera.target - camera.eye;
  const Vec3d side(ahead.z, 0.0, -ahead.x);
  out.eye = camera.eye + 0.1 * side;
  return out;
}

/// The frame, complete.
Status draw_frame(Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                  const GpuRenderOptions& options, const DeviceInfo& device, GpuPicture& out) {
  TRY_LET(depth, depth_of_scene(asset, camera));
  if (options.view == VIEW_OCCLUDED) {
    TRY_LET(before, renderer.draw(beside(camera), options.pixel_error, *depth));
  }
  for (std::uint32_t i = 1; i < options.frames; ++i) {
    TRY_LET(earlier, renderer.draw(camera, options.pixel_error, *depth));
  }
  TRY_LET(frame, renderer.draw(camera, options.pixel_error, *depth));
  for (const Commands::Time& time : frame->times) out.frame_milliseconds += time.milliseconds;
  if (frame->overflow == 0) return Ok{};
  return Error{ErrorCode::kUnsupported, device.name,
               "the picture is not complete: overflow of " + describe_overflow(frame->overflow)};
}

/// Views that tell of a frame's passes; the others are drawn again in order, so that equal depths resolve as on the
/// CPU.
bool is_view_of_passes(std::uint32_t view) {
  return view == VIEW_OVERDRAW || view == VIEW_PATHS || view == VIEW_OCCLUDED;
}

/// Cut, ids and colours of the frame.
Status read_picture(Renderer& renderer, const run::Asset& asset, std::uint32_t view, GpuPicture& out) {
  TRY_LET(cut, renderer.read_cut());
  out.cut = std::move(*cut);
  std::uint32_t level_count = 1;
  for (const format::MeshRecord& mesh : asset.meshes()) level_count = std::max(level_count, mesh.level_count);
  const auto resolve = [&]() -> Status {
    TRY_LET(resolved, renderer.resolve(view, level_count));
    out.image = std::move(resolved->image);
    return Ok{};
  };
  if (is_view_of_passes(view)) {
    if (const Status s = resolve(); !s) return s;
  }
  if (const Status s = renderer.redraw_in_order(); !s) return s;
  if (!is_view_of_passes(view)) {
    if (const Status s = resolve(); !s) return s;
  }
  if (view == VIEW_LEVELS) draw_level_legend(out.image, level_count);
  TRY_LET(visibility, renderer.read_pixels());
  out.visibility = std::move(*visibility);
  return Ok{};
}

}  // namespace

Status render_on_gpu(const run::Asset& asset, const run::Camera& camera, const GpuRenderOptions& options,
                     ImageBudget& images, GpuPicture& out) {
  TRY_LET(device, Device::open({.device = options.device, .validate = false}));
  TRY_LET(scene, upload_scene(*device, asset, {}, options.bounds, &images));
  append(out.warnings, scene->alpha_masks->warnings);
  TRY_LET(plan, plan_view(*scene, device->info(), camera, options));
  out.plan = describe_plan(*plan, "  ");
  out.device = device->info().name;
  if (plan->textures) {
    const TextureSet textures = load_textures(asset, scene->material_textures, images);
    append(out.warnings, textures.warnings);
    if (!textures.damage) return textures.damage;
    if (const Status s = upload_textures(*device, textures, *scene); !s) return s;
  }
  TRY_LET(renderer, Renderer::make(*device, *scene, plan->options));
  if (const Status s = draw_frame(*renderer, asset, camera, options, device->info(), out); !s) return s;
  return read_picture(*renderer, asset, options.view, out);
}

}  // namespace meshlode::draw
