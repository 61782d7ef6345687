// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras where none should be, pixel errors that make no sense, pictures of any size.
#include <cmath>
#include <limits>

#include "cases/shapes.h"
#include "hard_case.h"

namespace meshlode::test::hard {

namespace {

constexpr std::uint32_t kCells = 12;

HardView view(const Vec3d& eye, const Vec3d& target, double pixel_error) {
  HardView out;
  out.camera.eye = eye;
  out.camera.target = target;
  out.camera.width = 640;
  out.camera.height = 360;
  out.pixel_error = pixel_error;
  return out;
}

/// At this distance from a vertex of the surface: 0 is the vertex itself, inside of every sphere around it.
Result<Sample> near_a_vertex(double distance) {
  Sample sample = sample_of(make_lump(kCells));
  const Vec3d on = sample.scene.meshes[0].primitives[0].positions[100];
  for (const double near_distance : {1e-3, 1e-30, 1.0}) {
    sample.views.push_back(view(on * (1.0 + distance), on * 2.0, 1.0));
    sample.views.back().camera.near_distance = near_distance;
  }
  return sample;
}

Result<Sample> far_away(double distance) {
  Sample sample = sample_of(make_lump(kCells));
  for (const double pixels : {0.1, 1.0, 100.0}) {
    sample.views.push_back(view(Vec3d(0.6, -0.5, 0.62) * distance, Vec3d(0.0), pixels));
    sample.views.push_back(sample.views.back());
    sample.views.back().camera.is_orthographic = true;
    sample.views.back().camera.ortho_height = distance;
  }
  return sample;
}

Result<Sample> pixel_error(double pixels) {
  Sample sample = sample_of(make_lump(kCells));
  for (const double away : {0.0, 1.01, 3.0, 1e4}) {
    sample.views.push_back(view(Vec3d(0.0, 0.0, away), Vec3d(0.0, 0.0, -1.0), pixels));
  }
  return sample;
}

Result<Sample> opening(double radians) {
  Sample sample = sample_of(make_lump(kCells));
  sample.views.push_back(view(Vec3d(0.0, 0.5, 3.0), Vec3d(0.0), 1.0));
  sample.views.back().camera.fovy = radians;
  return sample;
}

Result<Sample> picture(double width) {
  Sample sample = sample_of(make_lump(kCells));
  sample.draws_pictures = true;
  const auto pixels = static_cast<std::uint32_t>(width);
  for (const std::uint32_t height : {1U, 3U, pixels}) {
    sample.views.push_back(view(Vec3d(0.5, 0.5, 3.0), Vec3d(0.0), 2.0));
    sample.views.back().camera.width = pixels;
    sample.views.back().camera.height = height;
  }
  return sample;
}

}  // namespace

std::vector<HardCase> view_cases() {
  return {
      {.room = "views",
       .name = "near",
       .parameter = "distance to a vertex of the surface",
       .sweep = {1.0, 1e-3, 1e-9, 1e-300, 0.0},
       .is_quick = true,
       .make = near_a_vertex},
      {.room = "views",
       .name = "far",
       .parameter = "distance of the eye",
       .sweep = {1e1, 1e4, 1e8, 1e20, 1e150, 1e300},
       .is_quick = false,
       .make = far_away},
      {.room = "views",
       .name = "fine-pixels",
       .parameter = "allowed pixels",
       .sweep = {1.0, 1e-3, 1e-30, 1e-300, 0.0, -1.0},
       .is_quick = true,
       .make = pixel_error},
      {.room = "views",
       .name = "coarse-pixels",
       .parameter = "allowed pixels",
       .sweep = {1.0, 1e3, 1e30, 1e300, std::numeric_limits<double>::infinity()},
       .is_quick = false,
       .make = pixel_error},
      {.room = "views",
       .name = "opening",
       .parameter = "opening angle, radians",
       .sweep = {1.0, 1e-3, 1e-9, 1e-100},
       .is_quick = false,
       .make = opening},
      {.room = "views",
       .name = "picture",
       .parameter = "width of a picture, pixels",
       .sweep = {640, 333, 2, 1},
       .is_whole = true,
       .is_quick = true,
       .make = picture},
  };
}

}  // namespace meshlode::test::hard
