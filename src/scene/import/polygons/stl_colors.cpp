// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/stl_colors.h"

#include "scene/import/polygons/display_levels.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

/// Five bits as eight.
std::uint8_t level_of(unsigned five) {
  return static_cast<std::uint8_t>(((five & 31U) * 255U + 15U) / 31U);
}

}  // namespace

StlColors::StlColors(std::string_view header, bool is_linear) : is_linear_(is_linear) {
  constexpr std::string_view kKey = "COLOR=";
  const std::size_t at = header.find(kKey);
  if (at == std::string_view::npos || header.size() - at < kKey.size() + 4) return;
  is_magics_ = true;
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(header[at + kKey.size() + i]); };
  of_header_ = color(byte(0), byte(1), byte(2));
  has_alpha_ = byte(3) != 255;
  has_material_ = header.find("MATERIAL=") != std::string_view::npos;
}

Vec4f StlColors::color(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const {
  return {color_of_level(red, !is_linear_), color_of_level(green, !is_linear_), color_of_level(blue, !is_linear_),
          1.0F};
}

std::optional<Vec4f> StlColors::color_of(std::uint16_t attribute) {
  const std::uint8_t low = level_of(attribute), middle = level_of(attribute >> 5U), high = level_of(attribute >> 10U);
  const bool has_bit = (attribute & 0x8000U) != 0;
  const bool is_of_header = attribute == 0x8000U || attribute == 0xFFFFU || is_all_zero_;
  if (is_magics_) return is_of_header ? of_header_ : color(low, middle, high);
  if (has_bit) return color(high, middle, low);
  if (attribute != 0) ++unknown_;
  return std::nullopt;
}

void StlColors::report(std::vector<LeftOut>& left_out) const {
  if (unknown_ != 0) {
    left_out.push_back({"attribute bytes", "of " + counted(unknown_, "facet") + ": they are no colour"});
  }
  if (has_alpha_) left_out.push_back({"the alpha of COLOR= in the header", "facets are opaque"});
  if (has_material_) left_out.push_back({"MATERIAL= in the header", "only its COLOR= is read"});
}

}  // namespace meshlode::scene
