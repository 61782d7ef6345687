// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/half_pixels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace meshlode::builder {

namespace {

constexpr int kMargin = 6;  // halves of pixels around what the source covers
constexpr int kHalvesOfWord = 64 / kCardSamples;
static_assert(kCardSamples == 2, "the samples of a half pixel's row are two bits");

int floor_half(int a) {
  return (a - (a & 1)) / 2;
}

/// Of each pair of bits how many are set, added up row by row: the even pairs in nibbles of one word, the odd ones in
/// another's.
struct PairCounts {
  std::uint64_t even = 0, odd = 0;

  void add(std::uint64_t bits) {
    constexpr std::uint64_t kOdd = 0x5555555555555555U, kPairs = 0x3333333333333333U;
    bits = (bits & kOdd) + (bits >> 1U & kOdd);
    even += bits & kPairs;
    odd += bits >> 2U & kPairs;
  }
  [[nodiscard]] std::int32_t of(std::size_t pair) const {
    const std::uint64_t word = pair % 2 == 0 ? even : odd;
    return static_cast<std::int32_t>(word >> (4 * (pair / 2)) & 15U);
  }
};

/// Of a number that is not negative. Without the C library's ceil(), which is a call.
int rounded_up(double x) {
  const int down = static_cast<int>(x);
  return down + (static_cast<double>(down) < x ? 1 : 0);
}

std::size_t index_of(int row, int wide) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(wide);
}

}  // namespace

SourceHalves::SourceHalves(const SampleMask& source, int samples) : half(samples) {
  const MaskBox& box = source.box();
  first_column = 64 * box.first_word / half - kMargin;
  first_row = box.first_row / half - kMargin;
  columns = 64 * box.end_word / half + kMargin + 1 - first_column;
  rows = box.end_row / half + kMargin + 1 - first_row;
  covered.assign(index_of(rows, columns), 0);
  for (int y = box.first_row; y < box.end_row; ++y) {
    const std::uint64_t* row = source.row(y);
    std::int32_t* to = covered.data() + index_of(y / half - first_row, columns);
    for (int x = 0; x < box.words(); ++x) {
      for (std::uint64_t word = row[x]; word != 0; word &= word - 1)
        ++to[(64 * (box.first_word + x) + std::countr_zero(word)) / half - first_column];
    }
  }
}

SourceHalves SourceHalves::coarser() const {
  SourceHalves twice;
  twice.half = 2 * half;
  twice.first_column = floor_half(first_column + kMargin) - kMargin;
  twice.first_row = floor_half(first_row + kMargin) - kMargin;
  twice.columns = floor_half(first_column + columns - kMargin) + 1 + kMargin - twice.first_column;
  twice.rows = floor_half(first_row + rows - kMargin) + 1 + kMargin - twice.first_row;
  twice.covered.assign(index_of(twice.rows, twice.columns), 0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const std::int32_t samples = covered[index_of(y, columns) + static_cast<std::size_t>(x)];
      if (samples == 0) continue;
      twice.covered[index_of(floor_half(first_row + y) - twice.first_row, twice.columns) +
                    static_cast<std::size_t>(floor_half(first_column + x) - twice.first_column)] += samples;
    }
  }
  return twice;
}

HalfPixels::HalfPixels(const SourceHalves& source, const Lattice& lattice, const View& view)
    : view_(view),
      lattice_(lattice),
      scale_(static_cast<double>(source.half) / kCardSamples),
      weight_(source.half * source.half),
      first_column_(source.first_column),
      first_row_(source.first_row),
      columns_(source.columns),
      rows_(source.rows),
      row_words_((columns_ + kHalvesOfWord - 1) / kHalvesOfWord + 1),
      covered_(index_of(kCardSamples * rows_, row_words_), 0),
      excess_(source.covered.size(), 0),
      before_(static_cast<std::size_t>(columns_ + 2 * kHalvesOfWord), 0),
      now_(before_) {
  over_.assign(64 * covered_.size(), 0);
  for (std::size_t block = 0; block < source.covered.size(); ++block) {
    if (source.covered[block] != 0) change_block(block, -kCardSamples * kCardSamples * source.covered[block]);
  }
  source_squares_ = squares_;
}

void HalfPixels::draw(const Corners& card, CardSamples& out) const {
  out.columns = out.rows = out.words = 0;
  std::array<Vec2d, 3> p = lattice_.places(view_, card);
  // A sample is in the middle of what it stands for.
  for (Vec2d& at : p) at = (at + 0.5) / scale_ - 0.5 - double{kCardSamples} * Vec2d(first_column_, first_row_);
  if ((p[1].x - p[0].x) * (p[2].y - p[0].y) < (p[1].y - p[0].y) * (p[2].x - p[0].x)) std::swap(p[1], p[2]);
  // The outermost halves stay empty, so that every other has eight around it.
  const double left = std::max<double>(kCardSamples, std::min({p[0].x, p[1].x, p[2].x}));
  const double right = std::min<double>(kCardSamples * (columns_ - 1) - 1, std::max({p[0].x, p[1].x, p[2].x}));
  const double low = std::max<double>(kCardSamples, std::min({p[0].y, p[1].y, p[2].y}));
  const double high = std::min<double>(kCardSamples * (rows_ - 1) - 1, std::max({p[0].y, p[1].y, p[2].y}));
  if (!(left <= right && low <= high)) return;
  out.first_column = static_cast<int>(left) / kCardSamples;
  out.first_row = static_cast<int>(low) / kCardSamples;
  out.columns = static_cast<int>(right) / kCardSamples + 1 - out.first_column;
  out.rows = static_cast<int>(high) / kCardSamples + 1 - out.first_row;
  out.words = (out.columns - 1) / kHalvesOfWord + 1;
  out.bits.assign(index_of(kCardSamples * out.rows, out.words), 0);
  // Counter-clockwise: on the right sides go up, on the left down.
  struct Side {
    double at = 0.0, slope = 0.0;  // columns: at row 0, and by row
  };
  std::array<Side, 2> rights{Side{right, 0.0}, Side{right, 0.0}}, lefts{Side{left, 0.0}, Side{left, 0.0}};
  std::size_t up = 0, down = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2d a = p[k], side = p[(k + 1) % 3] - a;
    if (side.y == 0.0) continue;
    const double slope = side.x / side.y;
    (side.y > 0.0 ? rights[up++] : lefts[down++]) = {a.x - slope * a.y, slope};
  }
  const int row0 = kCardSamples * out.first_row, column0 = kCardSamples * out.first_column;
  const int last_row = static_cast<int>(high);
  std::uint64_t* row = out.bits.data() + index_of(rounded_up(low) - row0, out.words);
  for (int y = rounded_up(low); y <= last_row; ++y, row += out.words) {
    const double first = std::max({left, lefts[0].at + lefts[0].slope * y, lefts[1].at + lefts[1].slope * y});
    const double last = std::min({right, rights[0].at + rights[0].slope * y, rights[1].at + rights[1].slope * y});
    if (!(first <= last)) continue;
    const int begin = rounded_up(first) - column0, end = static_cast<int>(last) + 1 - column0;
    for (int w = begin / 64; 64 * w < end; ++w) {
      const int from = std::max(0, begin - 64 * w), to = std::min(64, end - 64 * w);
      if (from >= to) continue;
      row[w] = ~std::uint64_t{0} >> static_cast<unsigned>(64 - (to - from)) << static_cast<unsigned>(from);
    }
  }
}

std::int64_t HalfPixels::change_by(const CardSamples& card) {
  std::int64_t beside = 0, own = 0;
  const auto halves = static_cast<std::size_t>(card.columns), words = static_cast<std::size_t>(card.words);
  std::fill_n(before_.begin(), halves + 2, 0);
  const std::uint64_t* bits = card.bits.data();
  for (int y = 0; y < card.rows; ++y, bits += kCardSamples * words) {
    const int row = card.first_row + y;
    for (std::size_t w = 0; w < words; ++w) {
      PairCounts counts;
      const std::size_t first = static_cast<std::size_t>(kCardSamples * card.first_column) + 64 * w;
      const auto shift = static_cast<unsigned>(first % 64);
      const std::uint64_t* at = covered_row(kCardSamples * row) + first / 64;
      for (std::size_t k = 0; k < kCardSamples; ++k, at += row_words_) {
        const std::uint64_t covered = shift == 0 ? at[0] : at[0] >> shift | at[1] << (64 - shift);
        counts.add(bits[k * words + w] & ~covered);
      }
      const std::size_t count = std::min<std::size_t>(kHalvesOfWord, halves - kHalvesOfWord * w);
      for (std::size_t b = 0; b < count; ++b) now_[kHalvesOfWord * w + b + 1] = counts.of(b);
    }
    const std::int32_t* excess = excess_.data() + index_of(row, columns_) + static_cast<std::size_t>(card.first_column);
    for (std::size_t b = 1; b <= halves; ++b) {
      const std::int32_t more = now_[b];
      beside += std::int64_t{more} * excess[b - 1];
      // Four pixels have the half, two of them the one beside or below it too, and one what is across.
      own += more * (4 * (more + now_[b - 1] + before_[b]) + 2 * (before_[b - 1] + before_[b + 1]));
    }
    now_[halves + 1] = 0;
    std::swap(before_, now_);
  }
  return std::int64_t{weight_} * (2 * beside + weight_ * own);
}

void HalfPixels::change(const CardSamples& card, int sign) {
  const auto words = static_cast<std::size_t>(card.words);
  const std::uint64_t* bits = card.bits.data();
  for (int y = 0; y < card.rows; ++y) {
    const int row = card.first_row + y;
    for (std::size_t w = 0; w < words; ++w) {
      PairCounts counts;
      const std::size_t first = static_cast<std::size_t>(kCardSamples * card.first_column) + 64 * w;
      for (std::size_t k = 0; k < kCardSamples; ++k) {
        const std::size_t row_word = index_of(kCardSamples * row + static_cast<int>(k), row_words_);
        std::uint64_t turned = 0;  // samples that come to be covered, or not any more
        for (std::uint64_t left = bits[k * words + w]; left != 0; left &= left - 1) {
          std::uint16_t& over = over_[64 * row_word + first + static_cast<std::size_t>(std::countr_zero(left))];
          const bool was = over != 0;
          over = static_cast<std::uint16_t>(over + sign);
          if (was != (over != 0)) turned |= left & (0 - left);
        }
        if (turned == 0) continue;
        counts.add(turned);
        const auto shift = static_cast<unsigned>(first % 64);
        std::uint64_t* at = covered_.data() + row_word + first / 64;
        at[0] ^= turned << shift;
        if (shift != 0) at[1] ^= turned >> (64 - shift);
      }
      const std::size_t count =
          std::min<std::size_t>(kHalvesOfWord, static_cast<std::size_t>(card.columns) - kHalvesOfWord * w);
      const std::size_t half =
          index_of(row, columns_) + static_cast<std::size_t>(card.first_column) + kHalvesOfWord * w;
      for (std::size_t b = 0; b < count; ++b) {
        if (counts.of(b) != 0) change_block(half + b, sign * weight_ * counts.of(b));
      }
    }
    bits += kCardSamples * words;
  }
}

void HalfPixels::change_block(std::size_t block, std::int32_t more) {
  std::int32_t* at = excess_.data() + block;
  squares_ += std::int64_t{more} * (2 * std::int64_t{*at} + 4 * std::int64_t{more});
  const auto wide = static_cast<std::ptrdiff_t>(columns_);
  for (const std::ptrdiff_t row : {-wide, std::ptrdiff_t{0}, wide}) {
    const std::int32_t side = row == 0 ? 2 * more : more;
    at[row - 1] += side;
    at[row] += 2 * side;
    at[row + 1] += side;
  }
}

}  // namespace meshlode::builder
