// SPDX-License-Identifier: GPL-3.0-or-later
// Which points fit a budget of time: estimated from the first build, the most worth first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "study/sweep/points.h"

namespace meshlode::study {

/// What the baseline took, wall seconds.
struct BaselineCost {
  double build = 0.0;    ///< one build, and loading what it made
  double measure = 0.0;  ///< deviations and pictures: once an asset
  double draw = 0.0;     ///< one round of timed frames of a point
};

struct PlannedPoint {
  std::size_t point = 0;   ///< of the points given
  double estimate = 0.0;   ///< wall seconds, all rounds
  bool is_chosen = false;  ///< it fits
};

/// One for each point, in their order. The baseline is always chosen; then, from the most worth to the least and among
/// equals from the cheapest, all that still fit beside those chosen before. A point whose asset another chosen one has
/// costs its frames alone, and one whose content another has is not measured again. A budget of 0 is none. What is
/// estimated fills at most nine tenths of the budget.
[[nodiscard]] std::vector<PlannedPoint> plan_points(std::span<const Knob> knobs, std::span<const Point> points,
                                                    const BaselineCost& cost, std::uint32_t rounds, double budget);

}  // namespace meshlode::study
