// SPDX-License-Identifier: MIT
// Errors of the reader, each with its place: "section GRUP, record 17, field page".
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode::run {

/// "GRUP"; bytes that are not printable become '?'.
[[nodiscard]] inline std::string section_tag(std::uint32_t id) {
  std::string name;
  for (std::uint32_t shift = 0; shift < 32; shift += 8) {
    const auto c = static_cast<char>(id >> shift & 0xFFU);
    name.push_back(c >= 0x20 && c < 0x7F ? c : '?');
  }
  return name;
}

[[nodiscard]] inline Error invalid_header(const char* field, std::string detail) {
  return {ErrorCode::kInvalid, std::string("header, field ") + field, std::move(detail)};
}

[[nodiscard]] inline Error invalid_section(std::uint32_t id, const char* field, std::string detail) {
  return {ErrorCode::kInvalid, "section " + section_tag(id) + ", field " + field, std::move(detail)};
}

[[nodiscard]] inline Error invalid_record(format::SectionId id, std::size_t record, const char* field,
                                          std::string detail) {
  return {ErrorCode::kInvalid,
          "section " + section_tag(static_cast<std::uint32_t>(id)) + ", record " + std::to_string(record) + ", field " +
              field,
          std::move(detail)};
}

}  // namespace meshlode::run
