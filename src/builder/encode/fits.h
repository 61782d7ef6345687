// SPDX-License-Identifier: GPL-3.0-or-later
// Integer fits that take the slope out of a cluster's values before they are packed: the shear of positions and the
// affine map from position to texture coordinates. Both are exact to undo, because only integers are involved.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::builder {

/// Smallest value of a set and the bits that the rest needs above it.
struct ValueRange {
  std::int32_t minimum = 0;
  std::uint32_t bits = 0;
};
/// \pre least <= most
[[nodiscard]] ValueRange range_between(std::int32_t least, std::int32_t most);
/// \pre at least one value
[[nodiscard]] ValueRange range_of(std::span<const std::int32_t> values);

using RawPosition = std::array<std::uint32_t, 3>;

/// One axis of the positions minus an integer fit of the other two.
struct PositionFit {
  std::uint32_t axis = 0;               ///< that is sheared
  std::array<std::int32_t, 2> slope{};  ///< / 2^format::kShearShift; zero: none
  std::array<ValueRange, 3> range;
  std::vector<RawPosition> raw;  ///< what is stored of each vertex
};
[[nodiscard]] PositionFit fit_positions(std::span<const std::array<std::int32_t, 3>> positions);

/// One coordinate of a UV range, over the raw positions of its vertices.
struct UvFit {
  bool has_slope = false;
  std::array<std::int32_t, 3> slope{};  ///< / 2^shift, each within 10 bits
  std::uint32_t shift = 0;
  ValueRange range;
  std::vector<std::uint32_t> residual;  ///< above range.minimum
};
/// \pre as many values as positions, at least one
[[nodiscard]] UvFit fit_uv(std::span<const std::int32_t> values, std::span<const RawPosition> positions,
                           bool may_have_slope);

}  // namespace meshlode::builder
