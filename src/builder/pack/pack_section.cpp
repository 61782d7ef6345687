// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/pack/pack_section.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "builder/pack/bit_sink.h"
#include "builder/pack/prefix_lengths.h"
#include "format/prefix_code.h"
#include "format/section_columns.h"

namespace meshlode::builder {

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Each record's 16-bit words as folded differences to the record before.
Bytes take_differences(std::span<const std::uint8_t> bytes, std::size_t record_bytes) {
  Bytes out(bytes.begin(), bytes.end());
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    std::uint16_t value;
    std::uint16_t before = 0;
    std::memcpy(&value, &bytes[at], 2);
    if (at >= record_bytes) std::memcpy(&before, &bytes[at - record_bytes], 2);
    const std::uint16_t folded = format::fold16(static_cast<std::uint16_t>(value - before));
    std::memcpy(&out[at], &folded, 2);
  }
  return out;
}

Bytes prefix_column(const Bytes& column) {
  std::array<std::uint64_t, 256> counts{};
  for (const std::uint8_t byte : column) ++counts[byte];
  const Bytes lengths = choose_code_lengths(counts);
  std::array<std::uint16_t, 256> codes{};
  (void)format::assign_codes(lengths, codes);
  std::size_t first = 0;
  std::size_t last = 255;
  while (lengths[first] == 0) ++first;
  while (lengths[last] == 0) --last;
  Bytes out{static_cast<std::uint8_t>(format::ColumnMode::kPrefix), static_cast<std::uint8_t>(first),
            static_cast<std::uint8_t>(last - first)};
  for (std::size_t s = first; s <= last; s += 2) {
    out.push_back(static_cast<std::uint8_t>(lengths[s] | (s < last ? lengths[s + 1] << 4U : 0)));
  }
  BitSink sink;
  for (const std::uint8_t byte : column) sink.put(codes[byte], lengths[byte]);
  const Bytes code = sink.finish();
  for (std::uint32_t shift = 0; shift < 32; shift += 8) {
    out.push_back(static_cast<std::uint8_t>(code.size() >> shift & 0xFFU));
  }
  out.insert(out.end(), code.begin(), code.end());
  return out;
}

}  // namespace

void put_column(const Bytes& column, Bytes& out) {
  if (std::all_of(column.begin(), column.end(), [&](std::uint8_t byte) { return byte == column.front(); })) {
    out.push_back(static_cast<std::uint8_t>(format::ColumnMode::kSame));
    out.push_back(column.empty() ? std::uint8_t{0} : column.front());
    return;
  }
  const Bytes coded = prefix_column(column);
  if (coded.size() < column.size() + 1) {
    out.insert(out.end(), coded.begin(), coded.end());
  } else {
    out.push_back(static_cast<std::uint8_t>(format::ColumnMode::kRaw));
    out.insert(out.end(), column.begin(), column.end());
  }
}

std::vector<std::uint8_t> pack_section(std::span<const std::uint8_t> bytes, std::uint32_t record_bytes) {
  if (bytes.empty()) return {};
  const std::size_t columns = record_bytes == 0 ? 1 : record_bytes;
  const Bytes source = record_bytes == 0 ? Bytes(bytes.begin(), bytes.end()) : take_differences(bytes, record_bytes);
  Bytes out;
  for (std::size_t c = 0; c < columns; ++c) {
    Bytes column;
    for (std::size_t at = c; at < source.size(); at += columns) column.push_back(source[at]);
    put_column(column, out);
  }
  const bool is_worth_it = out.size() < bytes.size() && bytes.size() / format::kMaxSectionRatio < out.size();
  return is_worth_it ? out : Bytes{};
}

}  // namespace meshlode::builder
