// SPDX-License-Identifier: GPL-3.0-or-later
// Which asset `compare` holds against which, of two folders or two manifests.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/hash.h"
#include "bulk.h"

namespace meshlode::cli {

struct ComparePairs {
  /// `path` is the newer asset, `source` the older; one of them is empty where there is no other.
  std::vector<BulkInput> files;
  /// What manifests say that the files are.
  std::map<std::string, Hash128> old_hashes, new_hashes;
};

/// By their places below the folders: those of the newer one first, then what it has no more. Errors: kIo, also for
/// folders without an asset.
[[nodiscard]] Result<ComparePairs> pair_folders(const std::string& before, const std::string& after);

/// Assets of one scene are a pair, else those of one output; of a scene that is there more than once those of one
/// output first. Errors: those of reading; kIo for manifests without an entry.
[[nodiscard]] Result<ComparePairs> pair_manifests(const std::string& before, const std::string& after);

}  // namespace meshlode::cli
