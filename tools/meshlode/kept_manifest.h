// SPDX-License-Identifier: GPL-3.0-or-later
// Manifests that a command reads: no output replaces them, nor what they list.
#pragma once

#include <span>
#include <string>

#include <meshlode/result.h>

#include "app/batch/shard/read_manifest.h"

namespace meshlode::cli {

/// `writer`: the command that writes such files, for the error where this is another one.
[[nodiscard]] Result<app::Manifest> read_kept_manifest(const std::string& path,
                                                       const std::string& writer = "meshlode build --manifest");
/// Scenes, the files that these name, and assets.
void keep_results(std::span<const app::JobResult> results);

}  // namespace meshlode::cli
