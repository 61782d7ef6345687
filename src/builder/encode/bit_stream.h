// SPDX-License-Identifier: GPL-3.0-or-later
// The bit stream of a cluster: u32 words, bit k is bit k mod 32 of word k / 32, fields lowest bit first.
#pragma once

#include <cstdint>
#include <vector>

namespace meshlode::builder {

class BitWriter {
 public:
  explicit BitWriter(std::vector<std::uint32_t>& words) : words_(words) {}
  /// \pre bits <= 32 and value < 2^bits
  void put(std::uint32_t value, std::uint32_t bits) {
    pending_ |= std::uint64_t{value} << count_;
    count_ += bits;
    if (count_ >= 32) {
      words_.push_back(static_cast<std::uint32_t>(pending_));
      pending_ >>= 32U;
      count_ -= 32;
    }
  }
  /// Zero bits up to a whole word.
  void flush() {
    if (count_ > 0) words_.push_back(static_cast<std::uint32_t>(pending_));
    pending_ = 0;
    count_ = 0;
  }

 private:
  std::vector<std::uint32_t>& words_;
  std::uint64_t pending_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace meshlode::builder
