// SPDX-License-Identifier: GPL-3.0-or-later
// What of some triangles is farther from a surface than what is known, by bounds. The distance to one triangle of the
// surface is convex: in a part of a triangle it is nowhere more than what lies linearly between its values at the
// corners. So the distance to the surface is nowhere more than the least of some such linear functions, and where that
// is largest follows exactly. There the surface is asked for: what is nearest is far, and a peak is found, or it is
// near, and one more function says so. Parts that keep a bound beyond what is known are divided, those with the most
// room first. Few are left where a mesh is smooth, flat or a crowd of large triangles; else the effort ends.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/deviation/surface_tree.h"

namespace meshlode::builder {

struct LinearBounds;

class BoundedSearch {
 public:
  /// A point that was farther.
  struct Found {
    double distance = 0.0;  ///< object units, measured exactly; 0: there was none
    Vec3d at{0.0};
    TreeSlot place;  ///< of what is nearest to it
  };

  /// Nothing is looked for within `margin` times what is known, nor within a thousandth more: `known`, and then what is
  /// found. What floats of the tree do not tell apart, a few ten-millionths of its extent, is always within. The tree
  /// must outlive this. \pre margin >= 1
  BoundedSearch(const SurfaceTree& tree, double margin, double known);

  /// Says which part of the surface a triangle of the tree is of.
  using PartOf = std::function<std::size_t(std::uint32_t triangle)>;
  /// The same where more is known of some parts of the surface than of others: what is nearest to a point says which
  /// of `known` counts there, and each part has its own farthest point. The last one is what is of none of the others:
  /// what is nearest to it counts for all. \pre part_of() < known.size()
  BoundedSearch(const SurfaceTree& tree, double margin, std::span<const double> known, PartOf part_of);

  /// What of it may be beyond is divided by run().
  void add(const std::array<Vec3d, 3>& corners, TreeSlot place);
  /// The same, but run() looks at it, if its turn comes: no point of it is farther than `bound`.
  void add_later(const std::array<Vec3d, 3>& corners, TreeSlot place, double bound);
  /// Nothing within `margin` times that is looked for any more.
  void know(double known);
  /// The same of each part.
  void know(std::span<const double> known);
  /// Makes at most so many parts, and returns how many.
  std::size_t run(std::size_t parts);
  /// Nothing is left to be divided.
  [[nodiscard]] bool is_done() const { return parts_.empty() || !is_beyond(parts_.front().bound); }

  /// No point of what is left is farther; 0 where nothing is left.
  [[nodiscard]] double bound_of_rest() const { return is_done() ? 0.0 : parts_.front().bound; }

  /// The farthest.
  [[nodiscard]] const Found& found() const { return found_; }
  /// That of a part.
  [[nodiscard]] double found_of(std::size_t part) const { return limits_[part].found; }

 private:
  struct Corner {
    Vec3d at;
    TreeSlot near;  ///< a triangle that is near to it
  };
  /// Of a triangle, or all of it.
  struct Part {
    std::array<Corner, 3> corner;
    TreeSlot near_peak;   ///< near where its bound was largest, or that of what it is a part of; invalid: not known
    bool is_new = false;  ///< of add_later(): not looked at
    std::uint8_t peak_edge = kInside;  ///< from that corner to the next: where that was; or inside
    std::uint32_t order = 0;           ///< as they were made
    double bound = std::numeric_limits<double>::infinity();  ///< no point of it is farther from the surface

    [[nodiscard]] bool operator<(const Part& other) const {
      return bound != other.bound ? bound < other.bound : order > other.order;
    }
    [[nodiscard]] std::uint8_t longest_edge() const;

    static constexpr std::uint8_t kInside = 3;
  };

  /// Of a part of the surface.
  struct Limit {
    double beyond = 0.0;  ///< no nearer point is of use
    double found = 0.0;   ///< the farthest; 0: there was none
  };
  [[nodiscard]] static bool is_beyond(double distance, double limit);
  [[nodiscard]] bool is_beyond(double distance) const { return is_beyond(distance, beyond_); }
  /// No point of use that this triangle is nearest to is nearer.
  [[nodiscard]] double beyond_at(TreeSlot slot) const {
    return limits_.empty() ? beyond_ : limits_[part_of_(tree_->triangle_at(slot))].beyond;
  }
  void take(const Found& found);
  void take_least();
  /// A triangle of the surface may be nearest to a point of the part that is farther than what is known of the
  /// triangle. \pre limits_ is not empty
  [[nodiscard]] bool may_be_beyond(std::uint32_t triangle, const Part& part, const LinearBounds& bounds) const;
  /// One in reach may be. If the part is too small to be divided for that, its bound is what is found of those.
  [[nodiscard]] bool is_any_in_reach(const Part& part, const LinearBounds& bounds);
  /// A triangle around `place` is, to all three and so to all between them.
  [[nodiscard]] bool is_near_throughout(const std::array<Vec3d, 3>& corners, TreeSlot place) const;
  [[nodiscard]] SurfaceTree::Hit find_near(const Corner& corner, float enough) const;
  /// Asks for what is near to a point, and takes it where it is the farthest so far. False: nothing is.
  [[nodiscard]] bool measure(Corner& corner);
  [[nodiscard]] bool is_within(Part& part);
  /// Pushes what of a new part may be beyond.
  void look_at(Part& part);
  /// Where a part is divided: so far along the edge from that corner to the next.
  struct Division {
    std::size_t edge = 0;
    double share = 0.5;
  };
  [[nodiscard]] Division choose_division(const Part& part) const;
  void push(Part& part);

  const SurfaceTree* tree_;
  double margin_, beyond_;  ///< no nearer point is of use
  Found found_;
  std::vector<Limit> limits_;  ///< of the surface's parts; empty: it is one
  PartOf part_of_;
  std::vector<Part> parts_;  ///< a heap
  std::uint32_t made_ = 0;
};

}  // namespace meshlode::builder
