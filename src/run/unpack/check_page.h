// SPDX-License-Identifier: MIT
// Everything inside a decoded page that decode relies on.
#pragma once

#include <cstdint>
#include <span>

#include "run/read/asset.h"

namespace meshlode::run {

/// The layout of a page leaves no freedom: every offset is the only one possible and every unnamed bit is zero, so no
/// bit of a page is without meaning. Errors: kInvalid with the place.
[[nodiscard]] Status check_page(const Asset& asset, PageId page, std::span<const std::uint32_t> words);

}  // namespace meshlode::run
