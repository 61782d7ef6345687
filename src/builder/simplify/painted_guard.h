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
      coordinate_[j] = static_cast<std::uint32_t>(dimensions_);
      if (unit_[j] > 0.0) ++dimensions_;
    }
    has_normals_ = layout.has_normal && unit_[0] > 0.0;
    flat_unit_ = layout.flat_normal ? per_object * units.normal : 0.0;
    first_flat_ = dimensions_;
    if (flat_unit_ > 0.0) dimensions_ += 3;
  }

  /// Whether anything but positions counts.
  [[nodiscard]] bool is_on() const { return dimensions_ > 3; }

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
    // Loops of a number that is known are unrolled. Most meshes that promise texels have 5 dimensions.
    if constexpr (kMostDimensions > 5) {
      if (dimensions_ <= 5) return std::min(reached2<5>(least), kFarthest2);
    }
    if constexpr (kMostDimensions > 8) {
      if (dimensions_ <= 8) return std::min(reached2<8>(least), kFarthest2);
    }
    return std::min(reached2<kMostDimensions>(least), kFarthest2);
  }

 private:
  static constexpr std::size_t kMostDimensions = 3 + Capacity + 3;  ///< the last: normals of triangles
  static constexpr double kFarthest2 = 1e30;
  static constexpr std::size_t kNoTwin = std::numeric_limits<std::size_t>::max();
  using Point = ProductPoint<kMostDimensions>;  ///< positions, then what counts; of corners 0 behind dimensions_
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
    Facet() {}  // points are written, not cleared
    std::array<Point, 3> corners;
    Point low, high;  ///< of its box, where it has_box
    bool has_box = false;
    std::size_t asked = 0;       ///< so many corners of the old surface are held against the new
    std::size_t twin = kNoTwin;  ///< the one of the other surface that has its edge across from the end
  };

  // Of D coordinates, which are all that is looked at.
  template <std::size_t D>
  static Point middle_of(const Point& a, const Point& b, const Point& c) {
    Point out;
    for (std::size_t d = 0; d < D; ++d) out[d] = (a[d] + b[d] + c[d]) / 3.0;
    return out;
  }
  template <std::size_t D>
  static Point middle_of(const Point& a, const Point& b) {
    Point out;
    for (std::size_t d = 0; d < D; ++d) out[d] = 0.5 * (a[d] + b[d]);
    return out;
  }

  /// A facet of the old surface and the one of the new that takes its place: the same but for the first corner. Bounds,
  /// which are sharp but for rounding.
  class TwinFacets {
   public:
    template <std::size_t D>
    [[nodiscard]] static TwinFacets between(const Facet& was, const Facet& is) {
      TwinFacets twins;
      const auto& [a, b, c] = was.corners;
      for (std::size_t d = 0; d < D; ++d) {
        const double e = b[d] - a[d], f = c[d] - a[d], m = is.corners[0][d] - a[d];
        twins.ee_ += e * e;
        twins.ef_ += e * f;
        twins.ff_ += f * f;
        twins.em_ += e * m;
        twins.fm_ += f * m;
        twins.mm_ += m * m;
      }
      twins.grace_ = 1e-13 * (twins.ee_ + twins.ff_ + twins.mm_);
      return twins;
    }
    /// Of all below but the first: no point moves farther than the half of what the corner does.
    [[nodiscard]] double all2() const { return 0.25 * mm_ + grace_; }
    /// Of the old first corner from the new facet.
    [[nodiscard]] double old_corner2() const { return from_new2(mm_ - em_, mm_ - fm_, mm_); }
    /// Of the old middle from the new facet.
    [[nodiscard]] double old_middle2() const {
      const double shared = mm_ - (em_ + fm_) / 3.0;
      return from_new2((ee_ + ef_) / 3.0 - em_ + shared, (ef_ + ff_) / 3.0 - fm_ + shared,
                       (ee_ + ff_ + 2.0 * ef_) / 9.0 + mm_ - 2.0 / 3.0 * (em_ + fm_));
    }
    /// Of the new middle from the old facet.
    [[nodiscard]] double new_middle2() const {
      return grace_ + product_distance2_about({ee_, ef_, ff_, (em_ + ee_ + ef_) / 3.0, (fm_ + ef_ + ff_) / 3.0,
                                               (mm_ + ee_ + ff_ + 2.0 * (em_ + fm_ + ef_)) / 9.0});
    }
    /// Of the middle of a new edge, to corner 1 or 2.
    [[nodiscard]] double new_edge2(std::size_t corner) const {
      const double pe = corner == 1 ? em_ + ee_ : em_ + ef_, pf = corner == 1 ? fm_ + ef_ : fm_ + ff_;
      const double pp = corner == 1 ? mm_ + ee_ + 2.0 * em_ : mm_ + ff_ + 2.0 * fm_;
      return grace_ + product_distance2_about({ee_, ef_, ff_, 0.5 * pe, 0.5 * pf, 0.25 * pp});
    }

   private:
    [[nodiscard]] double from_new2(double pe, double pf, double pp) const {
      const double ee = ee_ - 2.0 * em_ + mm_, ef = ef_ - em_ - fm_ + mm_, ff = ff_ - 2.0 * fm_ + mm_;
      return grace_ + product_distance2_about({ee, ef, ff, pe, pf, pp});
    }
    double ee_ = 0.0, ef_ = 0.0, ff_ = 0.0, em_ = 0.0, fm_ = 0.0, mm_ = 0.0, grace_ = 0.0;
  };

  /// distance2() of the facets. \pre all that is behind D dimensions is zero
  template <std::size_t D>
  [[nodiscard]] double reached2(double least) {
    const bool is_certain = !(flat_unit_ > 0.0);  // that twins share two corners
    twins_.clear();
    for (const Facet& facet : new_) twins_.push_back(TwinFacets::template between<D>(old_[facet.twin], facet));
    double largest = least;
    // The corners first: mostly what lies between them is nearer.
    for (const Facet& facet : old_) {
      // Where triangles have no normals of their own, the corners around the ends are asked about by each of them.
      const bool is_near = is_certain && facet.twin != kNoTwin && twins_[facet.twin].old_corner2() <= largest;
      for (std::size_t k = 0; k < facet.asked && !is_near; ++k) reach<D>(facet.corners[k], new_, facet.twin, largest);
      if (facet.twin == kNoTwin)
        reach<D>(middle_of<D>(facet.corners[0], facet.corners[1], facet.corners[2]), new_, kNoTwin, largest);
    }
    for (std::size_t i = 0; i < new_.size(); ++i) {
      const Facet& facet = new_[i];
      const auto& [a, b, c] = old_[facet.twin].corners;
      const TwinFacets& twins = twins_[i];
      if (is_certain && twins.all2() <= largest) continue;
      if (!is_certain || twins.old_middle2() > largest) reach<D>(middle_of<D>(a, b, c), new_, i, largest);
      if (!is_certain || twins.new_middle2() > largest)
        reach<D>(middle_of<D>(facet.corners[0], facet.corners[1], facet.corners[2]), old_, facet.twin, largest);
      for (const std::size_t k : {1, 2}) {
        if (!is_certain || twins.new_edge2(k) > largest)
          reach<D>(middle_of<D>(facet.corners[0], facet.corners[k]), old_, facet.twin, largest);
      }
    }
    return largest;
  }

  /// The twin is looked at first: mostly nothing else needs to be.
  template <std::size_t D>
  static void reach(const Point& point, std::vector<Facet>& surface, std::size_t twin, double& largest) {
    const std::size_t first = twin != kNoTwin ? twin : 0;
    double nearest = distance2_to<D>(point, surface[first]);
    if (nearest <= largest) return;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (i == first) continue;
      find_box<D>(surface[i]);
      if (!(product_distance2_to_box(point.data(), surface[i].low.data(), surface[i].high.data(), D) < nearest))
        continue;
      nearest = std::min(nearest, distance2_to<D>(point, surface[i], nearest));
      if (nearest <= largest) return;
    }
    if (nearest > largest) largest = nearest;
  }

  template <std::size_t D>
  static double distance2_to(const Point& point, const Facet& facet,
                             double enough2 = std::numeric_limits<double>::infinity()) {
    const auto& [a, b, c] = facet.corners;
    return product_distance2<D>(point.data(), a.data(), b.data(), c.data(), D, enough2);
  }
  /// Few facets are ever asked for theirs.
  template <std::size_t D>
  static void find_box(Facet& facet) {
    if (facet.has_box) return;
    facet.has_box = true;
    const auto& [a, b, c] = facet.corners;
    for (std::size_t d = 0; d < D; ++d) {
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
      if (unit_[j] > 0.0 && std::isfinite(values[j])) out[coordinate_[j]] = unit_[j] * values[j];
    }
    return out;
  }
  [[nodiscard]] Point point_of(const View& view, std::uint32_t corner) const {
    const Vec3d& place = view.places[view.mesh.vertex(corner)];
    Values values{};
    if (view.attributes.count() > 0) values_of(view, view.mesh.wedge(corner), place, values);
    return point_of(place, values);
  }
  /// Of a corner that others may share.
  [[nodiscard]] const Point& known_point(const View& view, std::uint32_t corner) {
    const std::uint32_t wedge = view.attributes.count() > 0 ? view.mesh.wedge(corner) : 0;
    const std::uint64_t key = std::uint64_t{view.mesh.vertex(corner)} << 32U | wedge;
    for (std::size_t i = point_keys_.size(); i-- > 0;) {  // neighbours come one after the other
      if (point_keys_[i] == key) return points_[i];
    }
    point_keys_.push_back(key);
    return points_.emplace_back(point_of(view, corner));
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
    for (Point& corner : facet.corners) {
      for (int axis = 0; axis < 3; ++axis)
        corner[first_flat_ + static_cast<std::size_t>(axis)] = length > 0.0 ? flat_unit_ / length * n[axis] : 0.0;
    }
  }

  void gather_old(const View& view) {
    old_.clear();
    points_.clear();
    point_keys_.clear();
    wedges_.clear();
    place_of_.clear();
    for (const Ring* end : {&view.star.a, &view.star.b}) {
      for (const std::uint32_t corner : end->corners()) {
        const std::uint32_t next = CollapseMesh::next_in_triangle(corner), last = CollapseMesh::next_in_triangle(next);
        Facet& facet = old_.emplace_back();
        facet.corners[0] = known_point(view, corner);
        facet.corners[1] = known_point(view, next);
        facet.corners[2] = known_point(view, last);
        shade_flat(facet);
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
      facet.corners[0] = joined_point(view, edge.corner);
      const std::array<std::uint32_t, 2> key{edge.corner, 0};
      facet.twin = (*std::lower_bound(place_of_.begin(), place_of_.end(), key))[1];
      for (std::size_t k = 1; k < 3; ++k) facet.corners[k] = old_[facet.twin].corners[k];
      shade_flat(facet);
      old_[facet.twin].twin = new_.size() - 1;
    }
  }

  [[nodiscard]] Point joined_point(const View& view, std::uint32_t corner) const {
    if (view.attributes.count() == 0) return point_of(view.star.target, Values{});
    return joined_[view.classes.class_of(view.classes.find(view.mesh.wedge(corner)))];
  }

  std::array<double, Capacity == 0 ? 1 : Capacity> unit_{};
  std::array<std::uint32_t, Capacity == 0 ? 1 : Capacity> coordinate_{};  ///< of a point, where unit_ is above 0
  std::size_t dimensions_ = 3, first_flat_ = 3;  ///< normals of triangles, if there are, are the last
  double flat_unit_ = 0.0;
  bool has_normals_ = false;
  // Of the collapse weighed last.
  std::vector<Facet> old_, new_;
  std::vector<TwinFacets> twins_;                       ///< per new facet
  std::vector<Point> points_;                           ///< of corners, by point_keys_
  std::vector<std::uint64_t> point_keys_;               ///< vertex and wedge
  std::array<Point, WedgeClasses::kMost> joined_;       ///< what each class becomes
  std::vector<std::array<std::uint32_t, 2>> place_of_;  ///< corner at the end and number of its old facet, ascending
  std::vector<std::uint32_t> wedges_;
};

}  // namespace meshlode::builder
