// SPDX-License-Identifier: GPL-3.0-or-later
// Which asset `compare` holds against which, of two folders or two manifests.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/hash.h"
#include "bulk.h"
#include "run/read/asset.h"

namespace meshlode::cli {

/// The asset, with all that is stored in it as it was written: opening does not look at pages and images. `listed`:
/// what a manifest says that it is. Errors: those of opening; kInvalid for damaged pages and images; kCheckFailed for
/// another asset than the manifest lists.
[[nodiscard]] Result<run::Asset> open_sound(const std::string& path, std::uint64_t max_decoded,
                                            const std::optional<Hash128>& listed);

/// Of each file `path` is the newer asset and `source` the older; one of them is empty where there is no other.
/// By their places below the folders: those of the newer one first, then what it has no more. Errors: kIo, also for
/// folders without an asset.
[[nodiscard]] Result<std::vector<BulkInput>> pair_folders(const std::string& before, const std::string& after);

/// Assets of one scene are a pair, else those of one output; of a scene that is there more than once those of one
/// output first. Errors: those of reading; kIo for manifests without an entry.
[[nodiscard]] Result<std::vector<BulkInput>> pair_manifests(const std::string& before, const std::string& after);

}  // namespace meshlode::cli
