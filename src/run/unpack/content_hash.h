// SPDX-License-Identifier: MIT
// The content hash of an asset computed again from its decoded content (docs/format.md, Content hash).
#pragma once

#include "base/hash.h"
#include "run/read/asset.h"

namespace meshlode::run {

/// What FileHeader::content_hash must be. Reads every page and blob. Errors: those of load_page.
[[nodiscard]] Result<Hash128> hash_asset_content(const Asset& asset);

}  // namespace meshlode::run
