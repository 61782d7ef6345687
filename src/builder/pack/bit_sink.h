// SPDX-License-Identifier: GPL-3.0-or-later
// Bits into bytes, lowest bit first.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace meshlode::builder {

class BitSink {
 public:
  void put(std::uint32_t value, std::uint32_t bits) {
    pending_ |= std::uint64_t{value} << count_;
    for (count_ += bits; count_ >= 8; count_ -= 8) {
      bytes_.push_back(static_cast<std::uint8_t>(pending_ & 0xFFU));
      pending_ >>= 8U;
    }
  }
  std::vector<std::uint8_t> finish() {
    if (count_ > 0) bytes_.push_back(static_cast<std::uint8_t>(pending_));
    return std::move(bytes_);
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint64_t pending_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace meshlode::builder
