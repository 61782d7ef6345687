// SPDX-License-Identifier: GPL-3.0-or-later
// Quadric error metrics (Garland and Heckbert 1997, 1998; wedges after Hoppe 1999): sums of squared distances to planes
// as functions of a place, and what attributes are off as functions of a place and of their values.
//
// Numbers lie in pairs, so that sums of quadrics take half as many instructions: the compiler finds no pairs by itself
// (-fno-tree-slp-vectorize). The bits are those of one operation after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "base/vec.h"

namespace meshlode::builder {

/// How small a pivot may be, against the largest diagonal entry, before a minimum is not to be trusted.
template <class Real>
inline constexpr Real kSmallestPivot = std::is_same_v<Real, double> ? Real(1e-12) : Real(1e-3);

template <class Real>
struct PairOf;
template <>
struct PairOf<double> {
  using Type = double __attribute__((vector_size(16)));
};
template <>
struct PairOf<float> {
  using Type = float __attribute__((vector_size(8)));
};

/// A linear function of the place: g·p + d.
template <class Real>
struct Linear {
  using Pair = typename PairOf<Real>::Type;

  Pair xy{}, zd{};

  Linear() = default;
  Linear(const glm::vec<3, Real>& g, Real d) : xy{g.x, g.y}, zd{g.z, d} {}

  Linear& operator+=(const Linear& f) {
    xy += f.xy;
    zd += f.zd;
    return *this;
  }
  [[nodiscard]] Linear scaled(Real s) const {
    Linear out;
    out.xy = xy * Pair{s, s};
    out.zd = zd * Pair{s, s};
    return out;
  }
  [[nodiscard]] Real at(const glm::vec<3, Real>& p) const {
    return (xy[0] * p.x + xy[1] * p.y) + (zd[0] * p.z + zd[1]);
  }
};

/// E(p) = pᵀ A p + 2 bᵀ p + c, with the total weight beside it so that E / weight is a mean squared distance.
template <class Real>
struct BasicQuadric {
  using Vec = glm::vec<3, Real>;
  using Pair = typename PairOf<Real>::Type;

  Pair a00_a01{}, a02_b0{}, a11_a12{}, b1_a22{}, b2_c{};
  Real weight = 0;

  [[nodiscard]] Real a00() const { return a00_a01[0]; }
  [[nodiscard]] Real a01() const { return a00_a01[1]; }
  [[nodiscard]] Real a02() const { return a02_b0[0]; }
  [[nodiscard]] Real a11() const { return a11_a12[0]; }
  [[nodiscard]] Real a12() const { return a11_a12[1]; }
  [[nodiscard]] Real a22() const { return b1_a22[1]; }
  [[nodiscard]] Real b0() const { return a02_b0[1]; }
  [[nodiscard]] Real b1() const { return b1_a22[0]; }
  [[nodiscard]] Real b2() const { return b2_c[0]; }
  [[nodiscard]] Real c() const { return b2_c[1]; }

  BasicQuadric& operator+=(const BasicQuadric& q) {
    a00_a01 += q.a00_a01;
    a02_b0 += q.a02_b0;
    a11_a12 += q.a11_a12;
    b1_a22 += q.b1_a22;
    b2_c += q.b2_c;
    weight += q.weight;
    return *this;
  }
  BasicQuadric& operator-=(const BasicQuadric& q) {
    a00_a01 -= q.a00_a01;
    a02_b0 -= q.a02_b0;
    a11_a12 -= q.a11_a12;
    b1_a22 -= q.b1_a22;
    b2_c -= q.b2_c;
    weight -= q.weight;
    return *this;
  }

  /// Adds s · f², weight untouched. Inlined by force: a call would store and load all ten numbers.
  [[gnu::always_inline]] void add_square(const Linear<Real>& f, Real s) {
    const Linear<Real> g = f.scaled(s);
    const Real x = g.xy[0], y = g.xy[1], z = g.zd[0], d = g.zd[1];
    a00_a01 += Pair{x, x} * f.xy;
    a02_b0 += Pair{x, x} * f.zd;
    a11_a12 += Pair{y, y} * Pair{f.xy[1], f.zd[0]};
    b1_a22 += Pair{y, z} * Pair{f.zd[1], f.zd[0]};
    b2_c += Pair{z, d} * Pair{f.zd[1], f.zd[1]};
  }

  /// Adds w · (n·p + d)².
  void add_plane(const Vec& n, Real d, Real w) {
    add_square(Linear<Real>(n, d), w);
    weight += w;
  }

  /// Adds s · q, weight untouched.
  void add_scaled(const BasicQuadric& q, Real s) {
    const Pair two{s, s};
    a00_a01 += two * q.a00_a01;
    a02_b0 += two * q.a02_b0;
    a11_a12 += two * q.a11_a12;
    b1_a22 += two * q.b1_a22;
    b2_c += two * q.b2_c;
  }

  /// Adds w · |p - q|².
  void add_point(const Vec& q, Real w) {
    a00_a01 += Pair{w, Real(0)};
    a02_b0 += Pair{Real(0), -w * q.x};
    a11_a12 += Pair{w, Real(0)};
    b1_a22 += Pair{-w * q.y, w};
    b2_c += Pair{-w * q.z, w * glm::dot(q, q)};
  }

  /// Never below zero: rounding may not make a perfect fit better than perfect.
  [[nodiscard]] Real evaluate(const Vec& p) const {
    const Real rx = a00() * p.x + a01() * p.y + a02() * p.z;
    const Real ry = a01() * p.x + a11() * p.y + a12() * p.z;
    const Real rz = a02() * p.x + a12() * p.y + a22() * p.z;
    const Real e = p.x * rx + p.y * ry + p.z * rz + Real(2) * (b0() * p.x + b1() * p.y + b2() * p.z) + c();
    return e > Real(0) ? e : Real(0);
  }

  /// Minimum by Cholesky. False where the system is too ill-conditioned to be trusted: a pivot has lost so many digits
  /// against the largest diagonal entry that it is at most `smallest_pivot` of it.
  [[nodiscard]] bool minimize(Vec& p, Real smallest_pivot = kSmallestPivot<Real>) const {
    const Real scale = std::max(a00(), std::max(a11(), a22()));
    const Real smallest = smallest_pivot * scale;
    if (!(scale > Real(0)) || !(a00() > smallest)) return false;
    const Real l10 = a01() / a00();
    const Real l20 = a02() / a00();
    const Real d1 = a11() - l10 * a01();
    if (!(d1 > smallest)) return false;
    const Real e21 = a12() - l10 * a02();
    const Real l21 = e21 / d1;
    const Real d2 = a22() - l20 * a02() - l21 * e21;
    if (!(d2 > smallest)) return false;
    const Real y0 = -b0();
    const Real y1 = -b1() - l10 * y0;
    const Real y2 = -b2() - l20 * y0 - l21 * y1;
    p.z = y2 / d2;
    p.y = y1 / d1 - l21 * p.z;
    p.x = y0 / a00() - l10 * p.y - l20 * p.z;
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
};

using Quadric = BasicQuadric<double>;

/// What of one wedge's attribute error depends on its values s: of Σ_faces w · Σ_j (g_j·p + d_j - s_j)² all but the sum
/// of the squares of the faces' own linear functions, which is a quadric of the place. Capacity is the largest
/// attribute count; `count`, below, how many there are.
template <class Real, std::size_t Capacity>
struct WedgeQuadric {
  using Vec = glm::vec<3, Real>;

  Linear<Real> sum[Capacity == 0 ? 1 : Capacity];  ///< Σ w (g_j·p + d_j)
  Real weight = 0;                                 ///< Σ w

  void add(const WedgeQuadric& q, std::size_t count) {
    for (std::size_t j = 0; j < count; ++j) sum[j] += q.sum[j];
    weight += q.weight;
  }

  /// The best value of attribute j at p. \pre weight > 0
  [[nodiscard]] Real best(std::size_t j, const Vec& p) const { return sum[j].at(p) / weight; }

  /// Adds to q what the best values take off: a quadric of the position alone, never above 0.
  void add_best_to(BasicQuadric<Real>& q, std::size_t count) const {
    if (!(weight > Real(0))) return;
    const Real inverse = Real(-1) / weight;
    for (std::size_t j = 0; j < count; ++j) q.add_square(sum[j], inverse);
  }

  /// What given values add at p.
  [[nodiscard]] Real evaluate(const Vec& p, const double* values, std::size_t count) const {
    Real e = 0;
    for (std::size_t j = 0; j < count; ++j) {
      const auto value = static_cast<Real>(values[j]);
      e += value * (weight * value - Real(2) * sum[j].at(p));
    }
    return e;
  }
};

}  // namespace meshlode::builder
