// SPDX-License-Identifier: GPL-3.0-or-later
// `info --html`: the page of an asset, with the asset's pages as a browser reads them and the runtime that does.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <meshlode/result.h>

#include "app/report/byte_map.h"
#include "run/read/asset.h"

namespace meshlode::cli {

/// Errors: kUnsupported where this program was built without the WebAssembly module, which says what was missing.
[[nodiscard]] Status can_write_info_page();

/// The HTML, with at most `max_page_bytes` of stored pages. `path` is the asset's, of which the page says the name.
/// Errors: those of can_write_info_page(), and of reading and packing pages.
[[nodiscard]] Result<std::string> info_page(const run::Asset& asset, const std::string& path,
                                            const std::optional<app::ByteMap>& byte_map, std::uint64_t max_page_bytes);

}  // namespace meshlode::cli
