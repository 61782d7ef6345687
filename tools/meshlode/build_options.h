// SPDX-License-Identifier: GPL-3.0-or-later
// The options of every verb that builds or plans a build: a table of settings (build/settings/), read as one layer.
#pragma once

#include <string>

#include "build/settings/settings.h"
#include "options.h"

namespace meshlode::cli {

struct BuildWords {
  build::SettingLayer layer{"the command line", ErrorCode::kUsage, {}};
  bool repair = false;
  std::string scene;  ///< of the file: a name, an index or `all`; empty: its default
};

/// `--error-tier`, `--preset` and so on.
void add_build_options(OptionParser& parser, BuildWords& words);

/// What was given, after the parse.
[[nodiscard]] build::SettingLayer given_settings(const BuildWords& words);

}  // namespace meshlode::cli
