// SPDX-License-Identifier: MIT
// All streams of a kind are read side by side: each number waits for the one before it in its stream, so that only
// other streams can fill the time.
#include <algorithm>
#include <memory>

#include "format/bit_source.h"
#include "run/unpack/processor.h"
#include "run/unpack/strip_values.h"

namespace meshlode::run {

namespace {

/// Numbers between two looks at the streams' ends, and by how much the buffer must be longer for that: a number has at
/// most kMaxCodeBits and 29 raw bits.
constexpr std::uint32_t kChunk = 256;
constexpr std::size_t kPaddingBytes = kChunk * 5 + 16;

template <class Word>
struct Lane {
  const format::CodeTable* table = nullptr;
  const format::QuickTable* quick = nullptr;
  std::uint64_t at = 0, end = 0;  ///< bits from the buffer's start
  Word* out = nullptr;
  std::uint32_t count = 0;
  format::Meaning meaning = format::Meaning::kNumber;
};

/// Numbers taken from one look at a stream.
constexpr std::uint32_t kAtOnce = 4;
static_assert(kAtOnce * format::kQuickBits <= 57 && kAtOnce * format::kQuickBits < 1U << format::kQuickSizeBits);

/// One number, of any size.
template <class Word>
Word read_number(const std::uint8_t* buffer, Lane<Word>& lane) {
  std::uint64_t bits = format::load_bits(buffer, lane.at);
  return static_cast<Word>(format::next_meant(bits, lane.at, *lane.table, lane.meaning));
}

/// kAtOnce numbers, kStride words apart.
template <std::size_t kStride, class Word>
void read_group(const std::uint8_t* buffer, Lane<Word>& lane) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << format::kQuickBits) - 1;
  const format::QuickTable& quick = *lane.quick;
  std::uint64_t bits = format::load_bits(buffer, lane.at);
  std::int32_t entry[kAtOnce];
  for (std::int32_t& e : entry) {
    e = quick[bits & kMask];
    bits >>= static_cast<std::uint32_t>(e) & ((1U << format::kQuickSizeBits) - 1U);
  }
  // An entry that does not say a number is 0 and takes no bits, so that all behind it are the same.
  if (entry[kAtOnce - 1] != 0) [[likely]] {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      sum += entry[i];
      lane.out[i * kStride] = static_cast<Word>(entry[i] >> format::kQuickSizeBits);
    }
    lane.at += static_cast<std::uint32_t>(sum) & ((1U << format::kQuickSizeBits) - 1U);
  } else {
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      const std::int32_t e = quick[format::load_bits(buffer, lane.at) & kMask];
      lane.out[i * kStride] = e != 0 ? static_cast<Word>(e >> format::kQuickSizeBits) : read_number(buffer, lane);
      lane.at += static_cast<std::uint32_t>(e) & ((1U << format::kQuickSizeBits) - 1U);
    }
  }
  lane.out += kAtOnce * kStride;
}

/// Reads `count` more numbers of each lane. False where a lane goes beyond its end.
template <std::size_t kStride, class Word>
bool read_lanes(const std::uint8_t* buffer, std::span<Lane<Word>> lanes, std::uint32_t count) {
  for (std::uint32_t done = 0; done < count;) {
    const std::uint32_t chunk = std::min(kChunk, count - done);
    for (std::uint32_t i = 0; i < chunk / kAtOnce; ++i) {
      for (Lane<Word>& lane : lanes) read_group<kStride>(buffer, lane);
    }
    for (Lane<Word>& lane : lanes) {
      for (std::uint32_t i = 0; i < chunk % kAtOnce; ++i, lane.out += kStride) *lane.out = read_number(buffer, lane);
      if (lane.at > lane.end) return false;
    }
    done += chunk;
  }
  return true;
}

template <class L>
class PrefixReader {
 public:
  PrefixReader(const format::MeshRecord& mesh, const StreamBytes& streams, const StreamCounts& counts,
               StripValues<L>& out)
      : mesh_(mesh),
        streams_(streams),
        counts_(counts),
        out_(out),
        tables_(new format::CodeTable[format::kMaxTables]),
        quick_(new format::QuickTable[format::kMaxTables]) {
    buffer_.resize(streams.bytes.size() + kPaddingBytes);
    std::copy(streams.bytes.begin(), streams.bytes.end(), buffer_.data());
    std::fill_n(buffer_.data() + streams.bytes.size(), kPaddingBytes, std::uint8_t{0});
    std::uint64_t at = 0;
    for (std::uint32_t s = 0; s < format::kMaxStreams; ++s) {
      starts_[s] = at * 8;
      at += streams.size[s];
    }
  }

  bool prepare(std::span<const std::uint8_t> code_lengths) {
    if (code_lengths.size() != code_length_bytes(mesh_)) return false;
    for (std::uint32_t t = 0; t < format::kUvTables + mesh_.uv_set_count; ++t) {
      if (!format::fill_code_tables(code_lengths.first(format::symbol_count(t)), meaning_of(t), tables_[t], quick_[t]))
        return false;
      code_lengths = code_lengths.subspan(format::symbol_count(t));
    }
    for (std::uint32_t s = 0; s < format::kFieldStreams; ++s) out_.streams[s].resize(counts_.count[s]);
    for (std::uint32_t q = 0; q < quad_count<L>(mesh_); ++q)
      out_.errors[q].resize(counts_.count[format::kFieldStreams], kErrorsBehind);
    return true;
  }

  bool run() { return read_topology() && read_fields(); }

 private:
  static constexpr format::Meaning meaning_of(std::uint32_t table) {
    return format::symbol_count(table) != format::kValueSymbols ? format::Meaning::kSymbol
           : is_folded(table) ? format::Meaning::kFolded  // the first tables have their streams' numbers
                              : format::Meaning::kNumber;
  }

  template <class Word>
  Lane<Word> lane(std::uint32_t stream, Word* out) const {
    const std::uint32_t table = format::table_of_stream(mesh_, stream);
    return {&tables_[table],
            &quick_[table],
            starts_[stream],
            starts_[stream] + std::uint64_t{streams_.size[stream]} * 8,
            out,
            counts_.count[stream],
            meaning_of(table)};
  }

  /// Streams of different lengths: the longest first, and fewer and fewer of them.
  bool read_topology() {
    std::array<Lane<std::uint32_t>, format::kFieldStreams> lanes;
    for (std::uint32_t s = 0; s < format::kFieldStreams; ++s) lanes[s] = lane(s, out_.streams[s].data());
    std::sort(lanes.begin(), lanes.end(), [](const auto& a, const auto& b) { return a.count > b.count; });
    std::uint32_t done = 0;
    for (std::size_t left = format::kFieldStreams; left > 0; --left) {
      const std::uint32_t count = lanes[left - 1].count;
      if (!read_lanes<1>(buffer_.data(), std::span(lanes).first(left), count - done)) return false;
      done = count;
    }
    return true;
  }

  bool read_fields() {
    std::array<Lane<typename L::Word>, format::kMaxFields> lanes;
    const std::uint32_t fields = format::field_count(mesh_);
    for (std::uint32_t f = 0; f < fields; ++f) {
      const std::uint32_t slot = slot_of(f);
      lanes[f] = lane(format::kFieldStreams + f, out_.errors[slot / L::kLanes].data()->lane + slot % L::kLanes);
    }
    return read_lanes<L::kLanes>(buffer_.data(), std::span(lanes).first(fields), counts_.count[format::kFieldStreams]);
  }

  const format::MeshRecord& mesh_;
  const StreamBytes& streams_;
  const StreamCounts& counts_;
  StripValues<L>& out_;
  UnfilledArray<std::uint8_t> buffer_;
  std::array<std::uint64_t, format::kMaxStreams> starts_{};
  std::unique_ptr<format::CodeTable[]> tables_;
  std::unique_ptr<format::QuickTable[]> quick_;
};

#if MESHLODE_HAS_BMI2_PATH
template <class L>
MESHLODE_FOR_BMI2 bool run_with_bmi2(PrefixReader<L>& reader) {
  return reader.run();
}
#endif

template <class L>
bool read_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                  const StreamBytes& streams, const StreamCounts& counts, StripValues<L>& out) {
  PrefixReader<L> reader(mesh, streams, counts, out);
  if (!reader.prepare(code_lengths)) return false;
#if MESHLODE_HAS_BMI2_PATH
  if (has_bmi2()) return run_with_bmi2(reader);
#endif
  return reader.run();
}

}  // namespace

std::uint32_t code_length_bytes(const format::MeshRecord& mesh) {
  std::uint32_t bytes = 0;
  for (std::uint32_t t = 0; t < format::kUvTables + mesh.uv_set_count; ++t) bytes += format::symbol_count(t);
  return bytes;
}

bool read_prefix_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                         const StreamBytes& streams, const StreamCounts& counts, StripValues<WideLanes>& out) {
  return read_streams(mesh, code_lengths, streams, counts, out);
}
bool read_prefix_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                         const StreamBytes& streams, const StreamCounts& counts, StripValues<NarrowLanes>& out) {
  return read_streams(mesh, code_lengths, streams, counts, out);
}

}  // namespace meshlode::run
