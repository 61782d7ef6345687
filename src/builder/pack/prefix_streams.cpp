// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/pack/prefix_streams.h"

#include <array>

#include "builder/pack/bit_sink.h"
#include "builder/pack/prefix_lengths.h"
#include "format/page_streams.h"
#include "format/prefix_code.h"

namespace meshlode::builder {

namespace {

format::ValueToken token_in(std::uint32_t table, std::uint32_t value) {
  return format::symbol_count(table) == format::kValueSymbols ? format::token_of(value)
                                                              : format::ValueToken{value, 0, 0};
}

}  // namespace

PrefixStreams write_prefix_streams(const format::MeshRecord& mesh, const PageModel& model) {
  const std::uint32_t stream_count = format::kFieldStreams + format::field_count(mesh);
  const std::uint32_t table_count = format::kUvTables + mesh.uv_set_count;
  std::array<std::vector<std::uint64_t>, format::kMaxTables> counts;
  for (std::uint32_t t = 0; t < table_count; ++t) counts[t].resize(format::symbol_count(t));
  for (std::uint32_t s = 0; s < stream_count; ++s) {
    const std::uint32_t table = format::table_of_stream(mesh, s);
    for (const std::uint32_t value : model.streams[s]) ++counts[table][token_in(table, value).symbol];
  }

  PrefixStreams out;
  std::array<std::vector<std::uint8_t>, format::kMaxTables> lengths;
  std::array<std::vector<std::uint16_t>, format::kMaxTables> codes;
  for (std::uint32_t t = 0; t < table_count; ++t) {
    lengths[t] = choose_code_lengths(counts[t]);
    codes[t].resize(lengths[t].size());
    (void)format::assign_codes(lengths[t], codes[t]);
    out.code_lengths.insert(out.code_lengths.end(), lengths[t].begin(), lengths[t].end());
  }
  for (std::uint32_t s = 0; s < stream_count; ++s) {
    const std::uint32_t table = format::table_of_stream(mesh, s);
    BitSink sink;
    for (const std::uint32_t value : model.streams[s]) {
      const format::ValueToken token = token_in(table, value);
      sink.put(codes[table][token.symbol], lengths[table][token.symbol]);
      sink.put(token.raw, token.raw_bits);
    }
    out.streams.push_back(sink.finish());
  }
  return out;
}

}  // namespace meshlode::builder
