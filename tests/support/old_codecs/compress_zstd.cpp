// SPDX-License-Identifier: GPL-3.0-or-later
// Wrapper of zstd's compressor: one frame a page, without a checksum, because the page record has its own.
#include <zstd.h>

#include "support/old_codecs/compressors.h"

namespace meshlode::test {

constexpr int kZstdLevel = 12;  ///< beyond, pages of 128 KiB hardly shrink while the time doubles

Result<std::vector<std::uint8_t>> compress_zstd(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> out(ZSTD_compressBound(bytes.size()));
  const std::size_t written = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(written) != 0U) return Error{ErrorCode::kBuildFailed, "zstd", ZSTD_getErrorName(written)};
  out.resize(written);
  return out;
}

}  // namespace meshlode::test
