// SPDX-License-Identifier: GPL-3.0-or-later
// In the place of the two wrappers of Draco, where there is no Draco of this standard library: numbers are stored by
// zstd, so that everything around the codec can be tested.
#include <zstd.h>

#include "run/unpack/decompressors.h"
#include "support/old_codecs/compressors.h"

namespace meshlode {

Result<std::vector<std::uint8_t>> test::compress_draco(const std::vector<std::uint32_t>& values) {
  if (values.empty()) return std::vector<std::uint8_t>();
  const std::size_t bytes = values.size() * sizeof(values[0]);
  std::vector<std::uint8_t> out(ZSTD_compressBound(bytes));
  out.resize(ZSTD_compress(out.data(), out.size(), values.data(), bytes, 19));
  return out;
}

run::UnpackOutcome run::unpack_draco(std::span<const std::uint8_t> stored, std::span<std::uint32_t> out) {
  if (out.empty()) return stored.empty() ? UnpackOutcome::kOk : UnpackOutcome::kBroken;
  return ZSTD_decompress(out.data(), out.size_bytes(), stored.data(), stored.size()) == out.size_bytes()
             ? UnpackOutcome::kOk
             : UnpackOutcome::kBroken;
}

}  // namespace meshlode
