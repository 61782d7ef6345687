// SPDX-License-Identifier: GPL-3.0-or-later
// Ways of thinning out cards: blocks of neighbours become one splat each.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "builder/aggregate/blocks.h"
#include "builder/aggregate/card.h"

namespace meshlode::builder {

enum class Thinning : std::uint8_t {
  kInPlace,  ///< one member stays where it is and grows, a blade across alone: for fine levels, whose picture shows
             ///< where things are
  kMoved,    ///< the same at the middle of the block
  kMerged,   ///< at the middle of the block, in the plane of a member and as wide there as the block: the coarse levels
  kNeedle,   ///< the same, but longer than the block and only as wide as its area asks: a little of many pixels is less
             ///< noise than much of one
};
inline constexpr std::array kThinnings{Thinning::kInPlace, Thinning::kMoved, Thinning::kMerged, Thinning::kNeedle};

/// Every card by itself, in its own shape.
[[nodiscard]] Splats splats_of(const Cards& cards, std::span<const std::uint32_t> chosen, std::size_t stride);

/// One splat for each block of `chosen` (numbers in `blocks` are places in it). Which member gives the plane is chosen
/// so that what all together show to each view stays the same: what a block cannot make good is handed on to the next.
[[nodiscard]] Splats thin_out(const Cards& cards, std::span<const std::uint32_t> chosen, const Blocks& blocks,
                              Thinning thinning, std::size_t stride);

}  // namespace meshlode::builder
