// SPDX-License-Identifier: GPL-3.0-or-later
// The scene that an asset was built from, for the verbs that hold the one against the other.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "options.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::cli {

struct SourceOptions {
  std::string path;
  bool repair = false, linear_colors = false, is_forced = false;
  std::vector<std::string> allow_outside;
};

/// --source, --repair, --linear-colors, --force and --allow-outside.
void add_source_options(OptionParser& parser, SourceOptions& options);

/// Errors: kUsage where none is given, where it and the asset are swapped, or where a folder is none.
[[nodiscard]] Status check_source_options(const std::string& verb, const std::string& asset_path,
                                          const SourceOptions& options);

/// Imported as the asset says that it was, or as asked for. Its files are kept from being written to.
[[nodiscard]] Result<scene::Scene> import_source(const run::Asset& asset, const SourceOptions& options,
                                                 std::uint64_t max_decoded);

/// What is wrong where the scene is another one than the asset was built from; nothing where that is forced.
[[nodiscard]] std::optional<std::string> describe_other_source(const run::Asset& asset, const scene::Scene& source,
                                                               const SourceOptions& options);

}  // namespace meshlode::cli
