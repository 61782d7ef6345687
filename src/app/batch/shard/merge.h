// SPDX-License-Identifier: GPL-3.0-or-later
// The manifests of all shards become the one of the batch.
#pragma once

#include <filesystem>
#include <vector>

#include <meshlode/result.h>

#include "app/batch/shard/read_manifest.h"

namespace meshlode::app {

struct ShardManifest {
  std::filesystem::path path;  ///< for words
  Manifest manifest;
};

/// What one batch on one machine would have told: its files in its order, each exactly once, and its worst exit code.
/// Errors: kInvalid one is of no shard; kCheckFailed shards are missing, twice, of different batches, settings or
/// programs, another program than this one wrote them, or a file of the batch is in none or in several of them, or
/// they name other files than the batch had.
[[nodiscard]] Result<Manifest> merge_shards(std::vector<ShardManifest> shards);

/// Whether every asset that is told of lies where it should, with its bytes. Errors: kCheckFailed.
[[nodiscard]] Status check_assets(const std::vector<JobResult>& results);

}  // namespace meshlode::app
