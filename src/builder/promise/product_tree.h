// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces in the product space (product_point.h), and nearest triangles on them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "builder/promise/product_point.h"
#include "builder/promise/product_search.h"

namespace meshlode::builder {

/// Triangles by ids of points. Coordinates beyond those of the mesh are zero in all points.
template <std::size_t D>
struct ProductSurface {
  std::vector<ProductPoint<D>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// b and c weigh the second and third corner.
  [[nodiscard]] ProductPoint<D> at(std::uint32_t triangle, double b, double c) const {
    const auto& [i, j, k] = triangles[triangle];
    ProductPoint<D> out;
    for (std::size_t d = 0; d < D; ++d) {
      out[d] = points[i][d] + (b * (points[j][d] - points[i][d]) + c * (points[k][d] - points[i][d]));
    }
    return out;
  }
};

/// ProductSearch over a surface, which must outlive it.
template <std::size_t D>
class ProductTree {
 public:
  using Hit = ProductSearch::Hit;

  /// Over all triangles.
  explicit ProductTree(const ProductSurface<D>& surface) : ProductTree(surface, all_of(surface)) {}
  /// Over some of them.
  ProductTree(const ProductSurface<D>& surface, std::vector<std::uint32_t> triangles)
      : search_({{surface.points.empty() ? nullptr : surface.points.front().data(), D * surface.points.size()},
                 D,
                 surface.triangles},
                std::move(triangles)) {}

  [[nodiscard]] Hit find(const ProductPoint<D>& q, std::uint32_t hint, double enough2) const {
    return search_.find(q.data(), hint, enough2);
  }

 private:
  static std::vector<std::uint32_t> all_of(const ProductSurface<D>& surface) {
    std::vector<std::uint32_t> triangles(surface.triangles.size());
    std::iota(triangles.begin(), triangles.end(), 0U);
    return triangles;
  }

  ProductSearch search_;
};

}  // namespace meshlode::builder
