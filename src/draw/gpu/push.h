// SPDX-License-Identifier: GPL-3.0-or-later
// Push constants and the shape of dispatches, as shaders/common.glsl has them.
#pragma once

#include <cstdint>

namespace meshlode::draw {

struct Push {
  std::uint64_t frame = 0;
  std::uint32_t pass = 0, depth = 0, a = 0, b = 0;
};

constexpr std::uint32_t kGroupSize = 64;
constexpr std::uint32_t kGroupRow = 32768;

}  // namespace meshlode::draw
