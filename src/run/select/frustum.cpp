// SPDX-License-Identifier: MIT
#include "run/select/frustum.h"

#include <algorithm>
#include <cmath>

#include "run/select/select.h"

namespace meshlode::run {

Frustum make_frustum(const FrustumShape& shape) {
  // Scaled first, so that no square over- or underflows.
  const auto unit = [](const Vec3d& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0.0 ? glm::normalize(v / largest) : v;
  };
  const Vec3d forward = unit(shape.forward);
  const Vec3d right = unit(glm::cross(forward, unit(shape.up)));
  const Vec3d up = glm::cross(right, forward);
  Frustum out;
  std::size_t count = 0;
  // Inside: normal · (p - eye) + offset >= 0.
  const auto add = [&](const Vec3d& normal, double offset) {
    out.planes[count++] = {normal.x, normal.y, normal.z, offset - glm::dot(normal, shape.eye)};
  };
  for (const auto& [axis, half] :
       {std::pair{right, shape.half_height * shape.aspect}, std::pair{up, shape.half_height}}) {
    for (const double side : {-1.0, 1.0}) {
      if (shape.is_orthographic) {
        add(axis * side, half);
      } else {
        add(forward * half + axis * side, 0.0);
      }
    }
  }
  add(forward, 0.0);
  return out;
}

Frustum frustum_of(const Camera& camera) {
  FrustumShape shape;
  shape.eye = camera.eye;
  shape.forward = camera.target - camera.eye;
  // Looking along y: the picture's top is -z, as on a map.
  const Vec3d side = glm::cross(shape.forward, shape.up);
  if (glm::dot(side, side) < 1e-18 * glm::dot(shape.forward, shape.forward)) shape.up = {0.0, 0.0, -1.0};
  shape.is_orthographic = camera.is_orthographic;
  shape.half_height = camera.is_orthographic ? 0.5 * camera.ortho_height : std::tan(0.5 * camera.fovy);
  shape.aspect = static_cast<double>(camera.width) / camera.height;
  return make_frustum(shape);
}

MeshFrustum frustum_of_mesh(const Frustum* frustum, const format::InstanceRecord& instance,
                            const format::MeshRecord& mesh) {
  MeshFrustum out;
  if (frustum == nullptr) return out;
  const double* m = instance.transform;
  const double* o = mesh.origin;
  double translation[3];
  for (int i = 0; i < 3; ++i) {
    const double* row = m + 4 * i;
    translation[i] = ((row[0] * o[0] + row[1] * o[1]) + row[2] * o[2]) + row[3];
  }
  for (std::uint32_t k = 0; k < out.planes.size(); ++k) {
    auto [a, b, c, d] = frustum->planes[k];
    if (a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0) continue;
    const double largest = std::max({std::abs(a), std::abs(b), std::abs(c)});
    if (largest > 0.0 && std::isfinite(largest)) {  // a power of two is exact, and no square over- or underflows
      const int e = -std::ilogb(largest);
      a = std::ldexp(a, e), b = std::ldexp(b, e), c = std::ldexp(c, e), d = std::ldexp(d, e);
    }
    MeshFrustum::Plane& plane = out.planes[k];
    for (int i = 0; i < 3; ++i) plane.normal[i] = (a * m[i] + b * m[4 + i]) + c * m[8 + i];
    const double* n = plane.normal;
    plane.length = std::sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]) * (1.0 + 0x1p-50);  // over its own rounding
    plane.limit = -(((a * translation[0] + b * translation[1]) + c * translation[2]) + d);
    out.crossed |= 1U << k;
  }
  return out;
}

}  // namespace meshlode::run
