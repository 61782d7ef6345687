// SPDX-License-Identifier: GPL-3.0-or-later
// A verb's options as data: what `--help`, completion scripts, man pages and docs/reference/cli/ are made from.
// OptionParser fills it.
#pragma once

#include <string>
#include <vector>

namespace meshlode::cli {

struct OptionInfo {
  std::vector<std::string> names{};    ///< "-o", "--output"; of a positional argument its one name, such as "input"
  std::string value{};                 ///< what `--help` calls the value: "FILE", "auto|none"; empty: a flag
  std::string wanted{};                ///< what a value is: "a whole number", "a file name"; empty: any text
  std::vector<std::string> choices{};  ///< all values that there are; empty: any
  std::string help{};
  std::string usual{};  ///< the default; empty: there is none, or `help` says it
  std::string group{};  ///< the heading it is listed under
  bool is_positional = false;
  bool is_required = false;
  bool is_many = false;  ///< takes one value or more
};
using OptionTable = std::vector<OptionInfo>;

/// The group of positional arguments is listed first; what few need and what every verb has, last.
inline constexpr const char* kArguments = "Arguments";
inline constexpr const char* kAdvanced = "Advanced";
inline constexpr const char* kGeneral = "General";

struct VerbHelp {
  std::string name, summary, description, example;  ///< as in Verb
  OptionTable options;
};

/// "meaning (default: V)".
[[nodiscard]] inline std::string help_with_default(const OptionInfo& option) {
  return option.usual.empty() ? option.help : option.help + " (default: " + option.usual + ")";
}

/// The groups that the options belong to, in the order of the help.
[[nodiscard]] std::vector<std::string> groups_of(const OptionTable& options);

}  // namespace meshlode::cli
