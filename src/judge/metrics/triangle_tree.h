// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest points on a triangle soup, in doubles.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/ids.h"
#include "judge/metrics/metrics.h"

namespace meshlode::judge {

struct NearestPoint {
  double distance2 = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kNoId;  ///< of the surface; ties go to any
  bool is_nearest = true;          ///< false: the search ended at one that would do
};

/// Squared distance from a point to a triangle, which may be a needle, a segment or a point.
[[nodiscard]] double distance2_to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Whether that is `limit2` at most, for less: most that are asked are over the triangle, or far beside it.
[[nodiscard]] bool is_near_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c, double limit2);

/// A bounding volume hierarchy with a fixed shape (median splits along the longest axis of the centres). A triangle
/// that fills little of its box, a spoke of a wheel say, stands in several leaves, in each for a piece of its length:
/// else every point near the hub would lie in the boxes of a quarter of the spokes. Distances are exact; boxes are
/// floats, rounded outwards, so that a node is half as large.
class TriangleTree {
 public:
  /// A copy of positions and triangles lies in the order of the leaves, which is quicker where that of the surface
  /// leaps. Without one the surface must outlive the tree.
  enum class Positions : std::uint8_t { kCopied, kShared };
  explicit TriangleTree(const Surface& surface, Positions positions = Positions::kCopied);
  TriangleTree(const TriangleTree&) = delete;
  TriangleTree(TriangleTree&&) = default;

  /// The nearest triangle. `hint` names a triangle that is probably near, and changes the time taken alone; it may be
  /// kNoId. Infinite for an empty tree. Safe from several threads.
  [[nodiscard]] NearestPoint nearest(const Vec3d& point, std::uint32_t hint = kNoId) const {
    return search(point, hint, NearestPoint(), 0.0);
  }
  /// The nearest triangle, or after many that were tried one within a squared distance: which one by the hint.
  [[nodiscard]] NearestPoint near_enough(double distance2, const Vec3d& point, std::uint32_t hint) const {
    return search(point, hint, NearestPoint(), 0.0, distance2);
  }
  /// Some triangle that is nearer than a squared distance, or kNoId and that distance where there is none, but for the
  /// rounding of boxes.
  [[nodiscard]] NearestPoint any_within(double distance2, const Vec3d& point, std::uint32_t hint) const {
    return search(point, hint, {distance2, kNoId}, distance2);
  }
  /// A triangle within a squared distance (inclusive) of all points of another one, or kNoId.
  [[nodiscard]] std::uint32_t find_covering(const std::array<Vec3d, 3>& corners, double distance2) const;
  /// Triangles of the surface, those that are near each other one after another; one in several leaves several times.
  [[nodiscard]] std::span<const std::uint32_t> triangles_in_order() const { return triangle_; }
  /// Every triangle within a squared distance (inclusive), appended in no particular order that is always the same.
  void find_within(const Vec3d& point, double distance2, std::vector<NearestPoint>& found) const;

 private:
  /// The nearest triangle that is nearer than `best`, or any that is, within `enough`, and after many within `at_last`;
  /// all squared.
  [[nodiscard]] NearestPoint search(const Vec3d& point, std::uint32_t hint, NearestPoint best, double enough,
                                    double at_last = 0.0) const;
  /// In the tree's frame: floats of about unit size.
  struct Box {
    std::array<float, 3> low, high;
  };
  struct Node {
    Box box;
    std::uint32_t first = 0;  ///< left child (the right one follows it), or first triangle of a leaf
    std::uint32_t count = 0;  ///< triangles of a leaf; 0 for an inner node
  };
  /// A part of a triangle that is cut.
  struct Piece {
    Box box;
    std::uint32_t triangle;
  };
  /// What the tree is made of while it is made: whole triangles, and pieces.
  struct Item {
    std::array<float, 3> center;  ///< of the box
    std::uint32_t id;             ///< of a triangle; from their number on, of a piece
  };
  struct Items {
    const Surface& surface;
    std::vector<Item> items;
    std::vector<Piece> pieces;
    [[nodiscard]] std::uint32_t triangle_of(const Item& item) const {
      return item.id < surface.triangles.size() ? item.id : pieces[item.id - surface.triangles.size()].triangle;
    }
  };

  void set_frame(const Surface& surface);
  [[nodiscard]] Vec3d to_frame(const Vec3d& p) const { return (p - origin_) * scale_; }
  [[nodiscard]] Box to_frame(const Vec3d& low, const Vec3d& high) const;
  [[nodiscard]] Items cut_to_pieces(const Surface& surface) const;
  [[nodiscard]] Box box_of_item(const Items& items, const Item& item) const;
  /// Of a node, and of all that will be below it.
  struct Place {
    std::uint32_t node = 0, below = 0;
  };
  void split(const Place& place, Items& items, std::uint32_t first, std::uint32_t count);
  void copy(const Surface& surface);
  [[nodiscard]] static double distance2_to_box(const Box& box, const Vec3d& p);
  /// Of a triangle of a leaf.
  [[nodiscard]] const std::array<std::uint32_t, 3>& corners_at(std::uint32_t place) const {
    return shared_.empty() ? corners_[place] : shared_[triangle_[place]];
  }
  /// Places of leaves whose boxes are within a squared distance, until `visit` returns true.
  template <class Visit>
  void visit_near(const Vec3d& point, double distance2, const Visit& visit) const;
  /// To the triangle of a leaf; any number that is greater than `limit` where the true one is.
  [[nodiscard]] double distance2_at(const Vec3d& point, std::uint32_t place, double limit) const;

  Vec3d origin_{0.0};
  double scale_ = 1.0;     ///< a power of two: distances in the frame are so many times those outside
  double rounding_ = 0.0;  ///< what a point of the surface may be off by in the frame, twice
  std::vector<Node> nodes_;
  std::vector<Vec3d> copied_;                             ///< in the order in which leaves use them
  std::span<const Vec3d> positions_;                      ///< the copied ones, or the surface's
  std::span<const std::array<std::uint32_t, 3>> shared_;  ///< the surface's triangles, where there is no copy
  std::vector<std::array<std::uint32_t, 3>> corners_;     ///< in leaf order; or none
  std::vector<std::uint32_t> triangle_;                   ///< leaf order -> surface
  std::vector<std::uint32_t> place_;                      ///< surface -> leaf order, a place of several
};

}  // namespace meshlode::judge
