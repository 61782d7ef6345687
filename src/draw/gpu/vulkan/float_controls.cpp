// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/vulkan/float_controls.h"

namespace meshlode::draw {

namespace {

// SPIR-V specification, 2.3: five words of header, then instructions of (word count << 16 | opcode) and operands.
constexpr std::uint32_t kMagic = 0x07230203u;
constexpr std::uint32_t kVersion14 = 0x00010400u;
constexpr std::size_t kHeaderWords = 5;
constexpr std::uint32_t kOpEntryPoint = 15, kOpExecutionMode = 16, kOpCapability = 17;
constexpr std::uint32_t kRoundingModeRte = 4462, kRoundingModeRteCapability = 4467;

}  // namespace

std::vector<std::uint32_t> declare_round_to_nearest_even(std::span<const std::uint32_t> spirv) {
  std::vector<std::uint32_t> out(spirv.begin(), spirv.end());
  if (spirv.size() < kHeaderWords || spirv[0] != kMagic || spirv[1] < kVersion14) return out;
  std::vector<std::uint32_t> modes;
  std::size_t after_entry_points = 0;  // where execution modes stand (2.4, logical layout)
  for (std::size_t i = kHeaderWords; i < spirv.size();) {
    const std::uint32_t count = spirv[i] >> 16u;
    if (count == 0 || count > spirv.size() - i) return out;
    if ((spirv[i] & 0xFFFFu) == kOpEntryPoint && count >= 4) {
      for (const std::uint32_t width : {32u, 64u}) {
        modes.insert(modes.end(), {4u << 16u | kOpExecutionMode, spirv[i + 2], kRoundingModeRte, width});
      }
      after_entry_points = i + count;
    }
    i += count;
  }
  if (after_entry_points == 0) return out;
  out.insert(out.begin() + static_cast<std::ptrdiff_t>(after_entry_points), modes.begin(), modes.end());
  const std::uint32_t capability[] = {2u << 16u | kOpCapability, kRoundingModeRteCapability};
  out.insert(out.begin() + kHeaderWords, std::begin(capability), std::end(capability));  // capabilities come first
  return out;
}

}  // namespace meshlode::draw
