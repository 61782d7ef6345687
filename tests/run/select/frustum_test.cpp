// SPDX-License-Identifier: GPL-3.0-or-later
// The planes of views of any length and kind, by points just inside and just outside.
#include "run/select/frustum.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "run/select/select.h"

namespace meshlode::run {
namespace {

/// The least of the planes at a point: below 0 outside.
double inside(const Frustum& frustum, const Vec3d& p) {
  double least = 1e300;
  for (const auto& [a, b, c, d] : frustum.planes) {
    if (a != 0.0 || b != 0.0 || c != 0.0 || d != 0.0) least = std::min(least, a * p.x + b * p.y + c * p.z + d);
  }
  return least;
}

TEST(Frustum, IsThatOfThePictureWhateverTheLengthOfItsAxes) {
  for (const bool is_orthographic : {false, true}) {
    for (const double length : {1e-200, 1.0, 1e200}) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          Vec3d forward(0.0), up(0.0);
          forward[axis] = sign;
          up[(axis + 1) % 3] = 1.0;
          FrustumShape shape;
          shape.eye = {3.0, -2.0, 1.0};
          shape.forward = length * forward;
          shape.up = up / length;
          shape.is_orthographic = is_orthographic;
          shape.half_height = 0.5;
          shape.aspect = 2.0;
          const Frustum frustum = make_frustum(shape);
          const Vec3d right = glm::cross(forward, up), ahead = shape.eye + forward;
          for (const double side : {-1.0, 1.0}) {
            EXPECT_GT(inside(frustum, ahead + 0.999 * side * right), 0.0);
            EXPECT_LT(inside(frustum, ahead + 1.001 * side * right), 0.0);
            EXPECT_GT(inside(frustum, ahead + 0.4995 * side * up), 0.0);
            EXPECT_LT(inside(frustum, ahead + 0.5005 * side * up), 0.0);
          }
          EXPECT_LT(inside(frustum, shape.eye - forward), 0.0) << "behind the eye";
        }
      }
    }
  }
}

TEST(Frustum, OfACameraIsWhatItsPictureShows) {
  Camera camera;
  camera.eye = {0.0, 0.0, 8.0};
  camera.target = {0.0, 0.0, 0.0};
  camera.width = 300;
  camera.height = 100;
  camera.is_orthographic = true;
  camera.ortho_height = 4.0;
  EXPECT_GT(inside(frustum_of(camera), {5.99, 1.99, 0.0}), 0.0);
  EXPECT_LT(inside(frustum_of(camera), {6.01, 0.0, 0.0}), 0.0);
  EXPECT_LT(inside(frustum_of(camera), {0.0, -2.01, 0.0}), 0.0);
  camera.is_orthographic = false;
  camera.fovy = 2.0 * std::atan(0.25);  // the same picture at the target's distance
  EXPECT_GT(inside(frustum_of(camera), {5.99, 1.99, 0.0}), 0.0);
  EXPECT_LT(inside(frustum_of(camera), {6.01, 0.0, 0.0}), 0.0);
  EXPECT_LT(inside(frustum_of(camera), {0.0, 2.01, 0.0}), 0.0);
}

/// A plane across an axis, a thousand million units away, of a length whose square is 0 or infinite.
TEST(Frustum, PlanesOfAnyLengthHoldForInstancesFarAway) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      for (const int log2 : {-700, 0, 700}) {
        Frustum frustum;
        frustum.planes[0][axis] = std::ldexp(sign, log2);
        frustum.planes[0][3] = std::ldexp(-sign * (1e9 + 3.5), log2);
        format::InstanceRecord instance{};
        for (std::size_t k = 0; k < 3; ++k) instance.transform[5 * k] = 1.0;
        instance.transform[4 * axis + 3] = 1e9 + 3.0;  // no float
        const MeshFrustum of_mesh = frustum_of_mesh(&frustum, instance, format::MeshRecord{});
        const auto crossed = [&](double along) {
          float center[3] = {0.0F, 0.0F, 0.0F};
          center[axis] = static_cast<float>(0.5 + sign * along);
          return crossed_planes(of_mesh, of_mesh.crossed, center, 0.125F);
        };
        EXPECT_EQ(crossed(0.25), 0U);
        EXPECT_EQ(crossed(0.0), 1U);
        EXPECT_EQ(crossed(-0.25), kOutside);
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::run
