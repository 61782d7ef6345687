// SPDX-License-Identifier: GPL-3.0-or-later
// A tree over the triangles of a surface that finds what lies near a point: four boxes a node, four triangles a leaf,
// in floats; the children's places follow from the node's own, so that no links are stored.
//
// Floats only choose: whatever triangle comes out, its exact distance (in doubles) is an upper bound of the distance to
// the surface, and it misses the least by about 1e-7 of the surface's extent.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/unset_vector.h"
#include "base/vec.h"
#include "builder/deviation/capsules.h"
#include "builder/deviation/four_triangles.h"
#include "builder/deviation/lanes.h"
#include "builder/deviation/open_boxes.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/tree_slot.h"

namespace meshlode::builder {

class SurfaceTree {
 public:
  struct Hit {
    TreeSlot slot;              ///< invalid: nothing was near enough
    float distance2 = 3.0e38F;  ///< in the tree's frame, approximate
  };

  struct Surface {
    std::span<const Vec3d> positions;
    std::span<const std::array<std::uint32_t, 3>> triangles;
  };

  /// Leaves are made from the surface whenever they are looked at. Of few triangles they may be held, 68 bytes a
  /// triangle: the same numbers.
  enum class Leaves : std::uint8_t { kHeldIfFew, kMade };
  /// So many are few: the queries of a random scene (940027) go to and fro over all of its 29,539 triangles, and with
  /// leaves that are made it takes 9.2 s to build for 6.3. The dragon's go from neighbour to neighbour: with all
  /// leaves made its build takes no longer, and 30 MB less.
  static constexpr std::size_t kFew = 65536;

  /// Capsules help where very many triangles meet in one vertex, and are of no use elsewhere: made where a position has
  /// so many, or left to add_capsules().
  enum class Capsules : std::uint8_t { kWhereTheyHelp, kLater };

  /// The spans must outlive the tree. Every index in range, every position finite.
  void build(const Surface& surface, Leaves leaves = Leaves::kHeldIfFew, Capsules capsules = Capsules::kWhereTheyHelp);
  /// The same triangles are found with and without. \pre it is built, and has none
  void add_capsules() { fill_capsules(); }

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(slot_triangle_.size()); }
  [[nodiscard]] std::uint32_t triangle_at(TreeSlot slot) const { return slot_triangle_[slot.value]; }
  [[nodiscard]] const std::array<std::uint32_t, 3>& indices_at(TreeSlot slot) const {
    return surface_.triangles[triangle_at(slot)];
  }
  [[nodiscard]] TriangleCorners corners_of(std::uint32_t triangle) const {
    const auto& t = surface_.triangles[triangle];
    return {surface_.positions[t[0]], surface_.positions[t[1]], surface_.positions[t[2]]};
  }
  [[nodiscard]] TriangleCorners corners_at(TreeSlot slot) const { return corners_of(triangle_at(slot)); }
  [[nodiscard]] double distance2_at(const Vec3d& point, TreeSlot slot) const {
    return point_triangle_distance2(point, corners_at(slot));
  }

  /// The tree's frame: floats of about unit size. Distances there are `scale` times those outside; a power of two.
  [[nodiscard]] Vec3f to_frame(const Vec3d& point) const { return Vec3f((point - center_) * scale_); }
  [[nodiscard]] double scale() const { return scale_; }
  /// A distance from outside, squared and in the frame, as searches compare.
  [[nodiscard]] float squared_in_frame(double distance) const {
    return static_cast<float>(distance * scale_ * (distance * scale_));
  }

  /// The nearest triangle that beats `best`, else `best`. Stops as soon as something is within `enough`. `best` is what
  /// look_around() says of the same point, and the search goes up from there; or nothing, and it goes down from the
  /// root. \pre the point is finite: boxes that are not there are as near to a NaN as others, and are looked into
  [[nodiscard]] Hit find_nearest(const Vec3f& point, Hit best, float enough) const;
  /// The nearest of the four triangles around a slot, if it beats `best`.
  [[nodiscard]] Hit look_around(const Vec3f& point, TreeSlot slot, Hit best) const {
    return test_leaf(point, slot.value / 4, best);
  }

  /// Calls visit(slot) for triangles near a segment, all that it meets among them: each once, in an order that follows
  /// from the tree, until it returns false.
  template <class Visit>
  void visit_along(const Vec3d& from, const Vec3d& to, const Visit& visit) const;

  /// The nearest triangle that beats `best` and that accept(triangle) takes, else `best`. The nearer `best`, the fewer
  /// are looked at.
  template <class Accept>
  [[nodiscard]] Hit find_nearest_of(const Vec3f& point, Hit best, const Accept& accept) const;
  /// Of the four triangles around a slot.
  template <class Accept>
  [[nodiscard]] Hit look_around_of(const Vec3f& point, TreeSlot slot, Hit best, const Accept& accept) const {
    return test_leaf_of(point, slot.value / 4, best, accept);
  }

  /// Of the four triangles around a slot the one that is best for all three points: the distance of the farthest of
  /// them. The distance to a triangle is convex, so that whatever lies between the points is no farther.
  [[nodiscard]] Hit look_around(const std::array<Vec3f, 3>& points, TreeSlot slot) const;

 private:
  struct Node {
    std::array<std::array<float, 4>, 3> low, high;  ///< [axis][child]
  };
  using Leaf = FourTriangles;
  struct HeldLeaf {
    Leaf triangles;
    FourTriangleTerms terms;
  };
  /// Of a leaf that is made when it is looked at.
  struct CachedLeaf {
    HeldLeaf held;
    std::uint64_t tree = 0;  ///< its serial number
    std::uint32_t index = 0;
  };
  struct Item {
    std::array<float, 3> center;
    std::uint32_t triangle;
  };

  void set_frame();
  void sort_items(std::span<Item> items) const;
  [[nodiscard]] std::size_t leaf_count() const { return (slot_triangle_.size() + 3) / 4; }
  [[nodiscard]] Leaf make_leaf(std::size_t index) const;
  /// A leaf that is held, or made, unless this thread has it from a look before: then good until the next look.
  [[nodiscard]] const HeldLeaf& leaf_at(std::uint32_t index) const {
    return leaves_.empty() ? made_leaf(index) : leaves_[index];
  }
  [[nodiscard]] const HeldLeaf& made_leaf(std::uint32_t index) const;
  void fill_nodes();
  void fill_capsules();
  [[nodiscard]] Hit test_leaf(const Vec3f& point, std::uint32_t leaf, Hit best) const;
  template <class Accept>
  [[nodiscard]] Hit test_leaf_of(const Vec3f& point, std::uint32_t leaf, Hit best, const Accept& accept) const;

  Surface surface_;
  Vec3d center_{0.0};
  double scale_ = 1.0;
  UnsetVector<std::uint32_t> slot_triangle_;
  UnsetVector<HeldLeaf> leaves_;  ///< or none, where they are made
  std::uint64_t serial_ = 0;      ///< no other tree of the process has it
  UnsetVector<Node> nodes_;
  std::vector<FourCapsules> capsules_;      ///< by node, where some vertex has very many triangles
  std::vector<std::uint32_t> level_start_;  ///< of nodes_, from the root; node i of a level has children 4i … 4i+3

  /// In the frame: how far rounding may move a corner, a ray's end and a box's side, generously.
  static constexpr float kRayGrace = 2e-6F;
};

template <class Accept>
SurfaceTree::Hit SurfaceTree::test_leaf_of(const Vec3f& point, std::uint32_t leaf, Hit best,
                                           const Accept& accept) const {
  const auto& [four, terms] = leaf_at(leaf);
  const Lanes distance2 = distances2_to(four, terms, {lanes(point.x), lanes(point.y), lanes(point.z)});
  for (std::uint32_t k = 0; k < 4 && 4 * leaf + k < size(); ++k) {
    const TreeSlot slot(4 * leaf + k);
    if (distance2[k] < best.distance2 && accept(triangle_at(slot))) best = {slot, distance2[k]};
  }
  return best;
}

template <class Accept>
SurfaceTree::Hit SurfaceTree::find_nearest_of(const Vec3f& point, Hit best, const Accept& accept) const {
  if (nodes_.empty()) return best;
  struct Entry {
    std::uint32_t level, node;
    float distance2;
  };
  std::array<Entry, 3 * kMostBoxLevels + 4> stack;
  std::size_t size = 0;
  stack[size++] = {0, 0, 0.0F};
  const auto depth = static_cast<std::uint32_t>(level_start_.size() - 1);
  while (size > 0) {
    const Entry entry = stack[--size];
    if (!(entry.distance2 < best.distance2)) continue;
    if (entry.level == depth) {
      best = test_leaf_of(point, entry.node, best, accept);
      continue;
    }
    const Node& node = nodes_[level_start_[entry.level] + entry.node];
    Lanes distance2 = lanes(0.0F);
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes at = lanes(point[axis]);
      const Lanes below = load_lanes(node.low[axis].data()) - at, above = at - load_lanes(node.high[axis].data());
      const Lanes outside = max_lanes(max_lanes(below, above), lanes(0.0F));
      distance2 += outside * outside;
    }
    const std::size_t first = size;  // the nearest is looked at first, and so put last
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (!(distance2[k] < best.distance2)) continue;
      std::size_t at = size++;
      for (; at > first && stack[at - 1].distance2 < distance2[k]; --at) stack[at] = stack[at - 1];
      stack[at] = {entry.level + 1, 4 * entry.node + k, distance2[k]};
    }
  }
  return best;
}

template <class Visit>
void SurfaceTree::visit_along(const Vec3d& from, const Vec3d& to, const Visit& visit) const {
  if (nodes_.empty()) return;
  const Vec3f start = to_frame(from), along = to_frame(to) - start;
  std::array<Lanes, 3> origin, per_axis;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float kLeast = 1e-18F;  // a side that the ray runs along: its reciprocal is finite
    const float d = along[axis];
    origin[axis] = lanes(start[axis]);
    per_axis[axis] = lanes(1.0F / (std::abs(d) > kLeast ? d : kLeast));
  }
  struct Entry {
    std::uint32_t level, node;
  };
  std::array<Entry, 3 * kMostBoxLevels + 1> stack;
  std::size_t size = 0;
  stack[size++] = {0, 0};
  const auto depth = static_cast<std::uint32_t>(level_start_.size() - 1);
  while (size > 0) {
    const Entry entry = stack[--size];
    const Node& node = nodes_[level_start_[entry.level] + entry.node];
    Lanes first = lanes(0.0F), last = lanes(1.0F);
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes low = load_lanes(node.low[axis].data()), high = load_lanes(node.high[axis].data());
      const Lanes a = (low - kRayGrace - origin[axis]) * per_axis[axis];
      const Lanes b = (high + kRayGrace - origin[axis]) * per_axis[axis];
      first = max_lanes(first, min_lanes(a, b));
      last = min_lanes(last, max_lanes(a, b));
    }
    const LaneMask is_there = load_lanes(node.low[0].data()) <= load_lanes(node.high[0].data());
    const LaneMask is_met = (first <= last) & is_there;
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (is_met[k] == 0) continue;
      const std::uint32_t child = 4 * entry.node + k;
      if (entry.level + 1 < depth) {
        stack[size++] = {entry.level + 1, child};
      } else {
        for (std::uint32_t slot = 4 * child; slot < std::min(4 * child + 4, this->size()); ++slot) {
          if (!visit(TreeSlot(slot))) return;
        }
      }
    }
  }
}

/// A triangle within `enough` of the point, or the nearest. The search begins at `hint`, if there is one.
[[nodiscard]] inline SurfaceTree::Hit find_near(const SurfaceTree& tree, const Vec3d& point, TreeSlot hint,
                                                double enough) {
  const Vec3f at = tree.to_frame(point);
  const float enough2 = tree.squared_in_frame(enough);
  SurfaceTree::Hit hit;
  if (hint.is_valid()) hit = tree.look_around(at, hint, hit);
  return hit.distance2 <= enough2 ? hit : tree.find_nearest(at, hit, enough2);
}
[[nodiscard]] inline double distance_at(const SurfaceTree& tree, const Vec3d& point, TreeSlot slot) {
  return slot.is_valid() ? std::sqrt(tree.distance2_at(point, slot)) : 0.0;
}

}  // namespace meshlode::builder
