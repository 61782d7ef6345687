// SPDX-License-Identifier: MIT
// Wrapper of zstd's decompressor: one frame a page.
#include "run/unpack/decompressors.h"

#include <zstd.h>

namespace meshlode::run {

UnpackOutcome unpack_zstd(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out) {
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), stored.data(), stored.size());
  return ZSTD_isError(size) == 0U && size == out.size() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
}

}  // namespace meshlode::run
