// SPDX-License-Identifier: GPL-3.0-or-later
// The grid of one UV set: uv = 2^log2 · q with |q| < 2^24, so that a float holds every decoded value exactly.
#pragma once

#include <cstdint>

namespace meshlode::builder {

/// Exponents for which every integer below 2^24 in magnitude decodes to a finite, normal float.
constexpr std::int32_t kMinUvLog2 = -126;
constexpr std::int32_t kMaxUvLog2 = 104;
constexpr std::int32_t kMaxUvInteger = (1 << 24) - 1;

/// Smallest and largest finite coordinate of a UV set, over u and v and every level of the DAG.
struct UvRange {
  float min = 0.0F, max = 0.0F;
  bool is_empty = true;
  void add(float value);  ///< a value that is not finite is left out
};

/// The largest error that nobody sees where no texture's size is known: an eighth of a texel of a texture with 2,048
/// texels a side, and as much finer as the coordinates span less than a unit square.
[[nodiscard]] double default_uv_error(const UvRange& range);

/// The coarsest step 2^log2 that moves no coordinate by more than `error`. Where that would need |q| >= 2^24, or a step
/// that floats lack, the finest step that is possible. \pre error > 0
[[nodiscard]] std::int32_t choose_uv_log2(const UvRange& range, double error);

/// Nearest integer, halves upward; clamped to the format's range; 0 where the value is not finite.
[[nodiscard]] std::int32_t quantize_uv(float value, std::int32_t log2);

}  // namespace meshlode::builder
