// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras and instances as the rows that take grid integers to clip coordinates.
//
// Everything that depends on camera and instance is composed once, in doubles, relative to the eye: a mesh far away
// from the world's origin keeps its features. A vertex then costs one fixed formula, ((r0·x + r1·y) + r2·z) + r3 a row.
#pragma once

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "base/vec.h"
#include "draw/raster/screen.h"
#include "run/select/select.h"

namespace meshlode::draw {

struct Projection {
  Vec3d eye{0.0}, right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0}, forward{0.0, 0.0, -1.0};  ///< orthonormal
  bool is_orthographic = false;
  double pixels_per_unit = 1.0;  ///< perspective: at distance 1
  double near_distance = 1e-3;
  double far_distance = 1.0;  ///< orthographic only: where depth is 0
  ImageSize size;
};

/// Errors: kUsage, naming the field of the camera. `far_distance` has to be chosen by the caller (see scene_depth()).
[[nodiscard]] Result<Projection> make_projection(const run::Camera& camera);

/// Largest distance along the view of any instance's bounds; at least the near distance and something more.
[[nodiscard]] double scene_depth(const run::Asset& asset, const Projection& projection);

struct ClipRow {
  double x = 0.0, y = 0.0, z = 0.0, constant = 0.0;
  [[nodiscard]] double at(double px, double py, double pz) const { return ((x * px + y * py) + z * pz) + constant; }
};

/// Grid integers of one mesh in one instance to clip coordinates.
struct GridToClip {
  ClipRow x, y, z, w;
  [[nodiscard]] ClipVertex project(const Vec3i& q) const {
    const double px = q.x, py = q.y, pz = q.z;
    return {x.at(px, py, pz), y.at(px, py, pz), z.at(px, py, pz), w.at(px, py, pz)};
  }
};
[[nodiscard]] GridToClip make_grid_to_clip(const Projection& projection, const format::MeshRecord& mesh,
                                           const format::InstanceRecord& instance);

/// Direction from a pixel's surface point to the viewer, not normalized. `x`, `y`: pixels from the picture's middle.
[[nodiscard]] Vec3d direction_to_viewer(const Projection& projection, double x, double y);

}  // namespace meshlode::draw
