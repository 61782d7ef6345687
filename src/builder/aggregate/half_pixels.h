// SPDX-License-Identifier: GPL-3.0-or-later
// A picture in halves of pixels: how much of each the source covers and how much the cards that stand for it do, one of
// which can be taken out and put in elsewhere without the others being drawn again.
//
// Pixels start every half pixel, so that each is four halves and what it has too much is their sum. The noise is the
// sum of the squares of that over all pixels; how a card changes it follows from what the card covers alone and what is
// too much around there, which is held.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/sample_mask.h"
#include "builder/aggregate/views.h"

namespace meshlode::builder {

/// Samples of a card along half a pixel's side.
inline constexpr int kCardSamples = 2;

/// What the source covers of a view, in halves of pixels.
struct SourceHalves {
  int half = 1;                         ///< samples of the source along half a pixel's side
  int first_column = 0, first_row = 0;  ///< of the lattice, in halves of pixels
  int columns = 0, rows = 0;            ///< some more each way than the source covers
  std::vector<std::int32_t> covered;    ///< samples of the source

  SourceHalves() = default;
  SourceHalves(const SampleMask& source, int samples);
  /// Halves of pixels that are twice as large.
  [[nodiscard]] SourceHalves coarser() const;
};

/// Which samples of a picture a card covers: rows of words, a bit a sample.
struct CardSamples {
  int first_column = 0, first_row = 0;  ///< in halves of pixels; there rows of samples begin
  int columns = 0, rows = 0;            ///< the same: how many
  int words = 0;                        ///< of 64 samples, a row of samples
  std::vector<std::uint64_t> bits;
};

class HalfPixels {
 public:
  /// Without cards. What these have beyond the source's halves is not looked at.
  HalfPixels(const SourceHalves& source, const Lattice& lattice, const View& view);

  void draw(const Corners& card, CardSamples& out) const;
  void add(const CardSamples& card) { change(card, 1); }
  void remove(const CardSamples& card) { change(card, -1); }
  /// What add() would do to squares().
  [[nodiscard]] std::int64_t change_by(const CardSamples& card);

  /// Of what is too much or too little in each pixel, summed up; and of what the source covers.
  [[nodiscard]] double squares() const { return static_cast<double>(squares_); }
  [[nodiscard]] double source_squares() const { return static_cast<double>(source_squares_); }

 private:
  void change(const CardSamples& card, int sign);
  void change_block(std::size_t block, std::int32_t more);
  [[nodiscard]] const std::uint64_t* covered_row(int row) const {
    return covered_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(row_words_);
  }

  View view_;
  Lattice lattice_;
  double scale_;         ///< samples of the source that a card's sample is as long as
  std::int32_t weight_;  ///< of a card's sample; one of the source counts kCardSamples²
  int first_column_, first_row_, columns_, rows_;
  int row_words_;
  std::vector<std::uint16_t> over_;         ///< by sample: how many cards cover it
  std::vector<std::uint64_t> covered_;      ///< the same as bits, with a word more a row
  std::vector<std::int32_t> excess_;        ///< by half pixel: the sum of what the four pixels around it have too much
  std::vector<std::int32_t> before_, now_;  ///< change_by()'s: what a card adds to rows of halves
  std::int64_t squares_ = 0, source_squares_ = 0;
};

}  // namespace meshlode::builder
