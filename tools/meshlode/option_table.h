// SPDX-License-Identifier: GPL-3.0-or-later
// A verb's options as data: what completion scripts and man pages are made from. OptionParser fills it, from the same
// calls that `--help` comes from.
#pragma once

#include <string>
#include <vector>

namespace meshlode::cli {

struct OptionInfo {
  std::vector<std::string> names;    ///< "-o", "--output"; of a positional argument its one name, such as "input"
  std::string value;                 ///< what `--help` calls the value: "TEXT", "UINT", "FLOAT"; empty: a flag
  std::vector<std::string> choices;  ///< all values that there are; empty: any
  std::string help;
  bool is_positional = false;
  bool is_required = false;
  bool is_many = false;  ///< takes one value or more
};
using OptionTable = std::vector<OptionInfo>;

struct VerbHelp {
  std::string name, summary, example;  ///< as in Verb
  OptionTable options;
};

}  // namespace meshlode::cli
