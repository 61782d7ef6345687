// SPDX-License-Identifier: GPL-3.0-or-later
// Patterns of file names, for those that no shell has expanded: a quoted one, and `**`, which most shells do not know.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::app {

/// Whether any of * ? [ is in it.
[[nodiscard]] bool has_wildcards(std::string_view text);

/// One name against one pattern: `*` any text, `?` one byte, `[a-z]` and `[!a-z]` one byte of a set; a bracket that is
/// never closed means itself. A leading dot is matched by a dot alone. Takes at most pattern times name steps.
[[nodiscard]] bool matches_name(std::string_view pattern, std::string_view name);

struct GlobMatches {
  std::filesystem::path base;                ///< the folders in front of the first wildcard; empty where there are none
  std::vector<std::filesystem::path> files;  ///< `base` and what lies below it, in byte order
};

/// The regular files that a path with wildcards means. A part that is `**` stands for any number of folders, links to
/// folders not followed. Errors: kIo a folder cannot be read. No match is no error.
[[nodiscard]] Result<GlobMatches> find_matches(const std::string& pattern);

}  // namespace meshlode::app
