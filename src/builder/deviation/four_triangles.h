// SPDX-License-Identifier: GPL-3.0-or-later
// Squared distances from a point to four triangles at once, in floats: over the inside of a triangle its plane answers,
// elsewhere its nearest edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/vec.h"
#include "builder/deviation/lanes.h"

namespace meshlode::builder {

/// [axis][triangle]: a corner of each, and the edges from there to the two others.
struct FourTriangles {
  std::array<std::array<float, 4>, 3> a, ab, ac;

  void set(std::size_t k, const Vec3f& corner, const Vec3f& to_b, const Vec3f& to_c) {
    for (int axis = 0; axis < 3; ++axis) {
      a[static_cast<std::size_t>(axis)][k] = corner[axis];
      ab[static_cast<std::size_t>(axis)][k] = to_b[axis];
      ac[static_cast<std::size_t>(axis)][k] = to_c[axis];
    }
  }
};

/// What of the distances does not depend on the point: worked out once where the four are asked often.
struct FourTriangleTerms {
  std::array<std::array<float, 4>, 3> normal;   ///< [axis][triangle]
  std::array<float, 4> normal2, ab2, ac2, bc2;  ///< squared lengths, by triangle
  std::array<std::int32_t, 4> is_sound;         ///< all bits: the normal is trusted
};

/// Below this sine a triangle's normal is not trusted in floats: its edges answer for it.
inline constexpr float kNeedleSine = 1e-4F;

struct Vec3Lanes {
  Lanes x, y, z;
};

inline Vec3Lanes load3(const std::array<std::array<float, 4>, 3>& from) {
  return {load_lanes(from[0].data()), load_lanes(from[1].data()), load_lanes(from[2].data())};
}
inline Vec3Lanes operator-(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Lanes dot(const Vec3Lanes& a, const Vec3Lanes& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3Lanes cross(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Lanes segment_distance2(const Vec3Lanes& pa, const Vec3Lanes& edge, Lanes along, Lanes length2) {
  const Lanes t = min_lanes(max_lanes(along, lanes(0.0F)) / max_lanes(length2, lanes(1e-35F)), lanes(1.0F));
  const Vec3Lanes away{pa.x - edge.x * t, pa.y - edge.y * t, pa.z - edge.z * t};
  return dot(away, away);
}

[[nodiscard]] inline FourTriangleTerms terms_of(const FourTriangles& four) {
  const Vec3Lanes ab = load3(four.ab), ac = load3(four.ac);
  const Vec3Lanes bc = ac - ab;
  const Vec3Lanes n = cross(ab, ac);
  const Lanes nn = dot(n, n);
  const Lanes ab2 = dot(ab, ab), ac2 = dot(ac, ac), bc2 = dot(bc, bc);
  const Lanes longest2 = max_lanes(ab2, max_lanes(ac2, bc2));
  const LaneMask is_sound = nn > kNeedleSine * kNeedleSine * longest2 * longest2;
  FourTriangleTerms terms;
  store_lanes(n.x, terms.normal[0].data());
  store_lanes(n.y, terms.normal[1].data());
  store_lanes(n.z, terms.normal[2].data());
  store_lanes(nn, terms.normal2.data());
  store_lanes(ab2, terms.ab2.data());
  store_lanes(ac2, terms.ac2.data());
  store_lanes(bc2, terms.bc2.data());
  std::memcpy(terms.is_sound.data(), &is_sound, sizeof(is_sound));
  return terms;
}

/// Of the k-th point to the k-th triangle.
[[nodiscard]] inline Lanes distances2_to(const FourTriangles& four, const FourTriangleTerms& terms,
                                         const Vec3Lanes& p) {
  const Vec3Lanes ab = load3(four.ab), ac = load3(four.ac);
  const Vec3Lanes pa = p - load3(four.a);
  const Vec3Lanes bc = ac - ab, pb = pa - ab;
  const Vec3Lanes n = load3(terms.normal);
  const Lanes nn = load_lanes(terms.normal2.data());
  const Lanes ab2 = load_lanes(terms.ab2.data()), ac2 = load_lanes(terms.ac2.data());
  const Lanes bc2 = load_lanes(terms.bc2.data());
  LaneMask is_sound;
  std::memcpy(&is_sound, terms.is_sound.data(), sizeof(is_sound));
  const Lanes u = dot(cross(ab, pa), n), v = dot(cross(pa, ac), n), w = nn - u - v;
  const Lanes height = dot(pa, n);
  const LaneMask is_over = (u >= 0.0F) & (v >= 0.0F) & (w >= 0.0F) & is_sound;
  const Lanes by_plane = height * height / max_lanes(nn, lanes(1e-37F));
  const Lanes by_edge =
      min_lanes(segment_distance2(pa, ab, dot(pa, ab), ab2),
                min_lanes(segment_distance2(pa, ac, dot(pa, ac), ac2), segment_distance2(pb, bc, dot(pb, bc), bc2)));
  return choose(is_over, by_plane, by_edge);
}

}  // namespace meshlode::builder
