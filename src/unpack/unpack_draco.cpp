// SPDX-License-Identifier: MIT
// Wrapper of Draco's decoder for numbers. How many there are is said from outside, so its memory is bounded by that and by
// a probability table whose size Draco holds against the bytes at hand.
#include "unpack/codecs.h"

#include <vector>

#ifdef MESHLODE_HAS_DRACO
#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/core/decoder_buffer.h>
#endif

namespace meshlode {

#ifdef MESHLODE_HAS_DRACO

namespace {

constexpr std::uint16_t kBitstreamVersion = 0x0202;  ///< of the symbol coder; the newest that there is

bool read_numbers(std::span<const std::uint8_t> stored, std::vector<std::uint32_t>& out) {
  if (out.empty()) return stored.empty();
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(stored.data()), stored.size(), kBitstreamVersion);
  return draco::DecodeSymbols(static_cast<std::uint32_t>(out.size()), 1, &buffer, out.data()) &&
         buffer.remaining_size() == 0;
}

}  // namespace

UnpackOutcome unpack_draco_bytes(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out) {
  std::vector<std::uint32_t> numbers(out.size());
  if (!read_numbers(stored, numbers)) return UnpackOutcome::kBroken;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<std::uint8_t>(numbers[i] & 0xFFU);
  return UnpackOutcome::kOk;
}

bool read_draco_streams(const format::MeshRecord& mesh, const StreamBytes& streams, const StreamCounts& counts,
                        StripValues& out) {
  std::span<const std::uint8_t> rest = streams.bytes;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t s = 0; s < kFieldStreams + field_count(mesh); ++s) {
    const auto stored = rest.first(streams.size[s]);
    rest = rest.subspan(streams.size[s]);
    std::vector<std::uint32_t>& target = s < kFieldStreams ? out.streams[s] : numbers;
    target.assign(counts.count[s], 0);
    if (!read_numbers(stored, target)) return false;
    if (s < kFieldStreams) continue;
    const std::uint32_t field = s - kFieldStreams;
    std::vector<Quad>& errors = out.errors[quad_of(field)];
    errors.resize(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) errors[i].lane[lane_of(field)] = numbers[i];
  }
  return true;
}

#else

UnpackOutcome unpack_draco_bytes(std::span<const std::uint8_t>, std::span<std::uint8_t>) {
  return UnpackOutcome::kNotBuiltIn;
}
bool read_draco_streams(const format::MeshRecord&, const StreamBytes&, const StreamCounts&, StripValues&) {
  return false;
}

#endif

}  // namespace meshlode
