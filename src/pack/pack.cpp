// SPDX-License-Identifier: GPL-3.0-or-later
#include "pack/pack.h"

#include "pack/codecs.h"

namespace meshlode {

Result<PackedPage> pack_page(std::span<const std::uint8_t> page, format::Codec codec) {
  PackedPage out;
  if (codec == format::Codec::kNone) return out;
  if (codec != format::Codec::kLz4 && codec != format::Codec::kZstd) {
    return Error{ErrorCode::kUnsupported, "--codec", "this page codec is not written yet; none, lz4 and zstd are"};
  }
  auto packed = codec == format::Codec::kLz4 ? pack_lz4(page) : pack_zstd(page);
  if (!packed) return packed.error();
  if (packed->size() < page.size()) {
    out.codec = codec;
    out.bytes = std::move(*packed);
  }
  return out;
}

}  // namespace meshlode
