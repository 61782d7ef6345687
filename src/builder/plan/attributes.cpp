// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/plan/attributes.h"

#include "base/nearest_name.h"

namespace meshlode::builder {

Result<std::uint32_t> parse_attributes(std::string_view names) {
  if (names.empty()) return std::uint32_t{0};
  if (names == "all") return kAllAttributes;
  std::uint32_t bits = 0;
  while (true) {
    const std::size_t comma = names.find(',');
    const std::string_view name = names.substr(0, comma);
    const auto bit = value_in(kAttributeNames, name);
    if (!bit) {
      const std::string shown(name.substr(0, 64));
      if (name == "TANGENT") return Error{ErrorCode::kUsage, "", "TANGENT is never stored: shading derives tangents"};
      if (name == "POSITION") return Error{ErrorCode::kUsage, "", "POSITION is always stored"};
      std::vector<std::string> known = all_names(kAttributeNames);
      known.emplace_back("all");
      return Error{ErrorCode::kUsage, "", "no attribute is called '" + shown + "'" + nearest_or_all(name, known)};
    }
    bits |= *bit;
    if (comma == std::string_view::npos) return bits;
    names.remove_prefix(comma + 1);
  }
}

std::vector<std::string> names_of_attributes(std::uint32_t bits) {
  std::vector<std::string> names;
  for (const EnumName<std::uint32_t>& entry : kAttributeNames) {
    if ((bits & entry.value) != 0) names.emplace_back(entry.name);
  }
  return names;
}

}  // namespace meshlode::builder
