// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/block_counts.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

namespace meshlode::builder {

namespace {

constexpr std::size_t kFewSquares = 4096;  // of small numbers, which are summed up in 32 bits

}  // namespace

BlockCounts::BlockCounts(const MaskBox& box, unsigned halvings)
    : halvings_(halvings),
      columns_(((std::size_t{32} * static_cast<std::size_t>(box.words()) - 1) >> halvings) + 1),
      rows_(((static_cast<std::size_t>(box.rows()) / 2 - 1) >> halvings) + 1),
      most_(std::size_t{4} << 2 * halvings),
      counts_(columns_ * rows_, 0) {}

void BlockCounts::add_word(std::size_t word, std::size_t block_row, std::uint64_t lower, std::uint64_t upper,
                           int sign) {
  if ((lower | upper) == 0) return;
  if (halvings_ > 0) {
    std::int32_t* at = counts_.data() + (block_row >> halvings_) * columns_ + (32 * word >> halvings_);
    // Of a large block the word is a part.
    const unsigned wide = std::min(64U, 2U << halvings_);
    const std::uint64_t first = ~std::uint64_t{0} >> (64 - wide);
    for (unsigned x = 0; x < 64; x += wide, ++at) {
      *at += sign * (std::popcount(lower >> x & first) + std::popcount(upper >> x & first));
    }
    return;
  }
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
  most_ *= 4;
}

namespace {

/// As BlockCounts::sum_of_squares, where a Sum holds each square's sum. Most calls are of small blocks, and of 16 bits
/// a processor adds and squares twice and four times as many at once as of 32.
template <class Sum>
std::int64_t sum_squares(std::span<const std::int32_t> counts, std::size_t columns, std::size_t side) {
  const std::size_t rows = counts.size() / columns, wide = columns + side - 1;
  std::vector<Sum> column_sums(wide, 0);      // of the last `side` rows' row sums
  std::vector<Sum> row_sums(side * wide, 0);  // of these rows, in a ring
  std::vector<Sum> padded(columns + 2 * (side - 1), 0);
  std::int64_t total = 0;
  for (std::size_t y = 0; y < rows + side - 1; ++y) {
    Sum* ring = row_sums.data() + (y % side) * wide;
    for (std::size_t x = 0; x < wide; ++x) column_sums[x] = static_cast<Sum>(column_sums[x] - ring[x]);
    if (y < rows) {
      const std::int32_t* row = counts.data() + y * columns;
      for (std::size_t x = 0; x < columns; ++x) padded[side - 1 + x] = static_cast<Sum>(row[x]);
      std::copy(padded.data(), padded.data() + wide, ring);
      for (std::size_t k = 1; k < side; ++k) {
        const Sum* shifted = padded.data() + k;
        for (std::size_t x = 0; x < wide; ++x) ring[x] = static_cast<Sum>(ring[x] + shifted[x]);
      }
      for (std::size_t x = 0; x < wide; ++x) column_sums[x] = static_cast<Sum>(column_sums[x] + ring[x]);
    } else {
      std::fill(ring, ring + wide, Sum{0});
    }
    if constexpr (sizeof(Sum) == sizeof(std::int16_t)) {
      for (std::size_t first = 0; first < wide; first += kFewSquares) {
        const std::size_t end = std::min(wide, first + kFewSquares);
        std::int32_t squares = 0;
        for (std::size_t x = first; x < end; ++x) squares += std::int32_t{column_sums[x]} * column_sums[x];
        total += squares;
      }
    } else {
      for (std::size_t x = 0; x < wide; ++x) total += std::int64_t{column_sums[x]} * column_sums[x];
    }
  }
  return total;
}

}  // namespace

std::int64_t BlockCounts::sum_of_squares(std::size_t side) const {
  if (counts_.empty()) return 0;
  const std::size_t most = most_ * side * side;
  if (most * most <= 0x7FFFFFFFU / kFewSquares) return sum_squares<std::int16_t>(counts_, columns_, side);
  return sum_squares<std::int32_t>(counts_, columns_, side);
}

}  // namespace meshlode::builder
