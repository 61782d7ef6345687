// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/uv_grid.h"

#include <algorithm>
#include <cmath>

#include "format/grid.h"

namespace meshlode::builder {

namespace {

/// Largest n with 2^n <= value. \pre value > 0 and finite
std::int32_t floor_log2(double value) {
  return std::ilogb(value);
}

}  // namespace

void UvRange::add(float value) {
  if (!std::isfinite(value)) return;
  min = is_empty ? value : std::min(min, value);
  max = is_empty ? value : std::max(max, value);
  is_empty = false;
}

double default_uv_error(const UvRange& range) {
  const double extent = double(range.max) - double(range.min);
  return format::exp2_exact(-14 + (extent > 0.0 ? std::min(0, floor_log2(extent)) : 0));
}

std::int32_t choose_uv_log2(const UvRange& range, double error) {
  std::int32_t log2 = std::clamp(floor_log2(2.0 * error), kMinUvLog2, kMaxUvLog2);
  const double largest = std::max(std::abs(double(range.min)), std::abs(double(range.max)));
  while (log2 < kMaxUvLog2 && largest > kMaxUvInteger * format::exp2_exact(log2)) ++log2;
  return log2;
}

std::int32_t quantize_uv(float value, std::int32_t log2) {
  if (!std::isfinite(value)) return 0;
  const double q = std::floor(double(value) * format::exp2_exact(-log2) + 0.5);
  return static_cast<std::int32_t>(std::clamp(q, -double(kMaxUvInteger), double(kMaxUvInteger)));
}

}  // namespace meshlode::builder
