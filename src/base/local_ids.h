// SPDX-License-Identifier: MIT
// Local ids: the distinct numbers of a list become 0, 1, 2 … Looking a number up is a probe or two of a table that fits
// a cache, where sorting the whole list costs a dozen steps for each of its members, of which most are repeats.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/random.h"

namespace meshlode {

/// Open addressing, linear probing, at most half full, multiplicative hashing (Knuth, The Art of Computer Programming,
/// vol. 3, 6.4). What a caller gets depends on the order of its calls alone (I10).
class LocalIds {
 public:
  /// With room for so many distinct numbers before it first grows.
  explicit LocalIds(std::size_t distinct = 64) { resize(std::bit_ceil(2 * distinct + 2)); }

  /// The local id of `number`: how many other numbers came before it. \pre number < 2^32 - 1
  std::uint32_t add(std::uint32_t number) {
    Slot* slot = find(number);
    if (slot->number == number) return slot->id;
    const auto id = static_cast<std::uint32_t>(numbers_.size());
    *slot = {number, id};
    numbers_.push_back(number);
    if (2 * numbers_.size() > slots_.size()) {
      resize(2 * slots_.size());
      for (std::uint32_t i = 0; i < numbers_.size(); ++i) *find(numbers_[i]) = {numbers_[i], i};
    }
    return id;
  }

  /// By local id.
  [[nodiscard]] const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  [[nodiscard]] std::size_t size() const { return numbers_.size(); }

  /// Forgets all and keeps the room.
  void clear() {
    numbers_.clear();
    std::fill(slots_.begin(), slots_.end(), Slot{});
  }

  /// Sorts the numbers. \returns by local id the place of its number among them: local ids that ascend with the
  /// numbers. To be called last: add() knows the old ids alone.
  std::vector<std::uint32_t> sort() {
    std::vector<std::uint32_t> place(numbers_.size());
    std::sort(numbers_.begin(), numbers_.end());
    for (std::uint32_t i = 0; i < numbers_.size(); ++i) place[find(numbers_[i])->id] = i;
    return place;
  }

 private:
  static constexpr std::uint32_t kFree = 0xFFFFFFFFU;
  struct Slot {
    std::uint32_t number = kFree, id = 0;
  };

  void resize(std::size_t slots) {
    slots_.assign(slots, Slot{});
    shift_ = 64U - static_cast<unsigned>(std::bit_width(slots - 1));
  }
  Slot* find(std::uint32_t number) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = number * kGoldenGamma >> shift_;
    while (slots_[at].number != number && slots_[at].number != kFree) at = (at + 1) & mask;
    return &slots_[at];
  }

  std::vector<Slot> slots_;  ///< a power of two of them
  std::vector<std::uint32_t> numbers_;
  unsigned shift_ = 0;  ///< the upper bits of a product are its best
};

}  // namespace meshlode
