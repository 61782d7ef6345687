// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms of nodes that scale by nothing, mirror, flatten or shear.
#include <algorithm>
#include <cmath>

#include "cases/shapes.h"
#include "hard_case.h"

namespace meshlode::test::hard {

namespace {

HardView view_from(const Vec3d& eye, double pixel_error = 1.0) {
  HardView view;
  view.camera.eye = eye;
  view.camera.target = Vec3d(0.0);
  view.camera.width = 640;
  view.camera.height = 360;
  view.pixel_error = pixel_error;
  return view;
}

Sample with_transform(const Mat4d& transform, double reach) {
  Sample sample = sample_of(make_lump(12));
  sample.scene.instances[0].transform = transform;
  for (const double away : {0.0, 1.5, 10.0, 1000.0}) {
    sample.views.push_back(view_from(Vec3d(0.3, 0.2, 1.0) * (away * std::max(reach, 1e-300)), 1.0));
    sample.views.push_back(view_from(Vec3d(-1.0, 0.1, 0.2) * (away + 0.01), 4.0));
  }
  return sample;
}

Result<Sample> uniform(double factor) {
  Mat4d m(factor);
  m[3][3] = 1.0;
  return with_transform(m, factor);
}

Result<Sample> mirrored(double factor) {
  Mat4d m(factor);
  m[0][0] = -factor;
  m[3][3] = 1.0;
  return with_transform(m, factor);
}

Result<Sample> flattened(double factor) {
  Mat4d m(1.0);
  m[1][1] = factor;
  return with_transform(m, 1.0);
}

Result<Sample> sheared(double factor) {
  Mat4d m(1.0);
  m[1][0] = factor;  // x += factor · y
  return with_transform(m, 1.0 + factor);
}

}  // namespace

std::vector<HardCase> instance_cases() {
  return {
      {.room = "instances",
       .name = "scaled",
       .parameter = "scale of a node",
       .sweep = {1.0, 1e-6, 1e-30, 1e-100, 1e-300, 0.0},
       .is_quick = true,
       .make = uniform},
      {.room = "instances",
       .name = "scaled-up",
       .parameter = "scale of a node",
       .sweep = {1.0, 1e6, 1e30, 1e100, 1e300},
       .is_quick = false,
       .make = uniform},
      {.room = "instances",
       .name = "mirrored",
       .parameter = "scale of a node, mirrored",
       .sweep = {1.0, 1e-6, 1e6, 1e150},
       .is_quick = false,
       .make = mirrored},
      {.room = "instances",
       .name = "flattened",
       .parameter = "scale along one axis",
       .sweep = {1.0, 1e-6, 1e-15, 1e-100, 0.0},
       .is_quick = false,
       .make = flattened},
      {.room = "instances",
       .name = "sheared",
       .parameter = "shear",
       .sweep = {1.0, 1e3, 1e6, 1e9, 1e15, 1e100},
       .is_quick = false,
       .make = sheared},
  };
}

}  // namespace meshlode::test::hard
