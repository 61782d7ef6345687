// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/ply_columns.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace meshlode::scene {

namespace {

std::optional<PlyColumn> column_of(const PlyProperty& property) {
  constexpr std::pair<std::string_view, PlyColumn> kNames[] = {{"x", kX},
                                                               {"y", kY},
                                                               {"z", kZ},
                                                               {"nx", kNx},
                                                               {"ny", kNy},
                                                               {"nz", kNz},
                                                               {"u", kU},
                                                               {"s", kU},
                                                               {"v", kV},
                                                               {"t", kV},
                                                               {"texture_u", kU},
                                                               {"texture_v", kV},
                                                               {"texture_s", kU},
                                                               {"texture_t", kV},
                                                               {"red", kRed},
                                                               {"green", kGreen},
                                                               {"blue", kBlue},
                                                               {"alpha", kAlpha},
                                                               {"diffuse_red", kRed},
                                                               {"diffuse_green", kGreen},
                                                               {"diffuse_blue", kBlue},
                                                               {"diffuse_alpha", kAlpha},
                                                               {"r", kRed},
                                                               {"g", kGreen},
                                                               {"b", kBlue},
                                                               {"a", kAlpha},
                                                               {"texnumber", kTexture}};
  if (property.list_count) return std::nullopt;
  for (const auto& [known, column] : kNames) {
    if (known == property.name) return column;
  }
  return std::nullopt;
}

}  // namespace

PlyColumns::PlyColumns(const PlyElement& element, const std::vector<std::vector<PlyColumn>>& sets) {
  std::array<bool, kColumnCount> is_there{}, is_taken{};
  for (const PlyProperty& property : element.properties) {
    if (const auto column = column_of(property)) is_there[*column] = true;
  }
  for (const std::vector<PlyColumn>& set : sets) {
    const bool is_whole = std::all_of(set.begin(), set.end(), [&](PlyColumn c) { return is_there[c]; });
    for (const PlyColumn c : set) has[c] = is_whole;
  }
  has[kAlpha] = has[kRed] && is_there[kAlpha];
  for (const PlyProperty& property : element.properties) {
    auto column = column_of(property);
    if (column && (!has[*column] || is_taken[*column])) column = std::nullopt;  // "u" and "texture_u": the first counts
    if (column) is_taken[*column] = true;
    if (column == kRed) color_type = property.type;
    columns.push_back(column);
  }
}

}  // namespace meshlode::scene
