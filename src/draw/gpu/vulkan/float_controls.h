// SPDX-License-Identifier: GPL-3.0-or-later
// RoundingModeRTE for shaders: SPIR-V lets a device round to nearest or towards zero as it likes unless the module says
// which (SPV_KHR_float_controls, core since SPIR-V 1.4). GLSL can say it for one width only: the compiler keeps one
// execution mode of a kind.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::draw {

/// The module with the capability, and the mode for floats of 32 and 64 bits at every entry point. \pre SPIR-V 1.4 or
/// newer that does not declare the mode; what is no such module comes back as it is
[[nodiscard]] std::vector<std::uint32_t> declare_round_to_nearest_even(std::span<const std::uint32_t> spirv);

}  // namespace meshlode::draw
