// SPDX-License-Identifier: MIT
// Streams are read up to four at a time: each number waits for the one before it in its stream, so that only other streams
// can fill the time.
#include <algorithm>
#include <memory>

#include "coding/bit_source.h"
#include "unpack/strip_values.h"

namespace meshlode {

namespace {

/// Numbers between two looks at the streams' ends, and by how much the buffer must be longer for that: a number has at most
/// kMaxCodeBits and 29 raw bits.
constexpr std::uint32_t kChunk = 256;
constexpr std::size_t kPaddingBytes = kChunk * 5 + 16;

struct Lane {
  const CodeTable* table = nullptr;
  std::uint64_t at = 0, end = 0;  ///< bits from the buffer's start
  std::uint32_t* out = nullptr;
};

/// Reads the numbers from `first` to `count` of each lane and writes them kStride words apart. Lanes in kSymbols hold
/// symbols.
template <std::size_t kLanes, std::size_t kStride, std::uint32_t kSymbols>
bool read_lanes(const std::uint8_t* buffer, std::array<Lane, kLanes>& lanes, std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t done = first; done < count;) {
    const std::uint32_t chunk = std::min(kChunk, count - done);
    std::array<std::uint64_t, kLanes> at;
    for (std::size_t k = 0; k < kLanes; ++k) at[k] = lanes[k].at;
    for (std::size_t i = done; i < done + chunk; ++i) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        lanes[k].out[i * kStride] = (kSymbols >> k & 1U) != 0 ? take_symbol(buffer, at[k], *lanes[k].table)
                                                              : take_value(buffer, at[k], *lanes[k].table);
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

class PrefixReader {
 public:
  PrefixReader(const format::MeshRecord& mesh, const StreamBytes& streams, const StreamCounts& counts, StripValues& out)
      : mesh_(mesh), streams_(streams), counts_(counts), out_(out), buffer_(new std::uint8_t[streams.bytes.size() + kPaddingBytes]) {
    std::copy(streams.bytes.begin(), streams.bytes.end(), buffer_.get());
    std::fill_n(buffer_.get() + streams.bytes.size(), kPaddingBytes, std::uint8_t{0});
    std::uint64_t at = 0;
    for (std::uint32_t s = 0; s < kMaxStreams; ++s) {
      starts_[s] = at * 8;
      at += streams.size[s];
    }
  }

  bool run(std::span<const std::uint8_t> code_lengths) {
    if (code_lengths.size() != code_length_bytes(mesh_)) return false;
    for (std::uint32_t t = 0; t < kUvTables + mesh_.uv_set_count; ++t) {
      const bool is_value = symbol_count(t) == kValueSymbols;
      if (!fill_code_table(code_lengths.first(symbol_count(t)), is_value, tables_[t])) return false;
      code_lengths = code_lengths.subspan(symbol_count(t));
    }
    for (std::uint32_t s = 0; s < kFieldStreams; ++s) out_.streams[s].resize(counts_.count[s]);
    if (!read_pair<1>(kTripleStream, kReferenceStream) || !read_pair<0>(kLengthStream, kTwinStream) ||
        !read_pair<3>(kStartStream, kStartStream)) {
      return false;
    }
    const std::uint32_t fields = field_count(mesh_);
    for (std::uint32_t first = 0; first < fields; first += first == 0 ? 3 : 4) {
      const std::uint32_t in_quad = first == 0 ? 3 : std::min(4U, fields - first);
      out_.errors[quad_of(first)].resize(counts_.count[kFieldStreams]);
      const bool is_ok = in_quad == 4 ? read_quad<4>(first) : in_quad == 3 ? read_quad<3>(first)
                       : in_quad == 2 ? read_quad<2>(first) : read_quad<1>(first);
      if (!is_ok) return false;
    }
    return true;
  }

 private:
  Lane lane(std::uint32_t stream, std::uint32_t* out) const {
    return {&tables_[table_of_stream(mesh_, stream)], starts_[stream], starts_[stream] + std::uint64_t{streams_.size[stream]} * 8, out};
  }

  /// Two streams side by side as far as both go, then the rest of the longer one. The same stream twice: once.
  template <std::uint32_t kSymbols>
  bool read_pair(std::uint32_t a, std::uint32_t b) {
    std::array<Lane, 2> lanes{lane(a, out_.streams[a].data()), lane(b, out_.streams[b].data())};
    const std::uint32_t both = a == b ? 0U : std::min(counts_.count[a], counts_.count[b]);
    if (!read_lanes<2, 1, kSymbols>(buffer_.get(), lanes, 0, both)) return false;
    std::array<Lane, 1> first{lanes[0]};
    std::array<Lane, 1> second{lanes[1]};
    return read_lanes<1, 1, kSymbols & 1U>(buffer_.get(), first, both, counts_.count[a]) &&
           (a == b || read_lanes<1, 1, kSymbols / 2>(buffer_.get(), second, both, counts_.count[b]));
  }

  template <std::size_t kLanes>
  bool read_quad(std::uint32_t first) {
    std::array<Lane, kLanes> lanes;
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      lanes[k] = lane(kFieldStreams + first + k, out_.errors[quad_of(first)].data()->lane + k);
    }
    return read_lanes<kLanes, 4, 0>(buffer_.get(), lanes, 0, counts_.count[kFieldStreams]);
  }

  const format::MeshRecord& mesh_;
  const StreamBytes& streams_;
  const StreamCounts& counts_;
  StripValues& out_;
  std::unique_ptr<std::uint8_t[]> buffer_;
  std::array<std::uint64_t, kMaxStreams> starts_{};
  std::array<CodeTable, kMaxTables> tables_;
};

}  // namespace

std::uint32_t code_length_bytes(const format::MeshRecord& mesh) {
  std::uint32_t bytes = 0;
  for (std::uint32_t t = 0; t < kUvTables + mesh.uv_set_count; ++t) bytes += symbol_count(t);
  return bytes;
}

bool read_prefix_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                         const StreamBytes& streams, const StreamCounts& counts, StripValues& out) {
  return PrefixReader(mesh, streams, counts, out).run(code_lengths);
}

}  // namespace meshlode
