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
  /// Magics: a facet has the header's colour where its attribute is 0x8000 or 0xFFFF, or all are 0, else one of its
  /// own, red lowest; MeshLab sets bit 15 of these too. Others: where bit 15 is 1, blue lowest.
  [[nodiscard]] std::optional<Vec4f> color_of(std::uint16_t attribute);
  /// The attribute of every facet is 0.
  void set_all_zero() { is_all_zero_ = true; }
  /// Says what of header and facets is no colour.
  void report(std::vector<LeftOut>& left_out) const;

 private:
  [[nodiscard]] Vec4f color(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const;
  bool is_linear_, is_magics_ = false, is_all_zero_ = false;
  bool has_material_ = false, has_alpha_ = false;
  Vec4f of_header_{1.0F};
  std::uint64_t unknown_ = 0;
};

}  // namespace meshlode::scene
