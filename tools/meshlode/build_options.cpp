// SPDX-License-Identifier: GPL-3.0-or-later
#include "build_options.h"

#include <string>

namespace meshlode::cli {

void add_build_options(OptionParser& parser, BuildWords& words) {
  for (const build::SettingInfo& info : build::all_settings()) {
    const std::string name = std::string("--") + info.name;
    if (info.setting == build::Setting::kRepair) {
      parser.add_flag(name.c_str(), words.repair, info.help);
    } else {
      parser.add_value(name.c_str(), words.layer[info.setting], info.help, build::choices_of(info.setting));
    }
  }
  parser.add_value("--scene", words.scene,
                   "which scene of a glTF is instanced: a name, an index or all; the file's default where not given");
}

build::SettingLayer given_settings(const BuildWords& words) {
  build::SettingLayer layer = words.layer;
  if (words.repair) layer[build::Setting::kRepair] = "true";
  return layer;
}

}  // namespace meshlode::cli
