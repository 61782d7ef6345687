// SPDX-License-Identifier: MIT
// Wrapper of LZ4's decompressor: one block, no frame.
#include "run/unpack/decompressors.h"

#include <lz4.h>

namespace meshlode::run {

UnpackOutcome unpack_lz4(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out) {
  const int size =
      LZ4_decompress_safe(reinterpret_cast<const char*>(stored.data()), reinterpret_cast<char*>(out.data()),
                          static_cast<int>(stored.size()), static_cast<int>(out.size()));
  return size >= 0 && static_cast<std::size_t>(size) == out.size() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
}

}  // namespace meshlode::run
