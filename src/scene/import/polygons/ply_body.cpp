// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/ply_body.h"

namespace meshlode::scene {

PlyBody::PlyBody(const PlyHeader& header, std::string_view text)
    : is_ascii_(header.is_ascii), is_big_endian_(header.is_big_endian), text_(text) {
  if (!is_ascii_) return;
  std::uint64_t rows = 0, lines = 0;
  for (const PlyElement& element : header.elements) rows += element.properties.empty() ? 0 : element.count;
  while (!text.empty() && lines <= rows) lines += trimmed(take_line(text)).empty() ? 0U : 1U;
  has_rows_ = lines == rows;
}

std::optional<std::uint64_t> PlyBody::next_count(PlyType type) {
  const auto value = next(type);
  if (!value || !(*value >= 0.0) || *value > 4294967295.0) return std::nullopt;
  const auto index = static_cast<std::uint64_t>(*value);
  return static_cast<double>(index) == *value ? std::optional(index) : std::nullopt;
}

bool PlyBody::skip(const PlyProperty& property) {
  if (!property.list_count) return next(property.type).has_value();
  const auto count = next_count(*property.list_count);
  for (std::uint64_t i = 0; count && i < *count; ++i) {
    if (!next(property.type)) return false;
  }
  return count.has_value();
}

void PlyBody::end_row() {
  if (!has_rows_) return;
  std::string_view line = take_line(text_);
  while (!take_word(line).empty()) ++surplus_;
}

}  // namespace meshlode::scene
