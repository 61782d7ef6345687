// SPDX-License-Identifier: MIT
// Streams are read up to four at a time: each number waits for the one before it in its stream, so that only other streams
// can fill the time.
#include <algorithm>
#include <memory>

#include "coding/bit_source.h"
#include "unpack/processor.h"
#include "unpack/strip_values.h"

namespace meshlode {

namespace {

/// Numbers between two looks at the streams' ends, and by how much the buffer must be longer for that: a number has at most
/// kMaxCodeBits and 29 raw bits.
constexpr std::uint32_t kChunk = 256;
constexpr std::size_t kPaddingBytes = kChunk * 5 + 16;

template <class Word>
struct Lane {
  const CodeTable* table = nullptr;
  const QuickTable* quick = nullptr;
  std::uint64_t at = 0, end = 0;  ///< bits from the buffer's start
  Word* out = nullptr;
};

/// Numbers taken from one look at a stream; a long one looks again.
constexpr std::uint32_t kAtOnce = 4;
static_assert(kAtOnce * kQuickBits <= 57);

/// Reads the numbers from `first` to `count` of each lane and writes them kStride words apart. Lanes in the mask kSymbols
/// hold symbols.
template <std::uint32_t kSymbols, std::size_t kStride, std::size_t kLanes, class Word>
bool read_lanes(const std::uint8_t* buffer, std::array<Lane<Word>, kLanes>& lanes, std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t done = first; done < count;) {
    const std::uint32_t chunk = std::min(kChunk, count - done);
    std::array<std::uint64_t, kLanes> at;
    std::array<const QuickTable*, kLanes> quick;
    std::array<Word*, kLanes> out;
    for (std::size_t k = 0; k < kLanes; ++k) {
      at[k] = lanes[k].at;
      quick[k] = lanes[k].quick;
      out[k] = lanes[k].out + done * kStride;
    }
    const auto take = [&](std::uint64_t& bits, std::size_t k) {
      const std::uint32_t entry = (*quick[k])[bits & ((std::uint64_t{1} << kQuickBits) - 1)];
      const std::uint32_t size = entry & 15U;
      if (size != 0) [[likely]] {
        at[k] += size;
        bits >>= size;
        return static_cast<Word>(entry >> 4U);
      }
      bits = load_bits(buffer, at[k]);
      const std::uint32_t value = (kSymbols >> k & 1U) != 0 ? next_symbol(bits, at[k], *lanes[k].table)
                                                            : next_value(bits, at[k], *lanes[k].table);
      bits = load_bits(buffer, at[k]);
      return static_cast<Word>(value);
    };
    std::size_t i = 0;
    for (; i + kAtOnce <= chunk; i += kAtOnce) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        std::uint64_t bits = load_bits(buffer, at[k]);
        for (std::size_t n = 0; n < kAtOnce; ++n) out[k][(i + n) * kStride] = take(bits, k);
      }
    }
    for (; i < chunk; ++i) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        std::uint64_t bits = load_bits(buffer, at[k]);
        out[k][i * kStride] = take(bits, k);
      }
    }
    for (std::size_t k = 0; k < kLanes; ++k) {
      lanes[k].at = at[k];
      if (at[k] > lanes[k].end) return false;
    }
    done += chunk;
  }
  return true;
}

template <class L>
class PrefixReader {
 public:
  PrefixReader(const format::MeshRecord& mesh, const StreamBytes& streams, const StreamCounts& counts, StripValues<L>& out)
      : mesh_(mesh), streams_(streams), counts_(counts), out_(out), tables_(new CodeTable[kMaxTables]), quick_(new QuickTable[kMaxTables]) {
    buffer_.resize(streams.bytes.size() + kPaddingBytes);
    std::copy(streams.bytes.begin(), streams.bytes.end(), buffer_.data());
    std::fill_n(buffer_.data() + streams.bytes.size(), kPaddingBytes, std::uint8_t{0});
    std::uint64_t at = 0;
    for (std::uint32_t s = 0; s < kMaxStreams; ++s) {
      starts_[s] = at * 8;
      at += streams.size[s];
    }
  }

  bool prepare(std::span<const std::uint8_t> code_lengths) {
    if (code_lengths.size() != code_length_bytes(mesh_)) return false;
    for (std::uint32_t t = 0; t < kUvTables + mesh_.uv_set_count; ++t) {
      const bool is_value = symbol_count(t) == kValueSymbols;
      if (!fill_code_table(code_lengths.first(symbol_count(t)), is_value, tables_[t])) return false;
      fill_quick_table(code_lengths.first(symbol_count(t)), is_value, quick_[t]);
      code_lengths = code_lengths.subspan(symbol_count(t));
    }
    for (std::uint32_t s = 0; s < kFieldStreams; ++s) out_.streams[s].resize(counts_.count[s]);
    const std::uint32_t last_slot = slot_of(field_count(mesh_) - 1);
    for (std::uint32_t quad = 0; quad <= last_slot / L::kLanes; ++quad) {
      out_.errors[quad].resize_zeroed(counts_.count[kFieldStreams]);
    }
    return true;
  }

  bool run() {
    if (!read_pair<1>(kTripleStream, kReferenceStream) || !read_pair<0>(kLengthStream, kTwinStream) ||
        !read_pair<3>(kStartStream, kStartStream)) {
      return false;
    }
    const std::uint32_t fields = field_count(mesh_);
    for (std::uint32_t first = 0; first < fields; first += first == 0 ? 3 : 4) {
      const std::uint32_t together = first == 0 ? 3 : std::min(4U, fields - first);
      const bool is_ok = together == 4 ? read_fields<4>(first) : together == 3 ? read_fields<3>(first)
                       : together == 2 ? read_fields<2>(first) : read_fields<1>(first);
      if (!is_ok) return false;
    }
    return true;
  }

 private:
  template <class Word>
  Lane<Word> lane(std::uint32_t stream, Word* out) const {
    const std::uint32_t table = table_of_stream(mesh_, stream);
    return {&tables_[table], &quick_[table], starts_[stream], starts_[stream] + std::uint64_t{streams_.size[stream]} * 8, out};
  }

  /// Two streams side by side as far as both go, then the rest of the longer one. The same stream twice: once.
  template <std::uint32_t kSymbols>
  bool read_pair(std::uint32_t a, std::uint32_t b) {
    std::array<Lane<std::uint32_t>, 2> lanes{lane(a, out_.streams[a].data()), lane(b, out_.streams[b].data())};
    const std::uint32_t both = a == b ? 0U : std::min(counts_.count[a], counts_.count[b]);
    if (!read_lanes<kSymbols, 1>(buffer_.data(), lanes, 0, both)) return false;
    std::array<Lane<std::uint32_t>, 1> first{lanes[0]};
    std::array<Lane<std::uint32_t>, 1> second{lanes[1]};
    return read_lanes<kSymbols & 1U, 1>(buffer_.data(), first, both, counts_.count[a]) &&
           (a == b || read_lanes<kSymbols / 2, 1>(buffer_.data(), second, both, counts_.count[b]));
  }

  template <std::size_t kLanes>
  bool read_fields(std::uint32_t first) {
    std::array<Lane<typename L::Word>, kLanes> lanes;
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      const std::uint32_t slot = slot_of(first + k);
      lanes[k] = lane(kFieldStreams + first + k, out_.errors[slot / L::kLanes].data()->lane + slot % L::kLanes);
    }
    return read_lanes<0, L::kLanes>(buffer_.data(), lanes, 0, counts_.count[kFieldStreams]);
  }

  const format::MeshRecord& mesh_;
  const StreamBytes& streams_;
  const StreamCounts& counts_;
  StripValues<L>& out_;
  Room<std::uint8_t> buffer_;
  std::array<std::uint64_t, kMaxStreams> starts_{};
  std::unique_ptr<CodeTable[]> tables_;
  std::unique_ptr<QuickTable[]> quick_;
};

#if MESHLODE_HAS_BMI2_PATH
template <class L>
MESHLODE_FOR_BMI2 bool run_with_bmi2(PrefixReader<L>& reader) {
  return reader.run();
}
#endif

template <class L>
bool read_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths, const StreamBytes& streams,
                  const StreamCounts& counts, StripValues<L>& out) {
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
  for (std::uint32_t t = 0; t < kUvTables + mesh.uv_set_count; ++t) bytes += symbol_count(t);
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

}  // namespace meshlode
