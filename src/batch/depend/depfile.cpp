// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch/depend/depfile.h"

#include <set>

namespace meshlode::batch {

namespace {

/// What both Make and Ninja take for the file: backslashes mean themselves but before a blank or a #.
std::string escaped(const std::filesystem::path& path) {
  std::string out;
  std::size_t backslashes = 0;
  for (const char c : path.native()) {
    if (c == ' ' || c == '#') out.append(backslashes + 1, '\\');
    if (c == '$') out += '$';
    out += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return out;
}

}  // namespace

std::string depfile_text(const std::vector<DepfileRule>& rules) {
  std::string text;
  std::set<std::string> alone;
  for (const DepfileRule& rule : rules) {
    text += escaped(rule.output) + ":";
    for (std::size_t i = 0; i < rule.inputs.size(); ++i) {
      text += (i == 0 ? " " : " \\\n  ") + escaped(rule.inputs[i]);
      if (i > 0) alone.insert(escaped(rule.inputs[i]));
    }
    text += "\n";
  }
  for (const std::string& input : alone) text += input + ":\n";
  return text;
}

}  // namespace meshlode::batch
