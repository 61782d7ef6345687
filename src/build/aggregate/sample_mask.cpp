// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/sample_mask.h"

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace meshlode::build {

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

/// One side of a triangle: what it leaves of a row, row by row. The bound is a quotient that changes by the same amount
/// from row to row; its remainder goes along, so that it is exact.
class Side {
 public:
  /// From the given row on.
  Side(const Point& a, const Point& b, std::int64_t row) {
    const std::int64_t dx = b.x - a.x, dy = b.y - a.y;
    // Inside: dx (y - a.y) - dy (x - a.x) is at least 0, or 1 on the sides whose own samples are the neighbour's.
    const std::int64_t bias = dy > 0 || (dy == 0 && dx > 0) ? 0 : 1;
    const std::int64_t rest = dx * (row * kUnit - a.y) - bias;
    if (dy == 0) {  // all of a row, or nothing
      is_level_ = true;
      quotient_ = rest;
      step_ = dx * kUnit;
      return;
    }
    // dy > 0: x at most (rest + dy a.x) / dy. dy < 0: -x at most (rest + dy a.x) / -dy.
    is_left_ = dy < 0;
    divisor_ = (dy > 0 ? dy : -dy) * kUnit;
    quotient_ = floor_div(rest + dy * a.x, divisor_);
    remainder_ = rest + dy * a.x - quotient_ * divisor_;
    step_ = floor_div(dx * kUnit, divisor_);
    step_remainder_ = dx * kUnit - step_ * divisor_;
  }

  void clip(std::int64_t& first, std::int64_t& last) const {
    if (is_level_) {
      if (quotient_ < 0) first = last + 1;
    } else if (is_left_) {
      first = std::max(first, -quotient_);
    } else {
      last = std::min(last, quotient_);
    }
  }
  void next_row() {
    quotient_ += step_;
    remainder_ += step_remainder_;
    if (remainder_ >= divisor_) {
      remainder_ -= divisor_;
      ++quotient_;
    }
  }

 private:
  bool is_level_ = false, is_left_ = false;
  std::int64_t divisor_ = 1, quotient_ = 0, remainder_ = 0, step_ = 0, step_remainder_ = 0;
};

/// As Side, sample by sample and without a division: for triangles that are a few samples wide, which most are.
class SmallSide {
 public:
  /// From the given column and row on.
  SmallSide(const Point& a, const Point& b, std::int64_t column, std::int64_t row)
      : along_(-(b.y - a.y) * kUnit), up_((b.x - a.x) * kUnit) {
    const std::int64_t dx = b.x - a.x, dy = b.y - a.y;
    const std::int64_t bias = dy > 0 || (dy == 0 && dx > 0) ? 0 : 1;
    at_ = dx * (row * kUnit - a.y) - dy * (column * kUnit - a.x) - bias;
  }
  /// Not negative inside.
  [[nodiscard]] std::int64_t at(std::int64_t column) const { return at_ + along_ * column; }
  void next_row() { at_ += up_; }

 private:
  std::int64_t along_, up_, at_ = 0;
};

/// Columns and rows of a box that hold all samples of a triangle, the last ones included.
struct Extent {
  std::int64_t first_column, last_column, first_row, last_row;

  Extent(const std::array<Point, 3>& p, const MaskBox& box) {
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
    first_column = std::max<std::int64_t>(std::int64_t{64} * box.first_word, floor_samples(left + kUnit - 1));
    last_column = std::min<std::int64_t>(std::int64_t{64} * box.end_word - 1, floor_samples(right));
    first_row = std::max<std::int64_t>(box.first_row, floor_samples(low + kUnit - 1));
    last_row = std::min<std::int64_t>(box.end_row - 1, floor_samples(high));
  }
  [[nodiscard]] bool is_empty() const { return first_column > last_column || first_row > last_row; }
};

/// Calls visit(y, first, last) for each row of the box in which a counter-clockwise triangle has samples.
template <class Visit>
void for_each_row(const std::array<Point, 3>& p, const MaskBox& box, const Visit& visit) {
  const Extent extent(p, box);
  if (extent.is_empty()) return;
  constexpr std::int64_t kFewColumns = 12;
  if (extent.last_column - extent.first_column < kFewColumns) {
    const std::int64_t columns = extent.last_column - extent.first_column + 1;
    const auto side = [&](std::size_t k) {
      return SmallSide(p[k], p[(k + 1) % 3], extent.first_column, extent.first_row);
    };
    SmallSide a = side(0), b = side(1), c = side(2);
    for (std::int64_t y = extent.first_row; y <= extent.last_row; ++y) {
      std::uint32_t inside = 0;
      for (std::int64_t x = 0; x < columns; ++x) {
        const bool is_outside = (a.at(x) | b.at(x) | c.at(x)) < 0;
        inside |= (is_outside ? 0U : 1U) << static_cast<unsigned>(x);
      }
      a.next_row();
      b.next_row();
      c.next_row();
      if (inside == 0) continue;
      visit(static_cast<int>(y), static_cast<int>(extent.first_column) + std::countr_zero(inside),
            static_cast<int>(extent.first_column) + 31 - std::countl_zero(inside));
    }
    return;
  }
  std::array<Side, 3> sides{Side(p[0], p[1], extent.first_row), Side(p[1], p[2], extent.first_row),
                            Side(p[2], p[0], extent.first_row)};
  for (std::int64_t y = extent.first_row; y <= extent.last_row; ++y) {
    std::int64_t first = extent.first_column, last = extent.last_column;
    for (Side& side : sides) {
      side.clip(first, last);
      side.next_row();
    }
    if (first <= last) visit(static_cast<int>(y), static_cast<int>(first), static_cast<int>(last));
  }
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
  for_each_row(p, box_, [&](int y, int first, int last) {
    std::uint64_t* words = row(y);
    const int first_word = first / 64 - box_.first_word, last_word = last / 64 - box_.first_word;
    const std::uint64_t head = ~std::uint64_t{0} << (first & 63);
    const std::uint64_t tail = ~std::uint64_t{0} >> (63 - (last & 63));
    if (first_word == last_word) {
      words[first_word] |= head & tail;
      return;
    }
    words[first_word] |= head;
    for (int w = first_word + 1; w < last_word; ++w) words[w] = ~std::uint64_t{0};
    words[last_word] |= tail;
  });
}

void SampleMask::add_triangle(const std::array<Vec2d, 3>& corners,
                              const std::function<bool(double b, double c)>& covers) {
  std::array<Point, 3> p = rounded(corners);
  const std::int64_t area = area_of(p);
  if (area == 0) return;
  const bool is_turned = area < 0;
  if (is_turned) std::swap(p[1], p[2]);
  const double whole = std::fabs(static_cast<double>(area));
  for_each_row(p, box_, [&](int y, int first, int last) {
    std::uint64_t* words = row(y);
    for (int x = first; x <= last; ++x) {
      std::uint64_t& word = words[x / 64 - box_.first_word];
      const std::uint64_t bit = std::uint64_t{1} << (x & 63);
      if ((word & bit) != 0) continue;
      const Point at{x * kUnit, y * kUnit};
      const double b = static_cast<double>(area_of({p[2], p[0], at})) / whole;
      const double c = static_cast<double>(area_of({p[0], p[1], at})) / whole;
      if (is_turned ? covers(c, b) : covers(b, c)) word |= bit;
    }
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

std::uint64_t SampleMask::count() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t word : words_) sum += static_cast<std::uint64_t>(std::popcount(word));
  return sum;
}

}  // namespace meshlode::build
