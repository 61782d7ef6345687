// SPDX-License-Identifier: GPL-3.0-or-later
// The product space of positions, texture coordinates and normals (docs/reference/selection.md, "What is promised"): a
// point of a surface has up to fourteen coordinates, all lengths, and a triangle is flat there too, since each of them
// is linear between its corners. So the nearest point of a triangle is what it is in three dimensions (Ericson
// 2004, 5.1.5, which needs dot products alone).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace meshlode::builder {

template <std::size_t D>
using ProductPoint = std::array<double, D>;

/// Squared distance of q from the triangle, of a point of it in any case: rounding never makes it too small by more
/// than itself, and a triangle without area is its edges. Infinite may be what is farther than the square root of
/// `enough2`. D: `dimensions`, where they are known when this is compiled, or 0.
template <std::size_t D = 0>
double product_distance2(const double* q, const double* a, const double* b, const double* c, std::size_t dimensions,
                         double enough2) {
  if constexpr (D > 0) dimensions = D;
  double ee = 0.0, ef = 0.0, ff = 0.0, d1 = 0.0, d2 = 0.0, pp = 0.0;
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double e = b[d] - a[d], f = c[d] - a[d], p = q[d] - a[d];
    ee += e * e;
    ef += e * f;
    ff += f * f;
    d1 += e * p;
    d2 += f * p;
    pp += p * p;
  }
  // Where the plane is well known it says enough of most triangles: more than a millionth is not lost of it.
  const double det = ee * ff - ef * ef;
  if (det > 1e-4 * ee * ff) {
    const double in_plane2_by_det = d1 * (d1 * ff - d2 * ef) + d2 * (d2 * ee - d1 * ef);
    if ((pp * (1.0 - 1e-6) - enough2) * det > in_plane2_by_det) return std::numeric_limits<double>::infinity();
  }
  const auto at = [=](double v, double w) __attribute__((always_inline)) {
    double sum = 0.0;
    for (std::size_t d = 0; d < (D > 0 ? D : dimensions); ++d) {
      const double off = (q[d] - a[d]) - (v * (b[d] - a[d]) + w * (c[d] - a[d]));
      sum += off * off;
    }
    return sum;
  };
  const double d3 = d1 - ee, d4 = d2 - ef, d5 = d1 - ef, d6 = d2 - ff;
  const auto on_edges = [&] {
    const auto share = [](double along, double whole) {
      return whole > 0.0 ? std::clamp(along / whole, 0.0, 1.0) : 0.0;
    };
    const double bc = share((d4 - d3), (ee - ef) + (ff - ef));
    return std::min({at(share(d1, ee), 0.0), at(0.0, share(d2, ff)), at(1.0 - bc, bc)});
  };
  if (d1 <= 0.0 && d2 <= 0.0) return at(0.0, 0.0);
  if (d3 >= 0.0 && d4 <= d3) return at(1.0, 0.0);
  if (d6 >= 0.0 && d5 <= d6) return at(0.0, 1.0);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  const double sum = va + vb + vc;
  // Where the three cancel, or one of them says an edge, the edges are looked at, all three: they are never wrong.
  if (va <= 0.0 || vb <= 0.0 || vc <= 0.0 || !(sum > 1e-12 * ee * ff)) return on_edges();
  return at(vb / sum, vc / sum);
}
template <std::size_t D>
double product_distance2(const ProductPoint<D>& q, const ProductPoint<D>& a, const ProductPoint<D>& b,
                         const ProductPoint<D>& c, double enough2 = std::numeric_limits<double>::infinity()) {
  return product_distance2<D>(q.data(), a.data(), b.data(), c.data(), D, enough2);
}

/// A point and a triangle by their dot products: of the point (p) and two edges (e, f), all from the triangle's first
/// corner.
struct ProductDots {
  double ee, ef, ff, pe, pf, pp;
};

/// Squared distance to some point of the triangle, the nearest but for rounding: of about 1e-15 of all lengths squared,
/// which is much where the distance is small. A few operations, whatever the number of dimensions.
inline double product_distance2_about(const ProductDots& dots) {
  const double ee = dots.ee, ef = dots.ef, ff = dots.ff, pe = dots.pe, pf = dots.pf, pp = dots.pp;
  const auto at = [&](double v, double w) {
    return pp - 2.0 * (v * pe + w * pf) + (v * v * ee + 2.0 * v * w * ef + w * w * ff);
  };
  const double b = pe * ff - pf * ef, c = pf * ee - pe * ef, det = ee * ff - ef * ef;
  if (b >= 0.0 && c >= 0.0 && b + c <= det && det > 0.0) return at(b / det, c / det);
  const auto share = [](double along, double whole) { return whole > 0.0 ? std::clamp(along / whole, 0.0, 1.0) : 0.0; };
  const double w = share((pf - ef) - (pe - ee), (ee - ef) + (ff - ef));
  return std::min({at(share(pe, ee), 0.0), at(0.0, share(pf, ff)), at(1.0 - w, w)});
}

/// Squared distance of q from the box between two corners.
inline double product_distance2_to_box(const double* q, const double* low, const double* high, std::size_t dimensions) {
  double sum = 0.0;
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double off = std::max({low[d] - q[d], q[d] - high[d], 0.0});
    sum += off * off;
  }
  return sum;
}

}  // namespace meshlode::builder
