// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/sample_mask.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace meshlode::builder {

namespace {

constexpr std::int64_t kUnit = 256;  // places are rounded to 1/256 of a sample: what decides a sample is integers

struct Point {
  std::int64_t x, y;
};

std::int64_t floor_div(std::int64_t a, std::int64_t b) {  // b > 0
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// By kUnit, a power of two.
std::int64_t floor_samples(std::int64_t place) {
  static_assert(kUnit == 256);
  return place >> 8;
}

/// One side of a triangle that is not level: the last column it leaves of a row, or the first one, row by row. That is
/// a quotient that changes by the same amount from row to row; its remainder goes along, so that it is exact.
class Side {
 public:
  Side() = default;
  /// From the given row on. Right of it is inside where it goes down, left where it goes up.
  Side(const Point& a, const Point& b, std::int64_t row) {
    const std::int64_t dx = b.x - a.x, dy = b.y - a.y;
    // Inside: dx (y - a.y) - dy (x - a.x) is at least 0, or 1 on the sides whose own samples are the neighbour's.
    const std::int64_t bias = dy > 0 ? 0 : 1;
    const std::int64_t rest = dx * (row * kUnit - a.y) - bias;
    // dy > 0: x at most (rest + dy a.x) / dy. dy < 0: -x at most (rest + dy a.x) / -dy.
    divisor_ = (dy > 0 ? dy : -dy) * kUnit;
    quotient_ = floor_div(rest + dy * a.x, divisor_);
    remainder_ = rest + dy * a.x - quotient_ * divisor_;
    step_ = floor_div(dx * kUnit, divisor_);
    step_remainder_ = dx * kUnit - step_ * divisor_;
  }

  /// The last column, or of a side that goes down the first one with its sign turned.
  [[nodiscard]] std::int64_t bound() const { return quotient_; }
  void next_row() {
    quotient_ += step_;
    remainder_ += step_remainder_;
    const bool is_over = remainder_ >= divisor_;
    quotient_ += is_over ? 1 : 0;
    remainder_ -= is_over ? divisor_ : 0;
  }

 private:
  std::int64_t divisor_ = 1, quotient_ = 0, remainder_ = 0, step_ = 0, step_remainder_ = 0;
};

/// Four columns side by side, as GCC and Clang offer them on every processor.
using FourColumns = std::int32_t __attribute__((vector_size(16)));

/// As Side, sample by sample and without a division: for triangles that are a few samples wide, which most are. Numbers
/// are relative to the first column and row, and small: four columns at once are an instruction of a processor.
template <std::size_t kFours>
class SmallSide {
 public:
  /// From the given column and row on. \pre a and b are within 4 · kFours columns and kFewRows rows of them
  SmallSide(const Point& a, const Point& b, std::int64_t column, std::int64_t row) {
    const auto dx = static_cast<std::int32_t>(b.x - a.x), dy = static_cast<std::int32_t>(b.y - a.y);
    const std::int32_t bias = dy > 0 || (dy == 0 && dx > 0) ? 0 : 1;
    const std::int32_t at =
        dx * static_cast<std::int32_t>(row * kUnit - a.y) - dy * static_cast<std::int32_t>(column * kUnit - a.x) - bias;
    const std::int32_t along = -dy * static_cast<std::int32_t>(kUnit);
    up_ = dx * static_cast<std::int32_t>(kUnit);
    constexpr FourColumns kOdd{0, -1, 0, -1}, kUpper{0, 0, -1, -1};
    at_[0] = at + (along & kOdd) + (2 * along & kUpper);
    for (std::size_t f = 1; f < kFours; ++f) at_[f] = at_[f - 1] + 4 * along;
  }
  /// Not negative inside.
  [[nodiscard]] const FourColumns& at(std::size_t four) const { return at_[four]; }
  void next_row() {
    for (FourColumns& at : at_) at += up_;
  }

 private:
  std::array<FourColumns, kFours> at_{};
  std::int32_t up_ = 0;
};

constexpr std::size_t kMostFours = 4;
constexpr std::size_t kFewColumns = 4 * kMostFours;
/// Sides of a triangle of so many rows and kFewColumns columns stay below 2^31: 2 · (64 · 256) · (66 · 256).
constexpr std::int64_t kFewRows = 64;

/// Columns and rows of a box that hold all samples of a triangle, the last ones included.
struct Extent {
  std::int64_t first_column, last_column, first_row, last_row;
  bool is_few = false;  ///< what SmallSide asks for

  Extent(const std::array<Point, 3>& p, const MaskBox& box) {
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
    first_column = std::max<std::int64_t>(std::int64_t{64} * box.first_word, floor_samples(left + kUnit - 1));
    last_column = std::min<std::int64_t>(std::int64_t{64} * box.end_word - 1, floor_samples(right));
    first_row = std::max<std::int64_t>(box.first_row, floor_samples(low + kUnit - 1));
    last_row = std::min<std::int64_t>(box.end_row - 1, floor_samples(high));
    // The triangle itself, not what the box leaves of it.
    is_few = right - left < static_cast<std::int64_t>(kFewColumns - 1) * kUnit && high - low < (kFewRows - 2) * kUnit &&
             left >= (first_column - 1) * kUnit && low >= (first_row - 1) * kUnit;
  }
  [[nodiscard]] bool is_empty() const { return first_column > last_column || first_row > last_row; }
};

/// As for_each_word(), of a triangle that `is_few`.
template <std::size_t kFours, class Visit>
void for_each_small_row(const std::array<Point, 3>& p, const Extent& extent, const Visit& visit) {
  const auto side = [&](std::size_t k) {
    return SmallSide<kFours>(p[k], p[(k + 1) % 3], extent.first_column, extent.first_row);
  };
  SmallSide<kFours> a = side(0), b = side(1), c = side(2);
  const std::int64_t columns = extent.last_column - extent.first_column + 1;
  const std::uint32_t in_box = 0xFFFFFFFFU >> (32 - static_cast<unsigned>(columns));
  const int word = static_cast<int>(extent.first_column) / 64, shift = static_cast<int>(extent.first_column) & 63;
  for (std::int64_t y = extent.first_row; y <= extent.last_row; ++y) {
    FourColumns outside{}, bit{1, 2, 4, 8};
    for (std::size_t f = 0; f < kFours; ++f, bit <<= 4) outside |= ((a.at(f) | b.at(f) | c.at(f)) >> 31) & bit;
    a.next_row();
    b.next_row();
    c.next_row();
    std::array<std::uint64_t, 2> halves{};
    std::memcpy(halves.data(), &outside, sizeof(outside));
    const std::uint64_t both = halves[0] | halves[1];
    const std::uint32_t inside = ~static_cast<std::uint32_t>(both | both >> 32U) & in_box;
    if (inside == 0) continue;
    visit(static_cast<int>(y), word, std::uint64_t{inside} << shift);
    // A word may end in between.
    const std::uint64_t rest = std::uint64_t{inside} >> 1U >> (63 - shift);
    if (rest != 0) visit(static_cast<int>(y), word + 1, rest);
  }
}

/// Calls visit(y, word, bits) for words of the box in which a counter-clockwise triangle has samples, a bit each.
template <class Visit>
void for_each_word(const std::array<Point, 3>& p, const MaskBox& box, const Visit& visit) {
  const Extent extent(p, box);
  if (extent.is_empty()) return;
  if (extent.is_few) {
    const std::int64_t columns = extent.last_column - extent.first_column + 1;
    if (columns <= 4) {
      for_each_small_row<1>(p, extent, visit);
    } else if (columns <= 8) {
      for_each_small_row<2>(p, extent, visit);
    } else {
      for_each_small_row<kMostFours>(p, extent, visit);
    }
    return;
  }
  const auto visit_run = [&](int y, int first, int last) {
    const int first_word = first / 64, last_word = last / 64;
    const std::uint64_t head = ~std::uint64_t{0} << (first & 63);
    const std::uint64_t tail = ~std::uint64_t{0} >> (63 - (last & 63));
    if (first_word == last_word) {
      visit(y, first_word, head & tail);
      return;
    }
    visit(y, first_word, head);
    for (int w = first_word + 1; w < last_word; ++w) visit(y, w, ~std::uint64_t{0});
    visit(y, last_word, tail);
  };
  // From the lowest corner up two chains of sides bound each row; one of them bends at the middle corner.
  std::size_t low = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (p[k].y < p[low].y || (p[k].y == p[low].y && p[k].x < p[low].x)) low = k;
  }
  const Point &bottom = p[low], &next = p[(low + 1) % 3], &last = p[(low + 2) % 3];
  std::int64_t last_row = extent.last_row;
  // The samples of a level side at the top are the neighbour's.
  if (next.y == last.y && last_row * kUnit == next.y) --last_row;
  // Counter-clockwise: bottom, next, last. Up from the bottom on the right, and down to it on the left.
  const auto fill = [&](std::int64_t first_row, std::int64_t end_row, Side& right, Side& left) {
    for (std::int64_t y = first_row; y < end_row; ++y) {
      const std::int64_t first = std::max(extent.first_column, -left.bound());
      const std::int64_t end = std::min(extent.last_column, right.bound());
      right.next_row();
      left.next_row();
      if (first <= end) visit_run(static_cast<int>(y), static_cast<int>(first), static_cast<int>(end));
    }
  };
  const bool bends_right = next.y < last.y;  // the right chain's side ends before the left one's
  const Point& middle = bends_right ? next : last;
  // Rows up to the middle corner, then those above it.
  const bool has_bend = middle.y > bottom.y;  // else the bottom is a level side
  const std::int64_t bend =
      has_bend ? std::clamp(floor_samples(middle.y) + 1, extent.first_row, last_row + 1) : extent.first_row;
  const bool has_lower = bend > extent.first_row;
  Side right, left;
  if (has_lower) {
    right = Side(bottom, next, extent.first_row);
    left = Side(last, bottom, extent.first_row);
    fill(extent.first_row, bend, right, left);
  }
  if (bend > last_row) return;
  if (next.y == last.y) return;  // nothing is above a level top
  if (bends_right || !has_lower) right = bends_right ? Side(next, last, bend) : Side(bottom, next, bend);
  if (!bends_right || !has_lower) left = bends_right ? Side(last, bottom, bend) : Side(next, last, bend);
  fill(bend, last_row + 1, right, left);
}

std::int64_t area_of(const std::array<Point, 3>& p) {
  return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
}

/// To the nearest unit. Made positive first, so that cutting off rounds down.
std::int64_t rounded(double place) {
  constexpr std::int64_t kFar = std::int64_t{1} << 21U;
  const double positive = (place + static_cast<double>(kFar)) * kUnit;
  const double up = positive + 0.5;
  return static_cast<std::int64_t>(up) - kFar * kUnit;
}

std::array<Point, 3> rounded(const std::array<Vec2d, 3>& corners) {
  std::array<Point, 3> p{};
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = {rounded(corners[k].x), rounded(corners[k].y)};
  }
  return p;
}

}  // namespace

void MaskBox::include(std::span<const Vec2d> points, int side) {
  double left = std::numeric_limits<double>::max(), bottom = left, right = -left, top = -left;
  for (const Vec2d& p : points) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    bottom = std::min(bottom, p.y);
    top = std::max(top, p.y);
  }
  if (points.empty() || right < 0.0 || top < 0.0 || left >= side || bottom >= side) return;
  MaskBox box;
  box.first_word = static_cast<int>(std::max(0.0, left)) / 64;
  box.end_word = static_cast<int>(std::min<double>(side - 1, right)) / 64 + 1;
  box.first_row = static_cast<int>(std::max(0.0, bottom)) / 2 * 2;
  box.end_row = static_cast<int>(std::min<double>(side - 1, top)) / 2 * 2 + 2;
  include(box);
}

void MaskBox::include(const MaskBox& other) {
  if (other.is_empty()) return;
  if (is_empty()) {
    *this = other;
    return;
  }
  first_word = std::min(first_word, other.first_word);
  end_word = std::max(end_word, other.end_word);
  first_row = std::min(first_row, other.first_row);
  end_row = std::max(end_row, other.end_row);
}

void SampleMask::add_triangle(const std::array<Vec2d, 3>& corners) {
  std::array<Point, 3> p = rounded(corners);
  const std::int64_t area = area_of(p);
  if (area == 0) return;
  if (area < 0) std::swap(p[1], p[2]);
  for_each_word(p, box_, [&](int y, int word, std::uint64_t inside) { row(y)[word - box_.first_word] |= inside; });
}

void SampleMask::add_triangle(const std::array<Vec2d, 3>& corners, const std::array<Vec2d, 3>& uv,
                              const AlphaTest& covers) {
  std::array<Point, 3> p = rounded(corners);
  std::array<Vec2d, 3> at = uv;
  const std::int64_t area = area_of(p);
  if (area == 0) return;
  if (area < 0) {
    std::swap(p[1], p[2]);
    std::swap(at[1], at[2]);
  }
  // Affine over the picture: by column and by row, from the first corner.
  const double whole = std::fabs(static_cast<double>(area));
  const auto side = [&](std::size_t a, std::size_t b) {
    return Vec2d(static_cast<double>(p[b].x - p[a].x), static_cast<double>(p[b].y - p[a].y));
  };
  const Vec2d ab = side(0, 1), ac = side(0, 2), to_b = at[1] - at[0], to_c = at[2] - at[0];
  constexpr auto kSample = static_cast<double>(kUnit);
  const Vec2d by_column = (to_b * ac.y - to_c * ab.y) * (kSample / whole);
  const Vec2d by_row = (to_c * ab.x - to_b * ac.x) * (kSample / whole);
  const Vec2d origin(static_cast<double>(p[0].x) / kSample, static_cast<double>(p[0].y) / kSample);
  for_each_word(p, box_, [&](int y, int word, std::uint64_t inside) {
    std::uint64_t& drawn = row(y)[word - box_.first_word];
    const Vec2d start = at[0] + by_row * (y - origin.y) - by_column * origin.x;
    drawn |= covers.of_row(start, by_column, 64 * word, inside & ~drawn);
  });
}

void SampleMask::add(const SampleMask& other) {
  if (other.box_.is_empty()) return;
  for (int y = other.box_.first_row; y < other.box_.end_row; ++y) {
    const std::uint64_t* from = other.row(y);
    std::uint64_t* to = row(y) + (other.box_.first_word - box_.first_word);
    for (int x = 0; x < other.box_.words(); ++x) to[x] |= from[x];
  }
}

namespace {

/// The even bits of a word, side by side.
std::uint64_t even_bits(std::uint64_t x) {
  x &= 0x5555555555555555U;
  x = (x | x >> 1U) & 0x3333333333333333U;
  x = (x | x >> 2U) & 0x0F0F0F0F0F0F0F0FU;
  x = (x | x >> 4U) & 0x00FF00FF00FF00FFU;
  x = (x | x >> 8U) & 0x0000FFFF0000FFFFU;
  return (x | x >> 16U) & 0x00000000FFFFFFFFU;
}

}  // namespace

SampleMask SampleMask::even_samples() const {
  if (box_.is_empty()) return {};
  MaskBox box;
  box.first_word = box_.first_word / 2;
  box.end_word = (box_.end_word + 1) / 2;
  box.first_row = box_.first_row / 4 * 2;
  box.end_row = (box_.end_row + 3) / 4 * 2;
  SampleMask even(box);
  for (int y = std::max(box.first_row, (box_.first_row + 1) / 2); 2 * y < box_.end_row; ++y) {
    const std::uint64_t* from = row(2 * y);
    std::uint64_t* to = even.row(y);
    for (int x = box_.first_word; x < box_.end_word; ++x) {
      to[x / 2 - box.first_word] |= even_bits(from[x - box_.first_word]) << (x % 2 == 0 ? 0U : 32U);
    }
  }
  return even;
}

std::uint64_t SampleMask::count() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t word : words_) sum += static_cast<std::uint64_t>(std::popcount(word));
  return sum;
}

}  // namespace meshlode::builder
