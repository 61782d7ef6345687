// SPDX-License-Identifier: GPL-3.0-or-later
// Dependencies in the form that Make and Ninja read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::app {

struct DepfileRule {
  std::filesystem::path output;
  std::vector<std::filesystem::path> inputs;  ///< the scene first
};

/// `output: inputs`, one rule a line, and an empty rule for every input behind a first one, so that a file that is no
/// longer there makes its asset be built again and not an error. Paths as given; a blank, # and $ are escaped. Errors:
/// as check_depfile_path().
[[nodiscard]] Result<std::string> depfile_text(const std::vector<DepfileRule>& rules);

/// Error: kUsage for a path with a line break, which no depfile can hold.
[[nodiscard]] Status check_depfile_path(const std::filesystem::path& path);

}  // namespace meshlode::app
