// SPDX-License-Identifier: MIT
// Wrapper of zstd's decompressor: one frame a page.
#include "run/unpack/decompressors.h"

#ifdef MESHLODE_HAS_ZSTD
#include <zstd.h>
#endif

namespace meshlode::run {

#ifdef MESHLODE_HAS_ZSTD
UnpackOutcome unpack_zstd(std::span<const std::uint8_t> stored, std::span<std::uint8_t> out) {
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), stored.data(), stored.size());
  return ZSTD_isError(size) == 0U && size == out.size() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
}
#else
UnpackOutcome unpack_zstd(std::span<const std::uint8_t>, std::span<std::uint8_t>) {
  return UnpackOutcome::kNotBuiltIn;
}
#endif

}  // namespace meshlode::run
