// SPDX-License-Identifier: MIT
// The view volume as planes, taken into the space of one instance: which spheres lie outside, and so need not be drawn
// or loaded.
#pragma once

#include <array>
#include <cstdint>

#include <meshlode/format.h>

#include "base/vec.h"

namespace meshlode::run {

struct Camera;

/// World space: a point p is inside where a·p.x + b·p.y + c·p.z + d >= 0 for all planes (a, b, c, d), of any length. A
/// plane of zeros has everything inside.
struct Frustum {
  std::array<std::array<double, 4>, 6> planes{};
};

/// What shapes a frustum beside the eye; `forward` and `up` of any length, not parallel.
struct FrustumShape {
  Vec3d eye{0.0}, forward{0.0, 0.0, -1.0}, up{0.0, 1.0, 0.0};
  bool is_orthographic = false;
  double half_height = 0.41421356237309503;  ///< perspective: at distance 1, tan(fovy / 2)
  double aspect = 1.0;                       ///< width over height
};
/// Four sides and the plane through the eye. Nothing is cut off far away.
[[nodiscard]] Frustum make_frustum(const FrustumShape& shape);
/// Of the picture of a camera, by its target, width and height.
[[nodiscard]] Frustum frustum_of(const Camera& camera);

/// The planes in mesh space relative to MeshRecord::origin. A sphere test is exact for sheared and mirrored instances.
struct MeshFrustum {
  struct Plane {
    double normal[3];
    double length;  ///< at least that of the normal
    double limit;   ///< inside: normal · p >= limit
  };
  std::array<Plane, 6> planes{};
  std::uint32_t crossed = 0;  ///< bit k: plane k is to be tested
};
constexpr std::uint32_t kOutside = 0x80000000U;

/// \param frustum  null: everything is inside
[[nodiscard]] MeshFrustum frustum_of_mesh(const Frustum* frustum, const format::InstanceRecord& instance,
                                          const format::MeshRecord& mesh);

/// Of the planes in `crossed` those that the sphere lies on both sides of; kOutside if it is outside one. What lies
/// inside the sphere needs no other planes. The sums of two nested spheres are compared with the same limit, so that
/// the margins of nesting.h, far above the rounding of doubles, keep the answers nested too.
[[nodiscard]] inline std::uint32_t crossed_planes(const MeshFrustum& frustum, std::uint32_t crossed,
                                                  const float center[3], float radius) {
  std::uint32_t left = crossed;
  for (std::uint32_t k = 0; k < frustum.planes.size(); ++k) {
    if ((crossed >> k & 1U) == 0) continue;
    const MeshFrustum::Plane& plane = frustum.planes[k];
    const double at = (plane.normal[0] * double{center[0]} + plane.normal[1] * double{center[1]}) +
                      plane.normal[2] * double{center[2]};
    const double reach = plane.length * double{radius};
    if (at + reach < plane.limit) return kOutside;
    if (at - reach >= plane.limit) left &= ~(1U << k);
  }
  return left;
}

}  // namespace meshlode::run
