// SPDX-License-Identifier: GPL-3.0-or-later
// Wrapper of LZ4's compressor: one block, no frame, because the page record already holds sizes and checksums.
#include <lz4hc.h>

#include "support/old_codecs/compressors.h"

namespace meshlode::test {

constexpr int kLz4Level = 9;

Result<std::vector<std::uint8_t>> compress_lz4(std::span<const std::uint8_t> bytes) {
  const int size = static_cast<int>(bytes.size());
  std::vector<std::uint8_t> out(static_cast<std::size_t>(LZ4_compressBound(size)));
  const int written = LZ4_compress_HC(reinterpret_cast<const char*>(bytes.data()), reinterpret_cast<char*>(out.data()),
                                      size, static_cast<int>(out.size()), kLz4Level);
  if (written <= 0) return Error{ErrorCode::kBuildFailed, "lz4", "compression failed"};
  out.resize(static_cast<std::size_t>(written));
  return out;
}

}  // namespace meshlode::test
