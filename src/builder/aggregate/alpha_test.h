// SPDX-License-Identifier: GPL-3.0-or-later
// What a material lets through: whether points with some texture coordinates are drawn. It is asked about whole rows of
// samples, as a triangle has them: a call for each would take longer than what it asks.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <functional>
#include <utility>

#include "base/vec.h"

namespace meshlode::builder {

class AlphaTest {
 public:
  /// Everything is drawn, and nobody need ask.
  AlphaTest() = default;
  /// `of_point(u, v)`: is that point drawn? The same whenever it is asked, and from several threads at once.
  template <class OfPoint>
  requires std::predicate<const OfPoint&, double, double> AlphaTest(
      OfPoint of_point)  // a test by points is one by rows
      : of_row_(
            [of_point = std::move(of_point)](const Vec2d& origin, const Vec2d& step, int first, std::uint64_t asked) {
              std::uint64_t drawn = 0;
              for (std::uint64_t rest = asked; rest != 0; rest &= rest - 1) {
                const int bit = std::countr_zero(rest);
                const Vec2d at = origin + step * static_cast<double>(first + bit);
                drawn |= std::uint64_t{of_point(at.x, at.y) ? 1U : 0U} << bit;
              }
              return drawn;
            }) {}

  /// `of_row(origin, step, first, asked)`: as of_row() below. The same whenever it is asked, and from several threads
  /// at once.
  template <class OfRow>
  requires std::invocable<const OfRow&, const Vec2d&, const Vec2d&, int, std::uint64_t> AlphaTest(OfRow of_row)
      : of_row_(std::move(of_row)) {}

  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(of_row_); }
  /// \pre it is not the one that draws everything; the same below
  [[nodiscard]] bool operator()(double u, double v) const { return of_row_(Vec2d(u, v), Vec2d(0.0), 0, 1) != 0; }
  /// Those of the bits asked about whose points, at origin + (first + bit) · step, are drawn.
  [[nodiscard]] std::uint64_t of_row(const Vec2d& origin, const Vec2d& step, int first, std::uint64_t asked) const {
    return asked != 0 ? of_row_(origin, step, first, asked) : 0;
  }

 private:
  std::function<std::uint64_t(const Vec2d&, const Vec2d&, int, std::uint64_t)> of_row_;
};

}  // namespace meshlode::builder
