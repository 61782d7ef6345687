// SPDX-License-Identifier: GPL-3.0-or-later
// Mutations of an asset whose checksums fit again afterwards, 15 times of 16, so that what lies behind them is reached.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/reseal.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace meshlode::fuzz {

/// The asset begins behind `prefix` bytes, which are mutated too. Returns the new size.
inline std::size_t mutate_asset(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned int seed,
                                std::size_t prefix) {
  size = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 16 == 0 || size <= prefix) return size;
  std::vector<std::uint8_t> bytes(data + prefix, data + size);
  test::reseal(bytes);
  std::copy(bytes.begin(), bytes.end(), data + prefix);
  return size;
}

}  // namespace meshlode::fuzz
