// SPDX-License-Identifier: GPL-3.0-or-later
// How far a collapse moves what is painted, as far as that is promised: the largest distance of the old surface from
// the new and of the new from the old in the product space of positions, texture coordinates and normals
// (docs/reference/selection.md, "What is promised"). Quadrics of attributes are means: a collapse that smears a small
// chart, or turns one corner's normal, hides in them, and the group's error is the largest.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "builder/promise/product_point.h"
#include "builder/simplify/attribute_quadrics.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_locks.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"
#include "builder/simplify/wedge_classes.h"

namespace meshlode::builder {

/// For at most Capacity floats a wedge, as AttributeQuadrics. All in the group's frame.
template <class Real, std::size_t Capacity>
class PaintedGuard {
 public:
  using Attributes = AttributeQuadrics<Real, Capacity>;

  PaintedGuard(const SimplifyInput& input, const PaintedUnits& units, const GroupPlaces& places) {
    const AttributeLayout& layout = input.layout;
    const double per_object = 1.0 / (places.scale() * input.grid.step());
    for (std::uint32_t j = 0; j < layout.color_offset(); ++j) {
      const std::uint32_t in_uv = j - layout.uv_offset();
      unit_[j] = per_object * (layout.has_normal && j < 3 ? units.normal : units.uv[in_uv / 2][in_uv % 2]);
      is_on_ = is_on_ || unit_[j] > 0.0;
    }
    has_normals_ = layout.has_normal && unit_[0] > 0.0;
    flat_unit_ = layout.flat_normal ? per_object * units.normal : 0.0;
    is_on_ = is_on_ || flat_unit_ > 0.0;
  }

  /// Whether anything but positions counts.
  [[nodiscard]] bool is_on() const { return is_on_; }

  /// The largest squared distance, or some number up to `least` where none is larger. \pre is_on(); `classes` are those
  /// of the star's collapse
  [[nodiscard]] double distance2(const CollapseMesh& mesh, const GroupPlaces& places, const GroupLocks& locks,
                                 const CollapseStar& star, const WedgeClasses& classes, const Attributes& attributes,
                                 double least) {
    const View view{mesh, places, locks, star, classes, attributes};
    join_classes(view);
    gather_old(view);
    gather_new(view);
    if (new_.empty()) return 0.0;  // the piece goes: a matter of positions
    double largest = least;
    for (const Facet& facet : old_) {
      // Where triangles have no normals of their own, the corners around the ends are asked about by each of them.
      for (std::size_t k = 0; k < facet.asked; ++k) reach(facet.corners[k], new_, facet.twin, largest);
      reach(middle_of(facet.corners[0], facet.corners[1], facet.corners[2]), new_, facet.twin, largest);
    }
    for (const Facet& facet : new_) {
      reach(middle_of(facet.corners[0], facet.corners[1], facet.corners[2]), old_, facet.twin, largest);
      reach(middle_of(facet.corners[0], facet.corners[1]), old_, facet.twin, largest);
      reach(middle_of(facet.corners[0], facet.corners[2]), old_, facet.twin, largest);
    }
    return std::min(largest, kFarthest2);
  }

 private:
  static constexpr std::size_t kDimensions = 3 + Capacity + 3;  ///< the last: normals of triangles
  static constexpr double kFarthest2 = 1e30;
  static constexpr std::size_t kNoTwin = std::numeric_limits<std::size_t>::max();
  using Point = ProductPoint<kDimensions>;
  using Values = typename Attributes::Values;
  struct View {
    const CollapseMesh& mesh;
    const GroupPlaces& places;
    const GroupLocks& locks;
    const CollapseStar& star;
    const WedgeClasses& classes;
    const Attributes& attributes;
  };

  /// A triangle, from a corner at the end of the edge on.
  struct Facet {
    std::array<Point, 3> corners;
    Point low, high;
    std::size_t asked = 0;       ///< so many corners of the old surface are held against the new
    std::size_t twin = kNoTwin;  ///< the one of the other surface that has its edge across from the end
  };

  static Point middle_of(const Point& a, const Point& b, const Point& c) {
    Point out;
    for (std::size_t d = 0; d < kDimensions; ++d) out[d] = (a[d] + b[d] + c[d]) / 3.0;
    return out;
  }
  static Point middle_of(const Point& a, const Point& b) {
    Point out;
    for (std::size_t d = 0; d < kDimensions; ++d) out[d] = 0.5 * (a[d] + b[d]);
    return out;
  }

  /// The twin is looked at first: mostly nothing else needs to be.
  static void reach(const Point& point, const std::vector<Facet>& surface, std::size_t twin, double& largest) {
    const std::size_t first = twin != kNoTwin ? twin : 0;
    double nearest = distance2_to(point, surface[first]);
    if (nearest <= largest) return;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (i == first || !(product_distance2_to_box<kDimensions>(point, surface[i].low, surface[i].high) < nearest))
        continue;
      nearest = std::min(nearest, distance2_to(point, surface[i]));
      if (nearest <= largest) return;
    }
    if (nearest > largest) largest = nearest;
  }

  static double distance2_to(const Point& point, const Facet& facet) {
    const auto& [a, b, c] = facet.corners;
    return product_distance2<kDimensions>(point, a, b, c);
  }
  static void finish(Facet& facet) {
    const auto& [a, b, c] = facet.corners;
    for (std::size_t d = 0; d < kDimensions; ++d) {
      facet.low[d] = std::min(std::min(a[d], b[d]), c[d]);
      facet.high[d] = std::max(std::max(a[d], b[d]), c[d]);
    }
  }

  [[nodiscard]] Point point_of(const Vec3d& place, Values values) const {
    Point out{};
    for (int axis = 0; axis < 3; ++axis) out[static_cast<std::size_t>(axis)] = place[axis];
    if constexpr (Capacity >= 3) {
      const double length = std::sqrt(values[0] * values[0] + values[1] * values[1] + values[2] * values[2]);
      for (std::size_t k = 0; k < 3 && has_normals_ && length > 0.0; ++k) values[k] /= length;
    }
    for (std::size_t j = 0; j < Capacity; ++j) {
      if (unit_[j] > 0.0 && std::isfinite(values[j])) out[3 + j] = unit_[j] * values[j];
    }
    return out;
  }
  [[nodiscard]] Point point_of(const View& view, std::uint32_t corner) const {
    const Vec3d& place = view.places[view.mesh.vertex(corner)];
    Values values{};
    if (view.attributes.count() > 0) values_of(view, view.mesh.wedge(corner), place, values);
    return point_of(place, values);
  }
  static void values_of(const View& view, std::uint32_t wedge, const Vec3d& place, Values& out) {
    view.attributes.values_of(wedge, view.locks.is_wedge_locked[wedge] != 0, place, out);
  }

  /// The triangle's own normal, where that is what shades it.
  void shade_flat(Facet& facet) const {
    if (!(flat_unit_ > 0.0)) return;
    const auto place = [&](std::size_t k) {
      return Vec3d(facet.corners[k][0], facet.corners[k][1], facet.corners[k][2]);
    };
    const Vec3d n = glm::cross(place(1) - place(0), place(2) - place(0));
    const double length = std::sqrt(glm::dot(n, n));
    if (!(length > 0.0)) return;
    for (Point& corner : facet.corners) {
      for (int axis = 0; axis < 3; ++axis)
        corner[3 + Capacity + static_cast<std::size_t>(axis)] = flat_unit_ / length * n[axis];
    }
  }

  void gather_old(const View& view) {
    old_.clear();
    wedges_.clear();
    place_of_.clear();
    for (const Ring* end : {&view.star.a, &view.star.b}) {
      for (const std::uint32_t corner : end->corners()) {
        const std::uint32_t next = CollapseMesh::next_in_triangle(corner), last = CollapseMesh::next_in_triangle(next);
        Facet& facet = old_.emplace_back();
        facet.corners = {point_of(view, corner), point_of(view, next), point_of(view, last)};
        shade_flat(facet);
        finish(facet);
        place_of_.push_back({corner, static_cast<std::uint32_t>(old_.size() - 1)});
        const std::uint32_t wedge = view.attributes.count() > 0 ? view.mesh.wedge(corner) : view.mesh.vertex(corner);
        const bool is_new = std::find(wedges_.begin(), wedges_.end(), wedge) == wedges_.end();
        if (is_new) wedges_.push_back(wedge);
        facet.asked = flat_unit_ > 0.0 ? 3 : is_new ? 1 : 0;
      }
    }
    std::sort(place_of_.begin(), place_of_.end());
  }

  /// What each class becomes, at the place of its first wedge.
  void join_classes(const View& view) {
    for (std::uint32_t i = 0; i < view.classes.count(); ++i) {
      if (!view.classes.is_first(i)) continue;
      Values values{};
      view.attributes.values_of(view.classes, i, view.star.target, values);
      joined_[i] = point_of(view.star.target, values);
    }
  }

  /// \pre the old facets are gathered, and the classes joined
  void gather_new(const View& view) {
    new_.clear();
    for (const CollapseStar::OuterEdge& edge : view.star.outer()) {
      Facet& facet = new_.emplace_back();
      const std::uint32_t next = CollapseMesh::next_in_triangle(edge.corner);
      facet.corners = {joined_point(view, edge.corner), point_of(view, next),
                       point_of(view, CollapseMesh::next_in_triangle(next))};
      shade_flat(facet);
      finish(facet);
      const std::array<std::uint32_t, 2> key{edge.corner, 0};
      facet.twin = (*std::lower_bound(place_of_.begin(), place_of_.end(), key))[1];
      old_[facet.twin].twin = new_.size() - 1;
    }
  }

  [[nodiscard]] Point joined_point(const View& view, std::uint32_t corner) const {
    if (view.attributes.count() == 0) return point_of(view.star.target, Values{});
    return joined_[view.classes.class_of(view.classes.find(view.mesh.wedge(corner)))];
  }

  std::array<double, Capacity == 0 ? 1 : Capacity> unit_{};
  double flat_unit_ = 0.0;
  bool is_on_ = false, has_normals_ = false;
  // Of the collapse weighed last.
  std::vector<Facet> old_, new_;
  std::array<Point, WedgeClasses::kMost> joined_;       ///< what each class becomes
  std::vector<std::array<std::uint32_t, 2>> place_of_;  ///< corner at the end and number of its old facet, ascending
  std::vector<std::uint32_t> wedges_;
};

}  // namespace meshlode::builder
