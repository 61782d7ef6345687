// SPDX-License-Identifier: GPL-3.0-or-later
// Pack: the GPU-ready bytes of a page become its disk bytes. Levels are fixed: equal bytes in, equal bytes out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode {

struct PackedPage {
  format::Codec codec = format::Codec::kNone;  ///< kNone where packing would not shrink the page
  std::vector<std::uint8_t> bytes;             ///< empty where `codec` is kNone: the page is stored as it is
};

/// Errors: kUnsupported for a codec that cannot be written; kBuildFailed where the codec itself fails.
[[nodiscard]] Result<PackedPage> pack_page(std::span<const std::uint8_t> page, format::Codec codec);

}  // namespace meshlode
