// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/projection.h"

#include <algorithm>
#include <cmath>

namespace meshlode::draw {

namespace {

constexpr double kSmallest = 1e-100, kLargest = 1e100;

Error camera_error(const char* field, const char* detail) {
  return {ErrorCode::kUsage, std::string("camera: ") + field, detail};
}

bool is_bounded(const Vec3d& v) {
  return std::abs(v.x) <= kLargest && std::abs(v.y) <= kLargest && std::abs(v.z) <= kLargest;  // false for NaN
}

bool is_bounded_positive(double v) {
  return v >= kSmallest && v <= kLargest;
}

/// Unit vector of v, whose largest component is scaled to 1 first so that no square over- or underflows.
Vec3d unit(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const Vec3d s = v / largest;
  return s / std::sqrt(glm::dot(s, s));
}

struct Affine {
  Vec3d column[3];  ///< grid axes in world space
  Vec3d translation;
};

Affine grid_to_world(const format::MeshRecord& mesh, const format::InstanceRecord& instance) {
  const double* m = instance.transform;
  const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
  Affine out;
  for (int axis = 0; axis < 3; ++axis) out.column[axis] = Vec3d(m[axis], m[4 + axis], m[8 + axis]) * step;
  const double* o = mesh.origin;
  for (int row = 0; row < 3; ++row) {
    const double* r = m + 4 * row;
    out.translation[row] = ((r[0] * o[0] + r[1] * o[1]) + r[2] * o[2]) + r[3];
  }
  return out;
}

}  // namespace

Result<Projection> make_projection(const run::Camera& camera) {
  if (!is_bounded(camera.eye)) return camera_error("eye", "not a finite point");
  if (!is_bounded(camera.target)) return camera_error("target", "not a finite point");
  if (camera.eye == camera.target) return camera_error("target", "the same point as the eye");
  if (camera.width < 1 || camera.width > kMaxImageSide || camera.height < 1 || camera.height > kMaxImageSide) {
    return camera_error("size", "a picture has 1 to 16384 pixels a side");
  }
  if (!is_bounded_positive(camera.near_distance)) return camera_error("near", "not within 1e-100 and 1e100");
  Projection out;
  out.eye = camera.eye;
  out.forward = unit(camera.target - camera.eye);
  Vec3d side = glm::cross(out.forward, Vec3d(0.0, 1.0, 0.0));
  // Looking along y: the picture's top is -z, as on a map.
  if (glm::dot(side, side) < 1e-18) side = glm::cross(out.forward, Vec3d(0.0, 0.0, -1.0));
  out.right = unit(side);
  out.up = glm::cross(out.right, out.forward);
  out.is_orthographic = camera.is_orthographic;
  out.near_distance = camera.near_distance;
  out.size = {camera.width, camera.height};
  if (camera.is_orthographic) {
    if (!is_bounded_positive(camera.ortho_height)) return camera_error("height", "not within 1e-100 and 1e100");
    out.pixels_per_unit = camera.height / camera.ortho_height;
  } else {
    if (!(camera.fovy > 0.0 && camera.fovy < 3.141592653589793)) {
      return camera_error("fovy", "the field of view is between 0 and 180 degrees");
    }
    out.pixels_per_unit = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
    if (!is_bounded_positive(out.pixels_per_unit)) return camera_error("fovy", "too close to 0 or 180 degrees");
  }
  out.far_distance = 2.0 * out.near_distance;
  return out;
}

double scene_depth(const run::Asset& asset, const Projection& projection) {
  double depth = 2.0 * projection.near_distance;
  for (const format::InstanceRecord& instance : asset.instances()) {
    if ((instance.flags & format::kInstanceSingular) != 0) continue;
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    const Affine affine = grid_to_world(mesh, instance);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3d p = affine.translation - projection.eye;
      for (int axis = 0; axis < 3; ++axis) {
        // Simplified surfaces may leave the bounds of level 0 a little: a tenth on either side is room enough.
        const double room = 0.1 * (static_cast<double>(mesh.bounds_max[axis]) - mesh.bounds_min[axis]);
        const double q = ((corner >> axis) & 1) != 0 ? mesh.bounds_max[axis] + room : mesh.bounds_min[axis] - room;
        p += affine.column[axis] * q;
      }
      const double d = glm::dot(projection.forward, p);
      if (std::isfinite(d)) depth = std::max(depth, d);
    }
  }
  return depth;
}

GridToClip make_grid_to_clip(const Projection& projection, const format::MeshRecord& mesh,
                             const format::InstanceRecord& instance) {
  const Affine affine = grid_to_world(mesh, instance);
  const Vec3d offset = affine.translation - projection.eye;
  const auto row = [&](const Vec3d& axis, double scale) {
    return ClipRow{glm::dot(axis, affine.column[0]) * scale, glm::dot(axis, affine.column[1]) * scale,
                   glm::dot(axis, affine.column[2]) * scale, glm::dot(axis, offset) * scale};
  };
  GridToClip out;
  out.x = row(projection.right, projection.pixels_per_unit);
  out.y = row(projection.up, -projection.pixels_per_unit);
  if (projection.is_orthographic) {
    const double range = projection.far_distance - projection.near_distance;
    out.w = {0.0, 0.0, 0.0, 1.0};
    out.z = row(projection.forward, -1.0 / range);
    out.z.constant += projection.far_distance / range;
  } else {
    out.w = row(projection.forward, 1.0);
    out.z = {0.0, 0.0, 0.0, projection.near_distance};
  }
  return out;
}

Vec3d direction_to_viewer(const Projection& projection, double x, double y) {
  if (projection.is_orthographic) return -projection.forward;
  return projection.up * y - projection.right * x - projection.forward * projection.pixels_per_unit;
}

}  // namespace meshlode::draw
