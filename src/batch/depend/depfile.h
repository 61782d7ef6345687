// SPDX-License-Identifier: GPL-3.0-or-later
// Dependencies in the form that Make and Ninja read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace meshlode::batch {

struct DepfileRule {
  std::filesystem::path output;
  std::vector<std::filesystem::path> inputs;  ///< the scene first
};

/// `output: inputs`, one rule a line, and an empty rule for every input behind a first one, so that a file that is no
/// longer there makes its asset be built again and not an error. Paths as given; a blank, # and $ are
/// escaped, a line break cannot be.
[[nodiscard]] std::string depfile_text(const std::vector<DepfileRule>& rules);

}  // namespace meshlode::batch
