// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/gpu_camera.h"

#include "base/try.h"
#include "draw/raster/projection.h"

namespace meshlode::draw {

namespace {

void put(double (&out)[3], const Vec3d& v) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

}  // namespace

Result<GpuCamera> make_gpu_camera(const run::Camera& camera, double pixel_error, double scene_depth) {
  TRY_LET(projection, make_projection(camera));
  GpuCamera out{};
  put(out.eye, projection->eye);
  put(out.right, projection->right);
  put(out.up, projection->up);
  put(out.forward, projection->forward);
  out.pixels_per_unit = projection->pixels_per_unit;
  out.near_distance = projection->near_distance;
  out.any_error_fails = pixel_error > 0.0 ? 0 : 1;
  out.pixels_per_error = pixel_error > 0.0 ? projection->pixels_per_unit / pixel_error : 0.0;
  out.is_orthographic = camera.is_orthographic ? 1 : 0;
  if (camera.is_orthographic) {
    const double range = scene_depth - projection->near_distance;
    out.minus_inverse_range = -1.0 / range;
    out.far_over_range = scene_depth / range;
  }
  return out;
}

Result<double> depth_of_scene(const run::Asset& asset, const run::Camera& camera) {
  if (!camera.is_orthographic) return 0.0;
  TRY_LET(projection, make_projection(camera));
  return scene_depth(asset, *projection);
}

}  // namespace meshlode::draw
