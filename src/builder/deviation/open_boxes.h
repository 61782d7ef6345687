// SPDX-License-Identifier: GPL-3.0-or-later
// The search through boxes in whole levels, four a node: the children's places follow from the node's own, so that no
// links are stored. What lies in the leaves, how far a box is and in how many dimensions is the tree's matter
// (surface_tree.h, promise/product_search.h).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "base/ids.h"
#include "builder/deviation/lanes.h"

namespace meshlode::builder {

inline constexpr std::size_t kMostBoxLevels = 16;  ///< 4^16 leaves

/// Where each level's nodes begin, from the root; node i of a level has children 4i … 4i+3. The last entry is the count
/// of all.
[[nodiscard]] inline std::vector<std::uint32_t> box_levels(std::size_t leaf_count) {
  std::size_t depth = 1;
  while ((std::size_t{1} << (2 * depth)) < leaf_count) ++depth;
  std::vector<std::uint32_t> start;
  std::size_t at = 0;
  for (std::size_t level = 0; level < depth; ++level) {
    start.push_back(static_cast<std::uint32_t>(at));
    const std::size_t span = std::size_t{1} << (2 * (depth - level));  // leaves below a node of this level
    at += (leaf_count + span - 1) / span;
  }
  start.push_back(static_cast<std::uint32_t>(at));
  return start;
}

/// What is still to be looked at, the nearest last. Eight bytes, so that one store puts it onto the stack.
struct OpenBox {
  std::uint32_t key;  ///< the bits of the squared distance, the lowest two replaced by the child's number
  std::uint32_t
      where;  ///< the parent within its level, and in the lowest four bits its level: 2^28 parents, 2^32 slots

  [[nodiscard]] float distance2() const { return std::bit_cast<float>(key & ~3U); }
  [[nodiscard]] std::uint32_t index() const { return 4 * (where >> 4U) + (key & 3U); }
  [[nodiscard]] std::uint32_t level() const { return (where & 15U) + 1; }
};
using OpenBoxes = std::array<OpenBox, 3 * kMostBoxLevels + 8>;

/// Puts the children that are nearer than `limit` onto the stack, the far ones first. Non-negative floats order like
/// their bits: the child's number goes into the lowest two, and how many near ones are farther is a child's place.
/// Which of them are near, and in what order, is a toss: no branch. Always inline: else the clone for AVX2 calls one
/// that is not.
[[gnu::always_inline]] inline void push_children(std::uint32_t parent, std::uint32_t level, Lanes distance2,
                                                 float limit, OpenBoxes& stack, std::size_t& size) {
  LaneMask bits;
  std::memcpy(&bits, &distance2, sizeof(bits));
  bits &= ~3;
  Lanes lower;
  std::memcpy(&lower, &bits, sizeof(lower));
  const LaneMask is_near = lower < lanes(limit);
  const LaneMask keys = ((bits | LaneMask{0, 1, 2, 3}) & is_near) | ~is_near;  // -1: less than any
  const LaneMask places =
      -((rotate_lanes<1>(keys) > keys) + (rotate_lanes<2>(keys) > keys) + (rotate_lanes<3>(keys) > keys));
  std::array<std::uint32_t, 4> key, place;
  std::memcpy(key.data(), &keys, sizeof(keys));
  std::memcpy(place.data(), &places, sizeof(places));
  const std::uint32_t where = parent << 4U | level;
  for (std::size_t k = 0; k < 4; ++k) stack[size + place[k]] = {key[k], where};  // those that are not near behind all
  size += count_lanes(is_near);
}

/// Looks into leaves, the nearest first. distances2_to(node) says how far its four children are; look_at(leaf) looks
/// into one, and is false where nothing more is wanted; limit() is what only nearer ones matter to. `known`: a leaf
/// that has been looked at, from which the search goes up; kNoId: none, and it goes down from the root.
template <class DistancesTo, class LookAt, class Limit>
[[gnu::always_inline]] inline void search_boxes(std::span<const std::uint32_t> level_start, std::uint32_t known,
                                                const DistancesTo& distances2_to, const LookAt& look_at,
                                                const Limit& limit) {
  const auto depth = static_cast<std::uint32_t>(level_start.size() - 1);
  OpenBoxes stack;
  std::size_t size = 0;
  const auto open = [&](std::uint32_t level, std::uint32_t index) __attribute__((always_inline)) {
    push_children(index, level, distances2_to(level_start[level] + index), limit(), stack, size);
  };
  // Down whatever is on the stack; false where something is near enough. Always inline, as push_children().
  const auto descend = [&]() __attribute__((always_inline)) {
    while (size > 0) {
      const OpenBox box = stack[--size];
      if (!(box.distance2() < limit())) continue;
      if (box.level() < depth) {
        open(box.level(), box.index());
      } else if (!look_at(box.index())) {
        return false;
      }
    }
    return true;
  };
  if (known == kNoId) {
    open(0, 0);
    descend();
    return;
  }
  // Upwards: of each node only the other three children may have something nearer, and mostly none of them has.
  std::uint32_t index = known;
  for (std::uint32_t level = depth; level-- > 0;) {
    const std::uint32_t child = index & 3U;
    index >>= 2U;
    // By a mask: a lane that is written by its number goes through memory.
    const LaneMask is_known = LaneMask{0, 1, 2, 3} == mask_lanes(static_cast<std::int32_t>(child));
    const Lanes distance2 =
        choose(is_known, lanes(std::numeric_limits<float>::infinity()), distances2_to(level_start[level] + index));
    if (!any_lane(distance2 < lanes(limit()))) continue;
    push_children(index, level, distance2, limit(), stack, size);
    if (!descend()) return;
  }
}

}  // namespace meshlode::builder
