// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "builder/prepare/prepare.h"

namespace meshlode::builder {

namespace {

/// An edge should span this many steps at least, or the grid would shape the surface: dense scans get a finer grid.
constexpr double kStepsPerEdge = 8.0;
/// The mantissa of a given step: eight bits keep it within 0.2%, and leave 16 bits of coordinates exact in float.
constexpr int kMantissaBits = 8;
constexpr int kSmallestLog2 = -1000;  // far from denormals
constexpr int kLargestLog2 = 1000;

/// floor(log2(x)) for finite x > 0, exact.
int floor_log2(double x) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return exponent - 1;
}

/// mantissa · 2^log2 with a mantissa of at most so many bits, made odd so that it is the only spelling: nearest to the
/// step, or the largest not above it.
format::PositionGrid spell_step(double step, bool may_round_up, int mantissa_bits = kMantissaBits) {
  format::PositionGrid grid;
  grid.log2 = floor_log2(step) - (mantissa_bits - 1);
  auto mantissa = static_cast<std::uint32_t>(std::floor(std::ldexp(step, -grid.log2) + (may_round_up ? 0.5 : 0.0)));
  while (mantissa % 2 == 0) {
    mantissa /= 2;
    ++grid.log2;
  }
  grid.mantissa = mantissa;
  return grid;
}

/// Errors where coordinates would need more than 24 bits.
Result<format::PositionGrid> checked_grid(const format::PositionGrid& grid, double largest_half_extent,
                                          const char* what, double value) {
  const auto most_steps = format::kMaxGridCoordinate / grid.mantissa;
  if (largest_half_extent / grid.step() > most_steps || grid.log2 < kSmallestLog2 || grid.log2 > kLargestLog2) {
    char text[160];
    std::snprintf(text, sizeof text, "a %s of %g needs more than 24 bits for an extent of %g", what, value,
                  2.0 * largest_half_extent);
    return Error{ErrorCode::kUnsupported, "", text};
  }
  return grid;
}

}  // namespace

Result<format::PositionGrid> choose_grid(double largest_half_extent, double diagonal, double median_edge,
                                         const PrepareOptions& options) {
  if (options.grid_step > 0.0) {
    return checked_grid(spell_step(options.grid_step, true), largest_half_extent, "grid step", options.grid_step);
  }
  if (options.position_error > 0.0) {
    // The farthest a vertex moves is half the diagonal of a cell: step · √3 / 2.
    const double step = options.position_error * 2.0 / std::sqrt(3.0) * (1.0 - 1e-12);
    // A mantissa of many bits comes near to the budget and leaves few for coordinates: as many as the extent allows.
    for (int bits = kMantissaBits; bits > 1; --bits) {
      auto grid =
          checked_grid(spell_step(step, false, bits), largest_half_extent, "position error", options.position_error);
      if (grid) return grid;
    }
    return checked_grid(spell_step(step, false, 1), largest_half_extent, "position error", options.position_error);
  }
  format::PositionGrid grid;
  if (!(diagonal > 0.0)) return grid;  // a single point: any grid will do
  double step = options.position_budget * diagonal * 2.0 / std::sqrt(3.0);
  if (median_edge > 0.0) step = std::min(step, median_edge / kStepsPerEdge);
  grid.log2 = std::clamp(floor_log2(step), kSmallestLog2, kLargestLog2);
  // 22 bits a coordinate at most: what is left of the 24 is for simplified vertices outside of the box.
  while (largest_half_extent / grid.step() > format::kMaxGridCoordinate / 4.0 && grid.log2 < kLargestLog2) ++grid.log2;
  return grid;
}

}  // namespace meshlode::builder
