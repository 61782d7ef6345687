// SPDX-License-Identifier: GPL-3.0-or-later
// The options of every verb that builds or plans a build: a table of settings (app/settings/), read as one layer.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "app/settings/settings.h"
#include "options.h"
#include "scene/scene.h"

namespace meshlode::cli {

struct BuildWords {
  app::SettingLayer layer{"the command line", ErrorCode::kUsage, {}, {}};
  std::array<bool, app::kSettingCount> flags{};  ///< of the settings that are flags
  std::string scene;                             ///< of the file: a name, an index or `all`; empty: its default
  bool no_file = false;
  std::string root;  ///< the outermost folder whose file counts; empty: the caller's
};

/// `--error-tier`, `--preset` and so on, and `--no-settings-file`.
void add_build_options(OptionParser& parser, BuildWords& words);

/// What was given, after the parse.
[[nodiscard]] app::SettingLayer given_settings(const BuildWords& words);

/// The files' layers from `root` down to the scene's folder, then what was given: app/settings/settings_file.h. Files
/// that were read are no outputs from here on.
[[nodiscard]] Result<std::vector<app::SettingLayer>> settings_for(const BuildWords& words,
                                                                  const std::filesystem::path& scene,
                                                                  const std::filesystem::path& root);

}  // namespace meshlode::cli
