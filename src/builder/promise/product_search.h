// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest triangles in the product space (product_point.h), of any number of dimensions: boxes in floats
// (deviation/open_boxes.h), and four triangles a leaf in doubles, which only dismiss. What is left is worked out by
// product_distance2(), so that what is found is what looking at all finds, bit for bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/unset_vector.h"

namespace meshlode::builder {

class ProductSearch {
 public:
  struct Hit {
    double distance2 = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNoId;
  };
  /// Triangles by numbers of points, which have `dimensions` coordinates each.
  struct Surface {
    std::span<const double> coordinates;
    std::size_t dimensions;
    std::span<const std::array<std::uint32_t, 3>> triangles;
  };
  static constexpr std::size_t kMostDimensions = 14;

  /// Over some triangles of a surface, which must outlive this.
  ProductSearch(const Surface& surface, std::vector<std::uint32_t> triangles);

  /// The nearest triangle, or the first that is found within the square root of `enough2`; of `hint` first, where it is
  /// one. Nothing where the point is not finite. \pre `hint` is one of the triangles
  [[nodiscard]] Hit find(const double* point, std::uint32_t hint, double enough2) const;

 private:
  void set_scale();
  void sort_triangles();
  void fill_leaf(std::size_t leaf);
  void fill_nodes();
  [[nodiscard]] const double* corner(std::uint32_t triangle, std::size_t k, std::size_t dimensions) const {
    return surface_.coordinates.data() + dimensions * surface_.triangles[triangle][k];
  }
  [[nodiscard]] const double* corner(std::uint32_t triangle, std::size_t k) const {
    return corner(triangle, k, surface_.dimensions);
  }
  [[nodiscard]] std::size_t leaf_count() const { return (order_.size() + 3) / 4; }
  [[nodiscard]] std::size_t leaf_size() const;
  /// find() in D dimensions; 0: as many as there are.
  template <std::size_t D>
  [[nodiscard]] Hit find_in(const double* point, std::uint32_t hint, double enough2) const;

  Surface surface_;
  double scale_ = 1.0;                      ///< a power of two: coordinates times it are of about unit size
  std::vector<std::uint32_t> order_;        ///< four triangles a leaf
  std::vector<std::uint32_t> slot_of_;      ///< per triangle of the surface: where it is there
  UnsetVector<double> leaves_;              ///< leaf_size() each
  UnsetVector<float> nodes_;                ///< per node: [low, high][dimension][child]
  std::vector<std::uint32_t> level_start_;  ///< box_levels()
};

}  // namespace meshlode::builder
