// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle's label while a mesh is built: its material and, in the highest four bits, the gap between it and the next
// layer (src/builder/layers). A triangle without a gap has its material's number as its label.
#pragma once

#include <cmath>
#include <cstdint>

namespace meshlode::builder {

inline constexpr std::uint32_t kGapShift = 28, kMaterialBits = (1U << kGapShift) - 1;
/// Codes: 0 is no gap, 1 the reach, and each further one half of it.
inline constexpr std::uint32_t kNarrowestGap = 15;

[[nodiscard]] constexpr std::uint32_t material_of(std::uint32_t label) {
  return label & kMaterialBits;
}
[[nodiscard]] constexpr std::uint32_t gap_code_of(std::uint32_t label) {
  return label >> kGapShift;
}
[[nodiscard]] constexpr std::uint32_t with_gap(std::uint32_t label, std::uint32_t code) {
  return material_of(label) | code << kGapShift;
}

/// The gap that a code stands for. \pre code > 0
[[nodiscard]] inline double gap_of_code(std::uint32_t code, double reach) {
  return std::ldexp(reach, 1 - static_cast<int>(code));
}
/// The code of the power that is nearest in ratio; 0 for a gap that is wider than the reach.
[[nodiscard]] inline std::uint32_t code_of_gap(double gap, double reach) {
  if (!(gap <= reach)) return 0;
  std::uint32_t code = 1;
  for (double h = reach; code < kNarrowestGap && gap < 0.7 * h; h *= 0.5) ++code;
  return code;
}

}  // namespace meshlode::builder
