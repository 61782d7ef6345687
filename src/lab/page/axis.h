// SPDX-License-Identifier: GPL-3.0-or-later
// Axes: which part of the numbers is shown, where the ticks are, and what stands beside them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshlode::lab::page {

enum class Scale { kLinear, kLog };

/// Multiples of 1, 2 or 5 times a power of ten within [low, high], of the smallest such step that gives at most `most`.
/// Each is the double nearest to its decimal. \pre low < high, finite, most >= 2
[[nodiscard]] std::vector<double> linear_ticks(double low, double high, std::size_t most);

/// Of the sets {1, 2, 5}, {1, 3}, {1} of each decade, then every second, third, … power of ten, the densest that has at
/// most `most` within [low, high]; linear_ticks where {1, 2, 5} has fewer than three. \pre 0 < low < high, most >= 2
[[nodiscard]] std::vector<double> log_ticks(double low, double high, std::size_t most);

/// From `low` at 0 to `high` at 1. A log axis that has zeros to show has them at 0, behind a gap.
struct Axis {
  std::string label;
  std::string unit;  ///< as amount_text() takes it
  Scale scale = Scale::kLinear;
  double low = 0.0, high = 1.0;
  bool has_zero = false;  ///< of a log axis
  std::vector<double> ticks;

  /// 0 to 1 for what is between low and high. Of a log axis zero and what is negative is 0.
  [[nodiscard]] double place(double value) const;
};

struct AxisWish {
  std::string label, unit;
  Scale scale = Scale::kLinear;
  bool is_from_zero = false;  ///< of a linear axis: 0 is shown
  std::size_t most_ticks = 7;
};

/// An axis on which all of the values are whose magnitude is at most 1e300, with room at the ends.
[[nodiscard]] Axis fit_axis(const AxisWish& wish, std::span<const double> values);

}  // namespace meshlode::lab::page
