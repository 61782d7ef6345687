// SPDX-License-Identifier: MIT
// What the values of an enum are called where people or other programs read them: options, reports, META. One table an
// enum, beside it, read in both directions.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshlode {

template <class Enum>
struct EnumName {
  Enum value;
  const char* name;
};

/// "unknown" for a value that the table has not: a file may hold any number.
template <class Enum, std::size_t N>
constexpr const char* name_in(const std::array<EnumName<Enum>, N>& names, Enum value) {
  for (const EnumName<Enum>& entry : names) {
    if (entry.value == value) return entry.name;
  }
  return "unknown";
}

template <class Enum, std::size_t N>
constexpr std::optional<Enum> value_in(const std::array<EnumName<Enum>, N>& names, std::string_view name) {
  for (const EnumName<Enum>& entry : names) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

/// In the table's order: the choices of an option.
template <class Enum, std::size_t N>
std::vector<std::string> all_names(const std::array<EnumName<Enum>, N>& names) {
  std::vector<std::string> out;
  out.reserve(N);
  for (const EnumName<Enum>& entry : names) out.emplace_back(entry.name);
  return out;
}

}  // namespace meshlode
