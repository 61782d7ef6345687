// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a word of the command line means: a file, a folder with what lies below it, or a pattern.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::app {

/// Which files of a folder or a pattern are meant: by their extensions.
enum class InputKind : std::uint8_t { kScenes, kAssets, kScenesAndAssets };

struct FoundInputs {
  std::filesystem::path base;  ///< the folder, or those in front of the first wildcard; empty for a file
  std::vector<std::filesystem::path> files;
};

/// Whether it has wildcards and no file has this very name.
[[nodiscard]] bool is_pattern(const std::string& word);

/// A path that exists is no pattern, and one that is no folder is itself, whatever it is called. What lies below a
/// folder or matches a pattern is in byte order. Errors: kIo, also where nothing matches a pattern; an empty folder is
/// none.
[[nodiscard]] Result<FoundInputs> find_inputs(const std::string& word, InputKind kind);

}  // namespace meshlode::app
