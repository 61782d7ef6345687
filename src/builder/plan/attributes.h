// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes by name: what --keep and --drop list.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/build.h>
#include <meshlode/result.h>

#include "base/enum_names.h"

namespace meshlode::builder {

/// The bit of each attribute that can be kept or dropped, under glTF's name.
inline constexpr std::array<EnumName<std::uint32_t>, 6> kAttributeNames{{{kAttributeNormal, "NORMAL"},
                                                                         {attribute_texcoord(0), "TEXCOORD_0"},
                                                                         {attribute_texcoord(1), "TEXCOORD_1"},
                                                                         {attribute_texcoord(2), "TEXCOORD_2"},
                                                                         {attribute_texcoord(3), "TEXCOORD_3"},
                                                                         {kAttributeColor, "COLOR_0"}}};

/// "NORMAL,COLOR_0", or "all", or nothing: bits. Errors: kUsage with the nearest name, without a place.
[[nodiscard]] Result<std::uint32_t> parse_attributes(std::string_view names);

/// In the table's order.
[[nodiscard]] std::vector<std::string> names_of_attributes(std::uint32_t bits);

}  // namespace meshlode::builder
