// SPDX-License-Identifier: MIT
// Fields become bytes, lowest bit first, without a branch: each put stores eight bytes and moves on by the full ones.
#pragma once

#include <cstdint>
#include <cstring>

namespace meshlode::run {

[[nodiscard]] constexpr std::uint64_t low_mask(std::uint32_t bits) {
  return (std::uint64_t{1} << bits) - 1U;
}

class ByteSink {
 public:
  static constexpr std::uint32_t kMaxBits = 56;  ///< of one put

  /// \pre 8 bytes of room behind everything that is put
  explicit ByteSink(std::uint8_t* at) : at_(at) {}

  /// \pre value < 2^bits, bits <= kMaxBits
  void put(std::uint64_t value, std::uint32_t bits) {
    pending_ |= value << count_;
    std::memcpy(at_, &pending_, sizeof(pending_));
    count_ += bits;
    at_ += count_ >> 3U;
    pending_ >>= count_ & 56U;
    count_ &= 7U;
  }

  /// Fields of `bits` bits for each i, as many to a put as fit. \pre bits <= kMaxBits, get(i) < 2^bits
  template <class Get>
  void put_each(std::uint32_t from, std::uint32_t to, std::uint32_t bits, Get get) {
    std::uint32_t i = from;
    if (bits <= kMaxBits / 4) {
      for (; i + 4 <= to; i += 4) {
        const std::uint64_t low = get(i) | get(i + 1) << bits;
        const std::uint64_t high = get(i + 2) | get(i + 3) << bits;
        put(low | high << 2 * bits, 4 * bits);
      }
    } else if (bits <= kMaxBits / 2) {
      for (; i + 2 <= to; i += 2) put(get(i) | get(i + 1) << bits, 2 * bits);
    }
    for (; i < to; ++i) put(get(i), bits);
  }

  void flush() { std::memcpy(at_, &pending_, sizeof(pending_)); }

 private:
  std::uint8_t* at_;
  std::uint64_t pending_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace meshlode::run
