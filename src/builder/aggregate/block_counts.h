// SPDX-License-Identifier: GPL-3.0-or-later
// Differences of coverage at the scale of pixels: how many samples more one picture has than another in boxes of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builder/aggregate/sample_mask.h"

namespace meshlode::builder {

/// A number for each block of 2 × 2 samples of a box, or of more.
class BlockCounts {
 public:
  /// Of blocks that have been halved so often; those of 2 × 2 samples are never held then. \pre the box is not empty,
  /// at most 12 times
  explicit BlockCounts(const MaskBox& box, unsigned halvings = 0);

  /// Adds the samples of a word of the box in two rows, times `sign`: the bits of row 2 · block_row and of the next.
  /// \pre with each sign a sample is added once at most
  void add_word(std::size_t word, std::size_t block_row, std::uint64_t lower, std::uint64_t upper, int sign);

  /// Four blocks become one, and so on for larger pixels. \pre at most 12 times, all together; no words are added then
  void halve();

  /// The sum of the squares of the sums over all squares of so many blocks a side, wherever they touch the box; around
  /// it there is nothing.
  [[nodiscard]] std::int64_t sum_of_squares(std::size_t side) const;

 private:
  unsigned halvings_;  ///< before words are added
  std::size_t columns_, rows_;
  std::size_t most_;  ///< samples of a block: no count is above it, with either sign
  std::vector<std::int32_t> counts_;
};

}  // namespace meshlode::builder
