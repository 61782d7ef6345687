// SPDX-License-Identifier: GPL-3.0-or-later
// What `build --manifest` wrote, read again (tell/manifest.cpp writes it).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/batch/jobs/job_result.h"
#include "app/batch/shard/partition.h"
#include "app/batch/tell/tell.h"
#include "base/hash.h"

namespace meshlode::app {

struct Manifest {
  std::string generator;
  std::uint64_t version = 1;
  Hash128 program{};
  Versions versions;
  std::string settings;  ///< as settings_text()
  int exit_code = 0;
  bool is_complete = true;         ///< false: the batch was interrupted, or is still at work
  std::optional<ShardPlan> shard;  ///< nothing: it is of a whole batch
  /// With what a manifest tells: of the facts the bytes, of a file's stamp its bytes.
  std::vector<JobResult> results;
};

/// Errors: kUnsupported for a version that is not known; kInvalid with the place; `where` has no file's name.
[[nodiscard]] Result<Manifest> parse_manifest(std::string_view text);

/// Errors: kIo; as parse_manifest, with the file's name.
[[nodiscard]] Result<Manifest> read_manifest(const std::filesystem::path& path);

}  // namespace meshlode::app
