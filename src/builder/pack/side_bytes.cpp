// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/pack/side_bytes.h"

#include "format/page_streams.h"

namespace meshlode::builder {

namespace {

/// Byte `plane` of every word.
std::vector<std::uint8_t> plane_of(const std::vector<std::uint32_t>& words, std::uint32_t plane) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(words.size());
  for (const std::uint32_t word : words) bytes.push_back(static_cast<std::uint8_t>(word >> 8U * plane & 0xFFU));
  return bytes;
}

/// Head word `index` of every cluster, as it is stored.
std::vector<std::uint32_t> head_column(const PageModel& model, std::uint32_t index) {
  std::vector<std::uint32_t> column;
  std::uint32_t before = 0;
  for (const auto& head : model.heads) {
    std::uint32_t word = head[index];
    if (index >= 1 && index <= 3) {
      const std::uint32_t coordinate = word & format::kCoordinateMask;
      word = (word & ~format::kCoordinateMask) | format::fold_coordinate(coordinate - before);
      before = coordinate;
    }
    column.push_back(word);
  }
  return column;
}

}  // namespace

void put_u32(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (std::uint32_t shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::uint8_t>(value >> shift & 0xFFU));
}

std::vector<std::vector<std::uint8_t>> make_columns(const format::MeshRecord& mesh, const PageModel& model) {
  std::vector<std::vector<std::uint8_t>> out(1);
  for (const auto& words : model.range_words) put_u32(out.front(), static_cast<std::uint32_t>(words.size()));
  for (std::uint32_t index = 0; index < format::head_words(mesh); ++index) {
    const std::vector<std::uint32_t> column = head_column(model, index);
    for (std::uint32_t plane = 0; plane < (index == 0 ? 2U : 4U); ++plane) out.push_back(plane_of(column, plane));
  }
  for (std::uint32_t kind = 0; kind < format::kRangeWordKinds; ++kind) {
    std::vector<std::uint32_t> words = model.range_words[kind];
    if (format::is_delta(static_cast<format::RangeWord>(kind))) {
      std::uint32_t before = 0;
      for (std::uint32_t& word : words) {
        const std::uint32_t value = word;
        word = format::fold(value - before);
        before = value;
      }
    }
    for (std::uint32_t plane = 0; plane < 4; ++plane) out.push_back(plane_of(words, plane));
  }
  return out;
}

}  // namespace meshlode::builder
