// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle's label while a mesh is built: its material and, in the highest eight bits, the gaps between it and the
// next layers above and below it (src/builder/layers). A triangle without gaps has its material's number as its label.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace meshlode::builder {

inline constexpr std::uint32_t kGapShift = 24, kMaterialBits = (1U << kGapShift) - 1;
/// Codes of one gap: 0 is none, 1 the reach, and each further one half of it.
inline constexpr std::uint32_t kNarrowestGap = 15;

/// The codes of the gaps on both sides of a triangle, by its normal.
struct GapPair {
  std::uint32_t above = 0, below = 0;

  [[nodiscard]] static constexpr GapPair of_byte(std::uint32_t byte) { return {byte & 15U, byte >> 4U}; }
  [[nodiscard]] constexpr std::uint8_t byte() const { return static_cast<std::uint8_t>(below << 4U | above); }
  /// The narrower gap of each side.
  constexpr void narrow(const GapPair& other) {
    above = std::max(above, other.above);
    below = std::max(below, other.below);
  }
};

[[nodiscard]] constexpr std::uint32_t material_of(std::uint32_t label) {
  return label & kMaterialBits;
}
[[nodiscard]] constexpr GapPair gap_pair_of(std::uint32_t label) {
  return GapPair::of_byte(label >> kGapShift);
}
[[nodiscard]] constexpr std::uint32_t with_gaps(std::uint32_t label, const GapPair& gaps) {
  return material_of(label) | std::uint32_t{gaps.byte()} << kGapShift;
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
