// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest triangles in the product space (product_point.h): a hierarchy of boxes is searched as in three dimensions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "builder/promise/product_point.h"

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

template <std::size_t D>
class ProductTree {
 public:
  struct Hit {
    double distance2 = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNoId;
  };

  /// Over all triangles of a surface, which must outlive the tree.
  explicit ProductTree(const ProductSurface<D>& surface) : ProductTree(surface, all_of(surface)) {}
  /// Over some of them.
  ProductTree(const ProductSurface<D>& surface, std::vector<std::uint32_t> triangles)
      : surface_(surface), order_(std::move(triangles)) {
    if (order_.empty()) return;
    nodes_.reserve(2 * order_.size() / kLeaf + 2);
    nodes_.emplace_back();
    std::vector<Range> open{{0, 0, static_cast<std::uint32_t>(order_.size())}};
    while (!open.empty()) {
      const Range range = open.back();
      open.pop_back();
      split(range, open);
    }
  }

  [[nodiscard]] bool is_empty() const { return order_.empty(); }

  /// The nearest triangle, or the first that is found within the square root of `enough2`; of `hint` first, where it is
  /// one. \pre the tree is over `hint`, too
  [[nodiscard]] Hit find(const ProductPoint<D>& q, std::uint32_t hint, double enough2) const {
    Hit best;
    if (order_.empty()) return best;
    if (hint != kNoId) take(q, hint, best);
    if (best.distance2 <= enough2) return best;
    std::array<std::pair<double, std::uint32_t>, kDepth> stack;
    std::size_t open = 0;
    stack[open++] = {distance2_of(q, 0), 0};
    while (open > 0) {
      const auto [near2, index] = stack[--open];
      if (!(near2 < best.distance2)) continue;
      const Node& node = nodes_[index];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) take(q, order_[i], best);
        if (best.distance2 <= enough2) return best;
        continue;
      }
      const double left2 = distance2_of(q, node.first), right2 = distance2_of(q, node.first + 1);
      const bool is_left_first = left2 <= right2;
      const std::pair<double, std::uint32_t> left{left2, node.first}, right{right2, node.first + 1};
      if (std::max(left2, right2) < best.distance2) stack[open++] = is_left_first ? right : left;
      if (std::min(left2, right2) < best.distance2) stack[open++] = is_left_first ? left : right;
    }
    return best;
  }

 private:
  static constexpr std::uint32_t kLeaf = 4;
  /// Halves of at most 2^32 triangles: no path is longer, and each step leaves one sibling open.
  static constexpr std::size_t kDepth = 40;

  struct Node {
    std::array<float, D> low, high;
    std::uint32_t first = 0, count = 0;  ///< count > 0: a leaf, of order_; else the first of two children
  };
  struct Range {
    std::uint32_t node, first, count;
  };

  static std::vector<std::uint32_t> all_of(const ProductSurface<D>& surface) {
    std::vector<std::uint32_t> triangles(surface.triangles.size());
    std::iota(triangles.begin(), triangles.end(), 0U);
    return triangles;
  }

  [[nodiscard]] double distance2_of(const ProductPoint<D>& q, std::uint32_t index) const {
    return product_distance2_to_box<D>(q, nodes_[index].low, nodes_[index].high);
  }

  void take(const ProductPoint<D>& q, std::uint32_t triangle, Hit& best) const {
    const auto& [a, b, c] = surface_.triangles[triangle];
    const double distance2 =
        product_distance2<D>(q, surface_.points[a], surface_.points[b], surface_.points[c], best.distance2);
    if (distance2 < best.distance2) best = {distance2, triangle};
  }

  void split(const Range& range, std::vector<Range>& open) {
    ProductPoint<D> low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      for (const std::uint32_t corner : surface_.triangles[order_[i]]) {
        for (std::size_t d = 0; d < D; ++d) {
          low[d] = std::min(low[d], surface_.points[corner][d]);
          high[d] = std::max(high[d], surface_.points[corner][d]);
        }
      }
    }
    Node& node = nodes_[range.node];
    std::size_t longest = 0;
    for (std::size_t d = 0; d < D; ++d) {
      node.low[d] = float_below(low[d]);
      node.high[d] = -float_below(-high[d]);
      if (high[d] - low[d] > high[longest] - low[longest]) longest = d;
    }
    node.first = range.first;
    node.count = range.count;
    if (range.count <= kLeaf) return;
    const auto key = [&](std::uint32_t t) {
      const auto& [a, b, c] = surface_.triangles[t];
      return surface_.points[a][longest] + surface_.points[b][longest] + surface_.points[c][longest];
    };
    const std::uint32_t half = range.count / 2;
    const auto first = order_.begin() + range.first;
    std::nth_element(first, first + half, first + range.count, [&](std::uint32_t s, std::uint32_t t) {
      const double x = key(s), y = key(t);
      return x != y ? x < y : s < t;
    });
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    node.first = child;
    node.count = 0;
    nodes_.emplace_back();
    nodes_.emplace_back();  // `node` is no longer valid
    open.push_back({child, range.first, half});
    open.push_back({child + 1, range.first + half, range.count - half});
  }

  /// The largest float that is not above `value`.
  static float float_below(double value) {
    const float nearest = static_cast<float>(value);
    return double{nearest} > value ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
  }

  const ProductSurface<D>& surface_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace meshlode::builder
