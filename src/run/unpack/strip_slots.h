// SPDX-License-Identifier: MIT
// The slots of one cluster's strips as rows of bytes: how each names its vertex and where the strip turns, spliced from
// the symbols of the stored page. Nothing here waits for a vertex, so that the walk along the strips has little left to
// do.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include <meshlode/page.h>

#include "format/page_streams.h"

namespace meshlode::run {

constexpr std::uint32_t kMaxSlots = format::kMaxClusterTriangles * 3;  ///< every triangle a strip of its own

/// A slot as a byte. In the row of slots kTurnBit says whether the strip turns the other way than at the triangle
/// before (the first triangle of a strip counts as a left turn), in the row of triangles whether it turns right.
constexpr std::uint32_t kFreshBit = 1;  ///< names the next vertex, which is a twin or
constexpr std::uint32_t kTurnBit = 2;
constexpr std::uint32_t kNewBit = 4;  ///< new: the highest bit, so that a shift alone counts them
constexpr std::uint32_t kNewBitIndex = 2;
constexpr std::uint32_t kSlotBytes = 8;  ///< how many bytes there can be

[[nodiscard]] constexpr std::uint32_t slot_byte(std::uint32_t kind) {
  return kind == static_cast<std::uint32_t>(format::SlotKind::kReference) ? 0U
         : kind == static_cast<std::uint32_t>(format::SlotKind::kNew)     ? kFreshBit | kNewBit
                                                                          : kFreshBit;
}

/// The three triangles of a triple, one a byte.
constexpr std::array<std::uint32_t, format::kTripleSymbols> make_triple_bytes() {
  std::array<std::uint32_t, format::kTripleSymbols> table{};
  for (std::uint32_t t = 0; t < format::kTripleSymbols; ++t) {
    for (std::uint32_t rest = t, k = 0; k < 3; ++k, rest /= format::kTriangleSymbols) {
      const std::uint32_t symbol = rest % format::kTriangleSymbols;
      table[t] |= (symbol / format::kSlotKinds * kTurnBit + slot_byte(symbol % format::kSlotKinds)) << 8U * k;
    }
  }
  return table;
}
/// The three slots of a strip's first triangle, one a byte.
constexpr std::array<std::uint32_t, format::kStartSymbols> make_start_bytes() {
  std::array<std::uint32_t, format::kStartSymbols> table{};
  for (std::uint32_t s = 0; s < format::kStartSymbols; ++s) {
    table[s] = slot_byte(s / (format::kSlotKinds * format::kSlotKinds)) |
               slot_byte(s / format::kSlotKinds % format::kSlotKinds) << 8U | slot_byte(s % format::kSlotKinds) << 16U;
  }
  return table;
}
constexpr auto kTripleBytes = make_triple_bytes();
constexpr auto kStartBytes = make_start_bytes();

constexpr std::uint32_t kTurnBitIndex = 1;

/// One bit of eight bytes as eight bits, the first byte's lowest.
[[nodiscard]] inline std::uint32_t gather_bits(const std::uint8_t* bytes, std::uint32_t bit_index) {
  std::uint64_t eight;
  std::memcpy(&eight, bytes, sizeof(eight));
  return static_cast<std::uint32_t>((eight >> bit_index & 0x0101010101010101U) * 0x0102040810204080U >> 56U);
}

class StripSlots {
 public:
  /// Reads a cluster's strips: triples, starts and lengths are as many as its head says. False where they make no
  /// strips of that many triangles, or name another number of vertices.
  bool read(const format::ClusterLayout& layout, const std::uint32_t* triples, const std::uint32_t* starts,
            const std::uint32_t* lengths) {
    const std::uint32_t continued = layout.triangle_count - layout.strip_count;
    std::array<std::uint8_t, format::kMaxClusterTriangles + kChunk> turns;
    std::array<std::uint8_t, format::kMaxClusterTriangles + kChunk> changes;
    for (std::uint32_t i = 0; i < continued; i += 3) {
      const std::uint32_t triple = triples[i / 3];
      if (triple >= format::kTripleSymbols) return false;
      std::memcpy(turns.data() + i, &kTripleBytes[triple], 4);
    }
    find_changes(turns.data(), continued, changes.data());

    std::uint32_t t = 0;     // triangles so far
    std::uint32_t from = 0;  // of them, those that continue a strip
    for (std::uint32_t strip = 0; strip < layout.strip_count; ++strip) {
      const std::uint32_t left =
          layout.triangle_count - t - (layout.strip_count - strip - 1);  // one each for the others
      std::uint32_t more = left - 1;
      if (strip + 1 < layout.strip_count) {
        more = lengths[strip];
        if (more >= left) return false;
        restarts_[strip] = static_cast<std::uint8_t>(t + more + 1);
      }
      if (starts[strip] >= format::kStartSymbols) return false;
      counts_[strip] = static_cast<std::uint8_t>(more);
      turns_[t] = 0;
      std::uint8_t* const slots = &slots_[t + 2 * strip];
      std::memcpy(slots, &kStartBytes[starts[strip]], 4);
      for (std::uint32_t k = 0; k < more; k += kChunk) {
        std::memcpy(&turns_[t + 1 + k], &turns[from + k], kChunk);
        std::memcpy(slots + 3 + k, &changes[from + k], kChunk);
      }
      slots[3] = turns[from];  // against the left turn before it; of no effect where the strip ends
      t += more + 1;
      from += more;
    }
    return count_slots(layout);
  }

  /// Of each slot, in order. Strip k has 3 + more_triangles(k) of them.
  [[nodiscard]] const std::uint8_t* slots() const { return slots_.data(); }
  [[nodiscard]] std::uint32_t more_triangles(std::uint32_t strip) const { return counts_[strip]; }
  [[nodiscard]] std::uint32_t restart(std::uint32_t strip) const { return restarts_[strip]; }
  [[nodiscard]] const std::uint8_t* turns() const { return turns_.data(); }
  [[nodiscard]] std::uint32_t twin_count() const { return twin_count_; }
  /// Calls `visit` with the cluster's vertices that are twins, in order.
  template <class Visit>
  void each_twin(std::uint32_t slot_count, Visit visit) const {
    std::uint32_t vertex = 0;
    for (std::uint32_t word = 0; word * 64 < slot_count; ++word) {
      for (std::uint64_t rest = twins_[word]; rest != 0; rest &= rest - 1) {
        const std::uint64_t before = (rest & (0U - rest)) - 1U;
        visit(vertex + static_cast<std::uint32_t>(std::popcount(fresh_[word] & before)));
      }
      vertex += static_cast<std::uint32_t>(std::popcount(fresh_[word]));
    }
  }
  /// 64 fresh bits.
  [[nodiscard]] std::uint64_t fresh_word(std::uint32_t word) const { return fresh_[word]; }

 private:
  static constexpr std::uint32_t kChunk = 32;  ///< bytes copied at once, and the room behind the rows for that

  /// Where the turn is not that of the byte before.
  static void find_changes(const std::uint8_t* turns, std::uint32_t count, std::uint8_t* changes) {
    std::uint64_t before = 0;
    for (std::uint32_t i = 0; i < count; i += 8) {
      std::uint64_t eight;
      std::memcpy(&eight, turns + i, sizeof(eight));
      const std::uint64_t out = eight ^ ((eight << 8U | before) & kTurnBit * 0x0101010101010101U);
      before = eight >> 56U;
      std::memcpy(changes + i, &out, sizeof(out));
    }
  }

  bool count_slots(const format::ClusterLayout& layout) {
    std::uint32_t fresh = 0;
    twin_count_ = 0;
    for (std::uint32_t word = 0; word * 64 < layout.slot_count; ++word) {
      const std::uint32_t left = layout.slot_count - word * 64;
      const std::uint64_t mask = left < 64 ? (std::uint64_t{1} << left) - 1 : ~std::uint64_t{0};
      std::uint64_t fresh_bits = 0;
      std::uint64_t new_bits = 0;
      for (std::uint32_t k = 0; k < 64 && k < left; k += 8) {
        fresh_bits |= std::uint64_t{gather_bits(&slots_[word * 64 + k], 0)} << k;
        new_bits |= std::uint64_t{gather_bits(&slots_[word * 64 + k], kNewBitIndex)} << k;
      }
      fresh_[word] = fresh_bits & mask;
      twins_[word] = fresh_[word] & ~new_bits;
      fresh += static_cast<std::uint32_t>(std::popcount(fresh_[word]));
      twin_count_ += static_cast<std::uint32_t>(std::popcount(twins_[word]));
    }
    return fresh == layout.vertex_count;
  }

  std::array<std::uint8_t, kMaxSlots + kChunk> slots_{};
  std::array<std::uint8_t, format::kMaxClusterTriangles + kChunk> turns_{};
  std::array<std::uint8_t, format::kMaxClusterTriangles> restarts_, counts_;
  std::array<std::uint64_t, kMaxSlots / 64> fresh_, twins_;
  std::uint32_t twin_count_ = 0;
};

}  // namespace meshlode::run
