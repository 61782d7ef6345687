// SPDX-License-Identifier: MIT
// In the place of unpack_lz4.cpp, unpack_zstd.cpp and unpack_draco.cpp, where MESHLODE_OLD_CODECS is off: pages of
// these codecs are refused by name, and no library is needed.
#include "run/unpack/decompressors.h"

namespace meshlode::run {

UnpackOutcome unpack_lz4(std::span<const std::uint8_t>, std::span<std::uint8_t>) {
  return UnpackOutcome::kNotBuiltIn;
}

UnpackOutcome unpack_zstd(std::span<const std::uint8_t>, std::span<std::uint8_t>) {
  return UnpackOutcome::kNotBuiltIn;
}

UnpackOutcome unpack_draco(std::span<const std::uint8_t>, std::span<std::uint32_t>) {
  return UnpackOutcome::kNotBuiltIn;
}

}  // namespace meshlode::run
