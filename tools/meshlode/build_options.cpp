// SPDX-License-Identifier: GPL-3.0-or-later
#include "build_options.h"

#include <string>
#include <utility>

#include "app/settings/settings_file.h"
#include "outputs.h"

namespace meshlode::cli {

void add_build_options(OptionParser& parser, BuildWords& words) {
  for (const app::SettingInfo& info : app::all_settings()) {
    parser.group(info.group);
    const std::string name = std::string("--") + info.name;
    if (app::is_flag(info.setting)) {
      parser.add_flag(name.c_str(), words.flags[static_cast<std::size_t>(info.setting)], info.help);
      continue;
    }
    const std::string usual = *info.usual == '\0' ? "none" : info.usual;
    parser.add_value((name + info.value).c_str(), words.layer[info.setting],
                     (std::string(info.help) + " (default: " + usual + ")").c_str(), app::choices_of(info.setting));
  }
  parser.group("Input");
  add_scene_option(parser, words.scene);
  parser.add_value("--settings-root FOLDER", words.root,
                   "read every meshlode.json from FOLDER down to the scene (default: only the one beside the scene, "
                   "and with folders as input those above it)");
  parser.add_flag("--no-settings-file", words.no_file, "ignore meshlode.json");
}

app::SettingLayer given_settings(const BuildWords& words) {
  app::SettingLayer layer = words.layer;
  for (const app::SettingInfo& info : app::all_settings()) {
    if (words.flags[static_cast<std::size_t>(info.setting)]) layer[info.setting] = "true";
  }
  return layer;
}

Result<std::vector<app::SettingLayer>> settings_for(const BuildWords& words, const std::filesystem::path& scene,
                                                    const std::filesystem::path& root) {
  std::vector<app::SettingLayer> layers;
  if (!words.no_file) {
    std::vector<FileId> files_read;
    auto files =
        app::read_settings_files(scene, words.root.empty() ? root : std::filesystem::path(words.root), files_read);
    output_files().keep(files_read);
    if (!files) return files.error();
    layers = std::move(*files);
  }
  layers.push_back(given_settings(words));
  return layers;
}

}  // namespace meshlode::cli
