// SPDX-License-Identifier: GPL-3.0-or-later
// How far two surfaces are apart in what is painted on them too: both as surfaces of a product space, whose points are
//
//   x = (position, s_u · u and s_v · v of each UV set that counts, lambda · unit normal)
//
// with the Euclidean metric, in object units (docs/reference/selection.md, "Promises"). A texture that swims, a seam
// that moved sideways and a normal that turned are lengths there, as a dent is; the two-sided Hausdorff distance counts
// them together. Where a chart ends nothing special happens: a point beyond a moved seam has its own chart's point
// nearby, as far away as the seam moved.
//
// Between the corners of a triangle all coordinates are linear, the normal's too, which is not made unit length again:
// so surfaces are flat piece by piece, and the nearest point is found exactly (product_tree.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "base/vec.h"
#include "judge/metrics/metrics.h"
#include "judge/metrics/product_scales.h"
#include "judge/metrics/shaded_surface.h"

namespace meshlode::judge {

/// The larger of both ways' maxima, and where it is.
struct LargestDeviation {
  double max = 0.0;
  Vec3d worst{0.0};          ///< the first point that is as far away
  bool is_of_a = true;       ///< `worst` is a point of surface a
  std::uint64_t points = 0;  ///< samples and vertices, both ways
};

/// How much a distance at a position counts; above 0 and finite.
using DistanceWeight = std::function<double(const Vec3d&)>;

/// A surface a that others are measured against, one after another. What a surface does not know (an entry that is not
/// finite, a normal of no length, at any corner of a triangle) is not compared there: the distance is then that of the
/// rest.
class ProductDistanceFrom {
 public:
  /// `options`: as of DeviationFrom. `a` may go afterwards.
  ProductDistanceFrom(const ShadedSurface& a, const ProductScales& scales, const DeviationOptions& options);
  ~ProductDistanceFrom();
  ProductDistanceFrom(ProductDistanceFrom&&) noexcept;

  /// The two-sided maximum over area-uniform samples (in the area of the positions) and all vertices, but those of
  /// undrawn triangles alone, and the first point where it is found; the same for any thread count. With a weight the
  /// largest of weight(position) · distance. Infinite where one surface has no triangle and the other has; 0 where both
  /// have none.
  [[nodiscard]] LargestDeviation find_largest(const ShadedSurface& b, const DistanceWeight& weight = {}) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A surface whose single points are held against another's.
class ProductSurface {
 public:
  /// `s` may go afterwards.
  ProductSurface(const ShadedSurface& s, const ProductScales& scales);
  ~ProductSurface();
  ProductSurface(ProductSurface&&) noexcept;

  /// Of the point of a triangle at the weights of its second and third corner from the nearest point of `other`;
  /// infinite where that has no triangle. \pre the same scales
  [[nodiscard]] double distance_to(const ProductSurface& other, std::uint32_t triangle, double b, double c) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace meshlode::judge
