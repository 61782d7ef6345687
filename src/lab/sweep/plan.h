// SPDX-License-Identifier: GPL-3.0-or-later
// Which points fit a budget of time, and how finely each is measured: estimated from the first build, the most worth
// first, each once before any is repeated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/sweep/points.h"
#include "lab/sweep/source_measure.h"

namespace meshlode::lab {

/// What the baseline took, wall seconds.
struct BaselineCost {
  double build = 0.0;    ///< one build, and loading what it made
  double measure = 0.0;  ///< deviations and pictures: once an asset
  double draw = 0.0;     ///< one round of timed frames of a point
};

struct PlannedPoint {
  std::size_t point = 0;   ///< of the points given
  double estimate = 0.0;   ///< wall seconds, all rounds
  double first = 0.0;      ///< of these the first round, with what is measured once
  bool is_chosen = false;  ///< it fits
};

/// One for each point, in the order in which they are measured. The baseline is always chosen; then, from the most
/// worth to the least and among equals from the cheapest, all that still fit beside those chosen before. A point of
/// accuracy fits where the first rounds of all that are chosen fill at most nine tenths of the budget; another one
/// where they fill at most half of it, or where all rounds fit into the nine tenths. A point whose asset another chosen
/// one has costs its frames alone, and one whose content another has is not measured again. A budget of 0 is none.
[[nodiscard]] std::vector<PlannedPoint> plan_points(std::span<const Knob> knobs, std::span<const Point> points,
                                                    const BaselineCost& cost, std::uint32_t rounds, double budget);

/// Chooses more of a plan whose first rounds took less than was estimated, by the same rule; their estimates are then
/// scaled by what the others took. Returns how many.
[[nodiscard]] std::size_t choose_more(std::span<const Knob> knobs, std::span<const Point> points,
                                      const BaselineCost& cost, std::uint32_t rounds, double budget, double took,
                                      std::vector<PlannedPoint>& plan);

/// How finely points are measured, where nobody says: by the budget and the scene alone, so that a sweep that goes on
/// measures as it began.
struct Fineness {
  std::uint64_t samples = 0;            ///< area-uniform ones of each mesh, each way
  Searches searches = Searches::kAll;   ///< of the fewest triangles
  std::uint32_t width = 0, height = 0;  ///< of the pictures
  bool is_device_asked = false;         ///< for the time of a frame: a driver takes a second to get ready
};
[[nodiscard]] Fineness choose_fineness(double budget, std::uint64_t meshes, std::uint64_t vertices);

}  // namespace meshlode::lab
