// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/picture_distance.h"

#include <algorithm>
#include <cmath>

namespace meshlode::judge {

namespace {

using draw::VisibilityBuffer;

/// How far depths may be apart: a share of the nearer one, for perspective depth is 1 over the distance, or of the
/// whole range, where it is linear; and one step of a float below 1, which is the depth of the near plane.
constexpr double kDepthShare = 0x1p-12;
constexpr double kDepthRange = 0x1p32;
constexpr double kDepthStep = 0x1p-24 * kDepthRange;

/// Pixels of a frame that may differ, and be astray: of its width and height together. What a small move changes lies
/// along edges, which grow with the sides of a picture and not with its area.
constexpr std::uint64_t kSidesPerDiffering = 4, kSidesPerAstray = 32;

bool has_surface(const VisibilityBuffer& picture, std::size_t at) {
  return picture.item[at] != VisibilityBuffer::kNothing;
}

double allowed_between(double depth, double other, bool is_orthographic) {
  return kDepthStep + kDepthShare * (is_orthographic ? kDepthRange : std::max(depth, other));
}

/// What the CPU's picture has at a pixel and the eight around it.
struct Neighbourhood {
  bool has_background = false, has_surface = false;
  double low = kDepthRange, high = 0.0;  ///< depths
};

Neighbourhood look_around(const VisibilityBuffer& cpu, std::uint32_t x, std::uint32_t y) {
  Neighbourhood out;
  for (std::uint32_t v = y - std::min(y, 1U); v <= std::min(y + 1, cpu.height - 1); ++v) {
    for (std::uint32_t u = x - std::min(x, 1U); u <= std::min(x + 1, cpu.width - 1); ++u) {
      const std::size_t at = std::size_t{v} * cpu.width + u;
      if (!has_surface(cpu, at)) {
        out.has_background = true;
        continue;
      }
      out.has_surface = true;
      out.low = std::min(out.low, static_cast<double>(cpu.depth[at]));
      out.high = std::max(out.high, static_cast<double>(cpu.depth[at]));
    }
  }
  return out;
}

std::string depth_in_words(const VisibilityBuffer& picture, std::size_t at) {
  return has_surface(picture, at) ? "depth " + std::to_string(picture.depth[at]) : "nothing";
}

}  // namespace

PictureDistance measure_distance(const VisibilityBuffer& cpu, const VisibilityBuffer& drawn, bool is_orthographic) {
  PictureDistance out;
  out.may_differ = (std::uint64_t{cpu.width} + cpu.height) / kSidesPerDiffering;
  out.may_be_astray = (std::uint64_t{cpu.width} + cpu.height) / kSidesPerAstray;
  for (std::size_t at = 0; at < cpu.pixel_count(); ++at) {
    const bool is_drawn = has_surface(drawn, at), is_covered = has_surface(cpu, at);
    const auto expected = static_cast<double>(cpu.depth[at]), depth = static_cast<double>(drawn.depth[at]);
    const double allowed = allowed_between(depth, expected, is_orthographic);
    out.covered += is_covered ? 1 : 0;
    if (is_drawn == is_covered && (!is_drawn || std::fabs(depth - expected) <= allowed)) continue;
    const auto x = static_cast<std::uint32_t>(at % cpu.width), y = static_cast<std::uint32_t>(at / cpu.width);
    const Neighbourhood near = look_around(cpu, x, y);
    const bool is_astray = is_drawn ? !near.has_surface || depth < near.low - allowed || depth > near.high + allowed
                                    : !near.has_background;
    const bool is_first = is_astray ? out.astray == 0 : out.differing == 0;
    ++out.differing;
    out.astray += is_astray ? 1 : 0;
    if (!is_first) continue;
    out.first = "pixel " + std::to_string(x) + "," + std::to_string(y) + ": " + depth_in_words(drawn, at) +
                ", the CPU's " + depth_in_words(cpu, at);
  }
  return out;
}

std::string describe(const PictureDistance& distance) {
  return std::to_string(distance.differing) + " pixels differ (" + std::to_string(distance.may_differ) + " may), " +
         std::to_string(distance.astray) + " by more than a pixel (" + std::to_string(distance.may_be_astray) +
         " may)" + (distance.first.empty() ? "" : "; " + distance.first);
}

}  // namespace meshlode::judge
