// SPDX-License-Identifier: MIT
#include "run/unpack/side_columns.h"

#include <array>
#include <cstring>

#include "format/page_streams.h"
#include "format/section_columns.h"
#include "run/unpack/strip_values.h"

namespace meshlode::run {

bool unpack_side_columns(const format::MeshRecord& mesh, std::uint32_t cluster_count,
                         std::span<const std::uint8_t> stored, std::span<std::uint8_t> out) {
  format::ColumnSource source(stored);
  std::size_t at = 0;
  const auto take = [&](std::size_t count) {
    if (count == 0) return true;
    if (count > out.size() - at || !source.read(out.data() + at, count, 1)) return false;
    at += count;
    return true;
  };
  std::array<std::uint32_t, format::kRangeWordKinds> counts;
  if (!take(code_length_bytes(mesh)) || !take(sizeof(counts))) return false;
  std::memcpy(counts.data(), out.data() + at - sizeof(counts), sizeof(counts));
  const std::uint32_t head_planes = 4 * format::head_words(mesh) - 2;  // half of word 0 is not stored
  for (std::uint32_t plane = 0; plane < head_planes; ++plane) {
    if (!take(cluster_count)) return false;
  }
  for (const std::uint32_t count : counts) {
    for (std::uint32_t plane = 0; plane < 4; ++plane) {
      if (!take(count)) return false;
    }
  }
  return at == out.size() && source.is_at_end();
}

}  // namespace meshlode::run
