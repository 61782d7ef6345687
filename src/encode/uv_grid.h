// SPDX-License-Identifier: GPL-3.0-or-later
// The grid of one UV set: uv = 2^log2 · q with |q| < 2^24, so that a float holds every decoded value exactly.
#pragma once

#include <cstdint>

namespace meshlode {

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

/// Step 2^-bits · min(1, the largest power of two <= the range's extent): the range gets at least 2^bits steps, and so
/// does every unit square of a tiled texture. Coordinates too large for that get the finest step that keeps |q| < 2^24.
[[nodiscard]] std::int32_t choose_uv_log2(const UvRange& range, std::uint32_t bits);

/// Nearest integer, halves upward; clamped to the format's range; 0 where the value is not finite.
[[nodiscard]] std::int32_t quantize_uv(float value, std::int32_t log2);

}  // namespace meshlode
