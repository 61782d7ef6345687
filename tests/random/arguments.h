// SPDX-License-Identifier: GPL-3.0-or-later
// What random_scenes is told on its command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene.h"
#include "trial.h"

namespace meshlode::test {

struct Arguments {
  std::vector<std::string> positional;
  std::filesystem::path program;  ///< meshlode
  std::uint64_t jobs = 1;
  std::uint64_t max_triangles = UINT64_MAX;  ///< larger scenes are passed over
  std::uint64_t max_refused_percent = 100;
  double cpu_seconds = 120.0;
  std::optional<std::uint64_t> samples{};  ///< verify's --samples; its own default without
  std::filesystem::path shrink_into;       ///< failures are shrunk into this folder
  double shrink_seconds = 60.0;            ///< each
  std::string rule;
  std::vector<std::string> with;  ///< every scene is built with these, and by none of its own options; empty: its own
  Harm harm = Harm::kDamage;
  bool verbose = false;
  bool is_started = false;  ///< steps are forks of one process a job (StartedProgram)
  Depth depth = Depth::kAll;
};

/// The whole text as a number.
[[nodiscard]] bool parse(std::string_view text, std::uint64_t& value);

/// False where a word is not understood, or none is there.
[[nodiscard]] bool parse(int argc, char** argv, Arguments& arguments);

/// Says how to call the program. \returns its exit code, 1
int usage();

}  // namespace meshlode::test
