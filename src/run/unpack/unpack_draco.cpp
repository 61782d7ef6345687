// SPDX-License-Identifier: MIT
// Wrapper of Draco's decoder for numbers. How many there are is said from outside, so its memory is bounded by that and
// by a probability table whose size Draco holds against the bytes at hand.
#include "run/unpack/decompressors.h"

#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/core/decoder_buffer.h>

namespace meshlode::run {

constexpr std::uint16_t kBitstreamVersion = 0x0202;  ///< of the symbol coder; the newest that there is

UnpackOutcome unpack_draco(std::span<const std::uint8_t> stored, std::span<std::uint32_t> out) {
  if (out.empty()) return stored.empty() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(stored.data()), stored.size(), kBitstreamVersion);
  const bool is_ok = draco::DecodeSymbols(static_cast<std::uint32_t>(out.size()), 1, &buffer, out.data());
  return is_ok && buffer.remaining_size() == 0 ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
}

}  // namespace meshlode::run
