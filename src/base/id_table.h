// SPDX-License-Identifier: MIT
// A hash table of ids that are looked up by what they stand for: open addressing, linear probing, at most two thirds
// full (Knuth, The Art of Computer Programming, vol. 3, 6.4). It holds ids alone: their keys stay in the caller's
// arrays. Nobody can walk over its slots, so that what a caller gets depends on the order of its insertions, never on
// the hash (I10).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "base/random.h"
#include "base/vec.h"

namespace meshlode {

/// Hashes a key word by word: h = hash_word(hash_word(0, first), second). The low bits are spread as well as the high.
constexpr std::uint64_t hash_word(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * kGoldenGamma;
  return hash ^ hash >> 32U;
}

/// Of a point of a grid.
inline std::uint64_t hash_point(const Vec3i& point) {
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) hash = hash_word(hash, static_cast<std::uint32_t>(point[k]));
  return hash;
}

class IdTable {
 public:
  IdTable() = default;
  /// With room for `count` ids before it first grows.
  explicit IdTable(std::size_t count) : slots_(slots_for(count), kFree) {}

  struct Entry {
    std::uint32_t id;
    bool is_new;
  };

  /// The id that `is_same` accepts, or `next`, which is then in. `hash` is that of the key searched; `hash_of` gives
  /// the hash of an id that is already in, and is asked where the table grows. \pre next < 2^32 - 1
  template <class IsSame, class HashOf>
  Entry find_or_insert(std::uint64_t hash, std::uint32_t next, const IsSame& is_same, const HashOf& hash_of) {
    if (slots_for(count_ + 1) > slots_.size()) grow(hash_of);
    std::uint32_t* const slots = slots_.data();  // what is_same reads could be anything, to the compiler
    const std::size_t size = slots_.size();
    std::size_t at = first_slot(hash, size);
    for (; slots[at] != kFree; at = next_slot(at, size)) {
      if (const std::uint32_t id = slots[at]; is_same(id)) return {id, false};
    }
    slots[at] = next;
    ++count_;
    return {next, true};
  }

  /// The id that `is_same` accepts, or kNoId. Side by side with itself.
  template <class IsSame>
  [[nodiscard]] std::uint32_t find(std::uint64_t hash, const IsSame& is_same) const {
    if (slots_.empty()) return kNoId;
    const std::size_t size = slots_.size();
    for (std::size_t at = first_slot(hash, size); slots_[at] != kFree; at = next_slot(at, size)) {
      if (const std::uint32_t id = slots_[at]; is_same(id)) return id;
    }
    return kNoId;
  }

  /// Tells the processor that the slot of this hash will be asked for soon: tables are larger than its caches.
  void prefetch(std::uint64_t hash) const {
    if (!slots_.empty()) __builtin_prefetch(&slots_[first_slot(hash, slots_.size())]);
  }

  /// All of 0 … count - 1 into an empty table with room for `more` besides, in any order and on any thread:
  /// `for_each(count, insert)` calls insert(id) once for each. Who comes first takes the nearer slot, which no later
  /// call can tell. `hash_of` gives the hash of an id. \pre their keys are distinct
  template <class ForEach, class HashOf>
  void fill(std::uint32_t count, std::size_t more, const ForEach& for_each, const HashOf& hash_of) {
    slots_.assign(slots_for(count + more), kFree);
    count_ = count;
    for_each(count, [&](std::uint32_t id) {
      const std::size_t size = slots_.size();
      for (std::size_t at = first_slot(hash_of(id), size);; at = next_slot(at, size)) {
        std::uint32_t expected = kFree;
        // std::atomic_ref, which libc++ 14 lacks.
        const bool is_mine =
            __atomic_compare_exchange_n(&slots_[at], &expected, id, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
        if (is_mine) return;
      }
    });
  }

  [[nodiscard]] std::size_t size() const { return count_; }

 private:
  static constexpr std::uint32_t kFree = 0xFFFFFFFFU;

  [[nodiscard]] static constexpr std::size_t slots_for(std::size_t count) { return count + count / 2 + 2; }
  /// The low half of the hash as a share of all slots: any number of these will do.
  [[nodiscard]] static constexpr std::size_t first_slot(std::uint64_t hash, std::size_t size) {
    return static_cast<std::size_t>((hash & 0xFFFFFFFFU) * size >> 32U);
  }
  [[nodiscard]] static constexpr std::size_t next_slot(std::size_t at, std::size_t size) {
    return at + 1 == size ? 0 : at + 1;
  }

  template <class HashOf>
  void grow(const HashOf& hash_of) {
    std::vector<std::uint32_t> old(std::max<std::size_t>(64, 3 * slots_.size()), kFree);
    old.swap(slots_);
    for (const std::uint32_t id : old) {
      if (id == kFree) continue;
      std::size_t at = first_slot(hash_of(id), slots_.size());
      while (slots_[at] != kFree) at = next_slot(at, slots_.size());
      slots_[at] = id;
    }
  }

  std::vector<std::uint32_t> slots_;  ///< ids, or kFree
  std::size_t count_ = 0;
};

}  // namespace meshlode
