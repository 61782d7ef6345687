// SPDX-License-Identifier: GPL-3.0-or-later
// Colours in the two bytes behind each facet of a binary STL: VisCAM's and SolidView's way, or Magics's.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "scene/import/polygons/polygon_soup.h"

namespace meshlode::scene {

class StlColors {
 public:
  /// \param header the first 80 bytes; Magics's has "COLOR=" and four bytes: red, green, blue, alpha
  StlColors(std::string_view header, bool is_linear);
  /// Magics: a facet has a colour of its own where bit 15 is 0, red lowest, else that of the header. Others: where bit
  /// 15 is 1, blue lowest.
  [[nodiscard]] std::optional<Vec4f> color_of(std::uint16_t attribute);
  /// Says what of header and facets is no colour.
  void report(std::vector<LeftOut>& left_out) const;

 private:
  [[nodiscard]] Vec4f color(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const;
  bool is_linear_, is_magics_ = false;
  bool has_material_ = false, has_alpha_ = false;
  Vec4f of_header_{1.0F};
  std::uint64_t unknown_ = 0;
};

}  // namespace meshlode::scene
