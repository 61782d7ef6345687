// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/ply_colors.h"

#include <algorithm>
#include <utility>

#include "scene/import/polygons/display_levels.h"

namespace meshlode::scene {

std::vector<Vec4f> PlyColors::take(bool is_linear, std::uint64_t& clamped) {
  const int components = has_alpha ? 4 : 3;
  float largest = 0.0F;
  for (const Vec4f& color : raw) {
    for (int c = 0; c < components; ++c) largest = std::max(largest, color[c]);
  }
  const bool is_wide = size_of(type) > 1 && largest > 255.0F;
  const double scale = is_float(type) ? 255.0 : is_wide ? 255.0 / 65535.0 : 1.0;
  for (Vec4f& color : raw) {
    bool is_clamped = false;
    for (int c = 0; c < 4; ++c) {
      const double level = c < components ? static_cast<double>(color[c]) * scale : 255.0;
      is_clamped = is_clamped || !(level >= 0.0 && level <= 255.0);
      // Eight bits of whatever type; NaN becomes 0.
      const auto byte = static_cast<std::uint8_t>(level >= 0.0 ? std::min(level + 0.5, 255.0) : 0.0);
      color[c] = color_of_level(byte, c < 3 && !is_float(type) && !is_linear);
    }
    clamped += is_clamped ? 1U : 0U;
  }
  return std::exchange(raw, {});
}

}  // namespace meshlode::scene
