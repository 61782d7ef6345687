// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/block_counts.h"

#include <algorithm>
#include <utility>

namespace meshlode::build {

void BlockCounts::add_word(std::size_t word, std::size_t block_row, std::uint64_t lower, std::uint64_t upper,
                           int sign) {
  if ((lower | upper) == 0) return;
  // Two bits a block and row, counted in place (0 … 2), then both rows together in four bits.
  constexpr std::uint64_t kOdd = 0x5555555555555555U, kPairs = 0x3333333333333333U;
  const std::uint64_t low = (lower & kOdd) + (lower >> 1U & kOdd);
  const std::uint64_t high = (upper & kOdd) + (upper >> 1U & kOdd);
  std::uint64_t even = (low & kPairs) + (high & kPairs);
  std::uint64_t odd = (low >> 2U & kPairs) + (high >> 2U & kPairs);
  std::int32_t* at = counts_.data() + block_row * columns_ + 32 * word;
  for (int k = 0; k < 16; ++k, at += 2, even >>= 4U, odd >>= 4U) {
    at[0] += sign * static_cast<std::int32_t>(even & 15U);
    at[1] += sign * static_cast<std::int32_t>(odd & 15U);
  }
}

void BlockCounts::halve() {
  const std::size_t columns = (columns_ + 1) / 2, rows = (rows_ + 1) / 2;
  std::vector<std::int32_t> counts(columns * rows, 0);
  for (std::size_t y = 0; y < rows_; ++y) {
    const std::int32_t* from = counts_.data() + y * columns_;
    std::int32_t* to = counts.data() + y / 2 * columns;
    for (std::size_t x = 0; x < columns_; ++x) to[x / 2] += from[x];
  }
  columns_ = columns;
  rows_ = rows;
  counts_ = std::move(counts);
}

std::int64_t BlockCounts::sum_of_squares(std::size_t side) const {
  const std::size_t wide = columns_ + side - 1;
  std::vector<std::int32_t> column_sums(wide, 0);      // of the last `side` rows' row sums
  std::vector<std::int32_t> row_sums(side * wide, 0);  // of these rows, in a ring
  std::vector<std::int32_t> padded(columns_ + 2 * (side - 1), 0);
  std::int64_t total = 0;
  for (std::size_t y = 0; y < rows_ + side - 1; ++y) {
    std::int32_t* ring = row_sums.data() + (y % side) * wide;
    for (std::size_t x = 0; x < wide; ++x) column_sums[x] -= ring[x];
    if (y < rows_) {
      const std::int32_t* row = counts_.data() + y * columns_;
      std::copy(row, row + columns_, padded.data() + (side - 1));
      for (std::size_t x = 0; x < wide; ++x) ring[x] = padded[x];
      for (std::size_t k = 1; k < side; ++k) {
        const std::int32_t* shifted = padded.data() + k;
        for (std::size_t x = 0; x < wide; ++x) ring[x] += shifted[x];
      }
    } else {
      std::fill(ring, ring + wide, 0);
    }
    std::int64_t squares = 0;
    for (std::size_t x = 0; x < wide; ++x) {
      column_sums[x] += ring[x];
      squares += std::int64_t{column_sums[x]} * column_sums[x];
    }
    total += squares;
  }
  return total;
}

}  // namespace meshlode::build
