// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lab/page/numbers.h"

namespace meshlode::lab::page {

namespace {

constexpr double kZeroRoom = 0.1;                                 ///< of a log axis' length, where zeros are shown
constexpr double kSmallest = std::numeric_limits<double>::min();  ///< of a log axis; below it is zero
constexpr double kLargest = 1e300;                                ///< so that what is computed of two values is finite

/// The exponent of the power of ten that is at most `value`. \pre value > 0, finite
int decade_of(double value) {
  int exponent = static_cast<int>(std::floor(std::log10(value)));
  // log10 of 1000 may be a little below 3.
  while (exponent < 308 && decimal(1, exponent + 1) <= value) ++exponent;
  while (decimal(1, exponent) > value) --exponent;
  return exponent;
}

std::vector<double> multiples(double low, double high, long long mantissa, int exponent) {
  const double step = decimal(mantissa, exponent);
  std::vector<double> ticks;
  // One more at both ends than division says, which rounds.
  const auto first = static_cast<long long>(std::ceil(low / step)) - 1;
  const auto last = static_cast<long long>(std::floor(high / step)) + 1;
  for (long long i = first; i <= last; ++i) {
    const double tick = i == 0 ? 0.0 : decimal(i * mantissa, exponent);
    if (tick >= low && tick <= high) ticks.push_back(tick);
  }
  return ticks;
}

/// The step after mantissa · 10^exponent among 1, 2, 5, 10, …
void enlarge(long long& mantissa, int& exponent) {
  mantissa = mantissa == 1 ? 2 : mantissa == 2 ? 5 : 1;
  exponent += mantissa == 1 ? 1 : 0;
}

std::vector<double> decades(double low, double high, std::span<const int> mantissas, int every) {
  std::vector<double> ticks;
  for (int exponent = decade_of(low); exponent <= decade_of(high); ++exponent) {
    if (exponent % every != 0) continue;
    for (const int mantissa : mantissas) {
      const double tick = decimal(mantissa, exponent);
      if (tick >= low && tick <= high) ticks.push_back(tick);
    }
  }
  return ticks;
}

/// The range of a linear axis, from tick to tick. An axis of one value gets some room around it.
void widen_linear(Axis& axis, bool is_from_zero, std::size_t most) {
  if (is_from_zero) {
    axis.low = std::min(axis.low, 0.0);
    axis.high = std::max(axis.high, 0.0);
  }
  if (!(axis.low < axis.high)) {
    const double room = axis.low == 0.0 ? 1.0 : std::abs(axis.low) * 0.5;
    axis.low -= room;
    axis.high += room;
  }
  const std::vector<double> ticks = linear_ticks(axis.low, axis.high, most);
  if (ticks.size() < 2) return;
  const double step = ticks[1] - ticks[0];
  // Up to the next tick, so that the ends of the axis are round numbers.
  const double low = ticks.front() <= axis.low ? axis.low : ticks.front() - step;
  const double high = ticks.back() >= axis.high ? axis.high : ticks.back() + step;
  axis.low = low;
  axis.high = high;
}

}  // namespace

std::vector<double> linear_ticks(double low, double high, std::size_t most) {
  const double span = high - low;
  if (!(span > 0.0) || !std::isfinite(span)) return {low};
  long long mantissa = 1;
  int exponent = decade_of(std::max(span / static_cast<double>(most + 1), std::numeric_limits<double>::min()));
  // Steps far smaller than the numbers themselves are no steps of doubles.
  const double largest = std::max(std::abs(low), std::abs(high));
  while (decimal(mantissa, exponent) < largest * 1e-12) enlarge(mantissa, exponent);
  std::vector<double> ticks = multiples(low, high, mantissa, exponent);
  while (ticks.size() > most) {
    enlarge(mantissa, exponent);
    ticks = multiples(low, high, mantissa, exponent);
  }
  return ticks;
}

std::vector<double> log_ticks(double low, double high, std::size_t most) {
  static constexpr std::array kFull = {1, 2, 5}, kHalf = {1, 3, 0};
  const std::vector<double> densest = decades(low, high, kFull, 1);
  if (densest.size() < 3) return linear_ticks(low, high, most);
  if (densest.size() <= most) return densest;
  std::vector<double> ticks = decades(low, high, std::span(kHalf).first(2), 1);
  for (int every = 1; ticks.size() > most; ++every) ticks = decades(low, high, std::span(kHalf).first(1), every);
  return ticks;
}

double Axis::place(double value) const {
  if (scale == Scale::kLinear) return (value - low) / (high - low);
  const double start = has_zero ? kZeroRoom : 0.0;
  if (!(value >= kSmallest)) return 0.0;
  return start + (1.0 - start) * (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low));
}

Axis fit_axis(const AxisWish& wish, std::span<const double> values) {
  Axis axis;
  axis.label = wish.label;
  axis.unit = wish.unit;
  axis.scale = wish.scale;
  const bool is_log = wish.scale == Scale::kLog;
  bool is_first = true;
  for (const double value : values) {
    if (!(std::abs(value) <= kLargest)) continue;
    if (is_log && !(value >= kSmallest)) {
      axis.has_zero = true;
      continue;
    }
    axis.low = is_first ? value : std::min(axis.low, value);
    axis.high = is_first ? value : std::max(axis.high, value);
    is_first = false;
  }
  if (!is_log) {
    widen_linear(axis, wish.is_from_zero, wish.most_ticks);
    axis.ticks = linear_ticks(axis.low, axis.high, wish.most_ticks);
    return axis;
  }
  if (is_first) {  // nothing, or zeros alone
    axis.low = 0.1;
    axis.high = 10.0;
  }
  // A twentieth of the length at each end, at least a factor of 1.1; never beyond the doubles that are normal.
  const double factor = std::max(1.1, std::pow(10.0, 0.05 * (std::log10(axis.high) - std::log10(axis.low))));
  axis.low = std::max(axis.low / factor, kSmallest);
  axis.high = std::min(axis.high * factor, std::numeric_limits<double>::max());
  axis.ticks = log_ticks(axis.low, axis.high, wish.most_ticks);
  return axis;
}

}  // namespace meshlode::lab::page
