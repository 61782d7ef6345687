// SPDX-License-Identifier: MIT
#include "run/unpack/page_columns.h"

#include <cstring>

namespace meshlode::run {

std::span<const std::uint8_t> ColumnReader::take(std::uint64_t count) {
  if (count > bytes_.size()) {
    is_short_ = true;
    return {};
  }
  const auto out = bytes_.first(count);
  bytes_ = bytes_.subspan(count);
  return out;
}

std::uint32_t ColumnReader::take_u32() {
  const auto bytes = take(4);
  std::uint32_t value = 0;
  if (!bytes.empty()) std::memcpy(&value, bytes.data(), 4);
  return value;
}

bool PageColumns::read(ColumnReader& columns) {
  if (2 + std::uint64_t{cluster_count_} * format::head_words(mesh_) >= page_.size()) return false;
  for (std::uint32_t& count : counts_) count = columns.take_u32();
  if (!read_heads(columns)) return false;
  for (std::uint32_t kind = 0; kind < format::kRangeWordKinds; ++kind) {
    for (auto& plane : planes_[kind]) plane = columns.take(counts_[kind]);
  }
  return !columns.is_short() && columns.is_at_end();
}

bool PageColumns::read_heads(ColumnReader& columns) {
  const std::uint32_t head_words = format::head_words(mesh_);
  for (std::uint32_t index = 0; index < head_words; ++index) {
    std::array<std::span<const std::uint8_t>, 4> planes;
    for (std::uint32_t k = 0; k < (index == 0 ? 2U : 4U); ++k) planes[k] = columns.take(cluster_count_);
    if (columns.is_short()) return false;
    std::uint32_t* word = page_.data() + 2 + index;
    std::uint32_t coordinate = 0;
    for (std::uint32_t c = 0; c < cluster_count_; ++c, word += head_words) {
      std::uint32_t value = planes[0][c] | std::uint32_t{planes[1][c]} << 8U;
      if (index > 0) value |= std::uint32_t{planes[2][c]} << 16U | std::uint32_t{planes[3][c]} << 24U;
      if (index >= 1 && index <= 3) {
        coordinate =
            (coordinate + format::unfold_coordinate(value & format::kCoordinateMask)) & format::kCoordinateMask;
        value = (value & ~format::kCoordinateMask) | coordinate;
      }
      *word = value;
    }
  }
  return true;
}

bool PageColumns::place_word(format::RangeWord kind, std::uint32_t& word) {
  const std::uint32_t i = next_[kind];
  if (i >= counts_[kind] || word + 1 >= page_.size()) return false;
  const auto& planes = planes_[kind];
  std::uint32_t value = planes[0][i] | std::uint32_t{planes[1][i]} << 8U | std::uint32_t{planes[2][i]} << 16U |
                        std::uint32_t{planes[3][i]} << 24U;
  if (format::is_delta(kind)) value = before_[kind] += format::unfold(value);
  ++next_[kind];
  page_[word++] = value;
  return true;
}

bool PageColumns::place_cluster(std::uint32_t cluster, std::uint32_t& word) {
  if (word >= page_.size() || word > format::head::kDataWord.mask()) return false;
  format::put_field(head(cluster), format::head::kDataWord, static_cast<std::int32_t>(word));
  const auto get = [&](format::BitField field) {
    return static_cast<std::uint32_t>(format::get_field(&page_[word - 1], field));
  };
  if (mesh_.material == format::kNone) {
    for (std::uint32_t covered = 0; covered < triangle_count(cluster);) {
      if (!place_word(format::kMaterialWord, word)) return false;
      covered += get(format::material_range::kTrianglesLess1) + 1U;
    }
  }
  for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
    for (std::uint32_t covered = 0; covered < vertex_count(cluster);) {
      if (!place_word(format::kUvWord0, word)) return false;
      covered += get(format::uv_range::kVerticesLess1) + 1U;
      const bool has_fit = get(format::uv_range::kHasFit) != 0;
      if (!place_word(format::kUvWord1, word) || !place_word(format::kUvWord2, word)) return false;
      if (has_fit && (!place_word(format::kFitWord0, word) || !place_word(format::kFitWord1, word))) return false;
    }
  }
  return mesh_.has_color == 0 || (place_word(format::kColorWord0, word) && place_word(format::kColorWord1, word));
}

}  // namespace meshlode::run
