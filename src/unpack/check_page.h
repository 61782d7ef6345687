// SPDX-License-Identifier: MIT
// Everything inside a decoded page that decode relies on.
#pragma once

#include <cstdint>
#include <span>

#include "read/asset.h"

namespace meshlode {

/// The layout of a page leaves no freedom: every offset is the only one possible and every padding byte is zero, so no
/// byte of a page is without meaning. Errors: kInvalid with the place.
[[nodiscard]] Status check_page(const Asset& asset, PageId page, std::span<const std::uint8_t> bytes);

}  // namespace meshlode
