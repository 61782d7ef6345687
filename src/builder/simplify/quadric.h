// SPDX-License-Identifier: GPL-3.0-or-later
// Quadrics: sums of squared distances to planes, and of squared attribute errors, as functions of a vertex position.
// Garland and Heckbert 1997 (planes); Hoppe 1999 (attributes as linear functions of the position, one independent value
// per wedge, eliminated in closed form).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "base/vec.h"

namespace meshlode::builder {

/// How small a pivot may be, against the largest diagonal entry, before a minimum is not to be trusted.
template <class Real>
inline constexpr Real kSmallestPivot = std::is_same_v<Real, double> ? Real(1e-12) : Real(1e-3);

/// E(p) = pᵀ A p + 2 bᵀ p + c, with the total weight beside it so that E / weight is a mean squared distance.
template <class Real>
struct BasicQuadric {
  using Vec = glm::vec<3, Real>;

  Real a00 = 0, a01 = 0, a02 = 0, a11 = 0, a12 = 0, a22 = 0;
  Real b0 = 0, b1 = 0, b2 = 0;
  Real c = 0;
  Real weight = 0;

  BasicQuadric& operator+=(const BasicQuadric& q) {
    a00 += q.a00;
    a01 += q.a01;
    a02 += q.a02;
    a11 += q.a11;
    a12 += q.a12;
    a22 += q.a22;
    b0 += q.b0;
    b1 += q.b1;
    b2 += q.b2;
    c += q.c;
    weight += q.weight;
    return *this;
  }

  /// Adds w · (n·p + d)².
  void add_plane(const Vec& n, Real d, Real w) {
    a00 += w * n.x * n.x;
    a01 += w * n.x * n.y;
    a02 += w * n.x * n.z;
    a11 += w * n.y * n.y;
    a12 += w * n.y * n.z;
    a22 += w * n.z * n.z;
    b0 += w * n.x * d;
    b1 += w * n.y * d;
    b2 += w * n.z * d;
    c += w * d * d;
    weight += w;
  }

  /// Adds s · q, weight untouched.
  void add_scaled(const BasicQuadric& q, Real s) {
    a00 += s * q.a00;
    a01 += s * q.a01;
    a02 += s * q.a02;
    a11 += s * q.a11;
    a12 += s * q.a12;
    a22 += s * q.a22;
    b0 += s * q.b0;
    b1 += s * q.b1;
    b2 += s * q.b2;
    c += s * q.c;
  }

  /// Adds w · |p - q|².
  void add_point(const Vec& q, Real w) {
    a00 += w;
    a11 += w;
    a22 += w;
    b0 -= w * q.x;
    b1 -= w * q.y;
    b2 -= w * q.z;
    c += w * glm::dot(q, q);
  }

  /// Never below zero: rounding may not make a perfect fit better than perfect.
  [[nodiscard]] Real evaluate(const Vec& p) const {
    const Real rx = a00 * p.x + a01 * p.y + a02 * p.z;
    const Real ry = a01 * p.x + a11 * p.y + a12 * p.z;
    const Real rz = a02 * p.x + a12 * p.y + a22 * p.z;
    const Real e = p.x * rx + p.y * ry + p.z * rz + Real(2) * (b0 * p.x + b1 * p.y + b2 * p.z) + c;
    return e > Real(0) ? e : Real(0);
  }

  /// Minimum by Cholesky. False where the system is too ill-conditioned to be trusted: a pivot has lost so many digits
  /// against the largest diagonal entry that it is at most `smallest_pivot` of it.
  [[nodiscard]] bool minimize(Vec& p, Real smallest_pivot = kSmallestPivot<Real>) const {
    const Real scale = std::max(a00, std::max(a11, a22));
    const Real smallest = smallest_pivot * scale;
    if (!(scale > Real(0)) || !(a00 > smallest)) return false;
    const Real l10 = a01 / a00;
    const Real l20 = a02 / a00;
    const Real d1 = a11 - l10 * a01;
    if (!(d1 > smallest)) return false;
    const Real e21 = a12 - l10 * a02;
    const Real l21 = e21 / d1;
    const Real d2 = a22 - l20 * a02 - l21 * e21;
    if (!(d2 > smallest)) return false;
    const Real y0 = -b0;
    const Real y1 = -b1 - l10 * y0;
    const Real y2 = -b2 - l20 * y0 - l21 * y1;
    p.z = y2 / d2;
    p.y = y1 / d1 - l21 * p.z;
    p.x = y0 / a00 - l10 * p.y - l20 * p.z;
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
};

using Quadric = BasicQuadric<double>;

/// Attribute error of one wedge: Σ_faces w · Σ_j (g_j·p + d_j - s_j)² for the wedge's values s. `base` holds the part
/// without s, `gradient` Σ w g_j and `offset` Σ w d_j; base.weight is Σ w. Capacity is the largest attribute count.
template <class Real, std::size_t Capacity>
struct WedgeQuadric {
  using Vec = glm::vec<3, Real>;

  BasicQuadric<Real> base;
  std::array<Vec, Capacity> gradient{};
  std::array<Real, Capacity> offset{};

  void add(const WedgeQuadric& q, std::size_t attribute_count) {
    base += q.base;
    for (std::size_t j = 0; j < attribute_count; ++j) {
      gradient[j] += q.gradient[j];
      offset[j] += q.offset[j];
    }
  }

  /// The sum of two, without a copy of either.
  [[nodiscard]] static WedgeQuadric sum(const WedgeQuadric& p, const WedgeQuadric& q, std::size_t attribute_count) {
    WedgeQuadric out;
    out.base = p.base;
    out.base += q.base;
    for (std::size_t j = 0; j < attribute_count; ++j) {
      out.gradient[j] = p.gradient[j] + q.gradient[j];
      out.offset[j] = p.offset[j] + q.offset[j];
    }
    return out;
  }

  /// Adds a face of weight w on which attribute j is g·p + d.
  void add_face(std::size_t j, const Vec& g, Real d, Real w) {
    base.add_plane(g, d, w);
    base.weight -= w;  // counted once per face, by the caller
    gradient[j] += g * w;
    offset[j] += d * w;
  }

  /// The best value of attribute j at p. \pre base.weight > 0
  [[nodiscard]] Real best(std::size_t j, const Vec& p) const {
    return (glm::dot(gradient[j], p) + offset[j]) / base.weight;
  }

  /// Adds to q the error with the best values put in: a quadric of the position alone.
  void add_reduced_to(BasicQuadric<Real>& q, std::size_t attribute_count) const {
    if (!(base.weight > Real(0))) return;
    q.add_scaled(base, Real(1));
    const Real inverse = Real(-1) / base.weight;
    for (std::size_t j = 0; j < attribute_count; ++j) {
      const Vec& g = gradient[j];
      const Real d = offset[j];
      q.a00 += inverse * g.x * g.x;
      q.a01 += inverse * g.x * g.y;
      q.a02 += inverse * g.x * g.z;
      q.a11 += inverse * g.y * g.y;
      q.a12 += inverse * g.y * g.z;
      q.a22 += inverse * g.z * g.z;
      q.b0 += inverse * g.x * d;
      q.b1 += inverse * g.y * d;
      q.b2 += inverse * g.z * d;
      q.c += inverse * d * d;
    }
  }

  /// The error for given values at p.
  [[nodiscard]] Real evaluate(const Vec& p, const double* values, std::size_t attribute_count) const {
    Real e = base.evaluate(p);
    for (std::size_t j = 0; j < attribute_count; ++j) {
      const auto value = static_cast<Real>(values[j]);
      e += value * (base.weight * value - Real(2) * (glm::dot(gradient[j], p) + offset[j]));
    }
    return e > Real(0) ? e : Real(0);
  }
};

}  // namespace meshlode::builder
