// SPDX-License-Identifier: GPL-3.0-or-later
// Wrapper of Draco's entropy coder for numbers (range asymmetric numeral systems), which keeps their order. Draco's own
// containers are not used: they would store counts and types that the page's heads already say.
#include <draco/compression/entropy/symbol_encoding.h>
#include <draco/core/encoder_buffer.h>
#include <draco/core/options.h>

#include "support/old_codecs/compressors.h"

namespace meshlode::test {

Result<std::vector<std::uint8_t>> compress_draco(const std::vector<std::uint32_t>& values) {
  std::vector<std::uint8_t> out;
  if (values.empty()) return out;
  draco::EncoderBuffer buffer;
  draco::Options options;
  draco::SetSymbolEncodingCompressionLevel(&options, 10);
  if (!draco::EncodeSymbols(values.data(), static_cast<int>(values.size()), 1, &options, &buffer)) {
    return Error{ErrorCode::kBuildFailed, "draco", "symbols could not be encoded"};
  }
  out.assign(buffer.data(), buffer.data() + buffer.size());
  return out;
}

}  // namespace meshlode::test
