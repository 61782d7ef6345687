// SPDX-License-Identifier: GPL-3.0-or-later
// The hash of what an asset says, whatever codec its pages are stored in (docs/reference/format.md, Content hash).
#pragma once

#include <string_view>

#include "base/hash.h"
#include "builder/write/asset_tables.h"

namespace meshlode::builder {

[[nodiscard]] Hash128 hash_content(const AssetTables& tables, std::string_view document,
                                   std::span<const scene::SceneBlob> blobs, bool has_promises = false);

}  // namespace meshlode::builder
