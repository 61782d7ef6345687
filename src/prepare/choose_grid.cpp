// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "prepare/prepare.h"

namespace meshlode {

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

}  // namespace

Result<PositionGrid> choose_grid(double largest_half_extent, double diagonal, double median_edge,
                                 const PrepareOptions& options) {
  PositionGrid grid;
  if (options.grid_step > 0.0) {
    // Nearest mantissa · 2^log2 with a mantissa of at most kMantissaBits, made odd so that it is the only spelling.
    grid.log2 = floor_log2(options.grid_step) - (kMantissaBits - 1);
    auto mantissa = static_cast<std::uint32_t>(std::floor(std::ldexp(options.grid_step, -grid.log2) + 0.5));
    while (mantissa % 2 == 0) {
      mantissa /= 2;
      ++grid.log2;
    }
    grid.mantissa = mantissa;
    if (largest_half_extent / grid.step() > kMaxGridCoordinate / grid.mantissa || grid.log2 < kSmallestLog2 ||
        grid.log2 > kLargestLog2) {
      char text[160];
      std::snprintf(text, sizeof text, "a grid step of %g needs more than 24 bits for an extent of %g", options.grid_step,
                    2.0 * largest_half_extent);
      return Error{ErrorCode::kUnsupported, "", text};
    }
    return grid;
  }
  if (!(diagonal > 0.0)) return grid;  // a single point: any grid will do
  // The farthest a vertex moves is half the diagonal of a cell: step · √3 / 2.
  double step = options.position_budget * diagonal * 2.0 / std::sqrt(3.0);
  if (median_edge > 0.0) step = std::min(step, median_edge / kStepsPerEdge);
  grid.log2 = std::clamp(floor_log2(step), kSmallestLog2, kLargestLog2);
  // 22 bits a coordinate at most: what is left of the 24 is for simplified vertices outside of the box.
  while (largest_half_extent / grid.step() > kMaxGridCoordinate / 4.0 && grid.log2 < kLargestLog2) ++grid.log2;
  return grid;
}

}  // namespace meshlode
