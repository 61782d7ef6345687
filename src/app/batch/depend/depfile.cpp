// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/depend/depfile.h"

#include <set>

#include "base/printable.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

/// What both Make and Ninja take for the file: backslashes mean themselves but before a blank or a #.
std::string escaped_for_make(const std::filesystem::path& path) {
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

Status check_depfile_path(const std::filesystem::path& path) {
  if (path.native().find_first_of("\n\r") == std::string::npos) return Ok{};
  return Error{ErrorCode::kUsage, "--depfile",
               "a name with a line break cannot be in a depfile (got '" + printable(path.string(), 200) + "')"};
}

Result<std::string> depfile_text(const std::vector<DepfileRule>& rules) {
  for (const DepfileRule& rule : rules) {
    TRY(check_depfile_path(rule.output));
    for (const std::filesystem::path& input : rule.inputs) {
      TRY(check_depfile_path(input));
    }
  }
  std::string text;
  std::set<std::string> alone;
  for (const DepfileRule& rule : rules) {
    text += escaped_for_make(rule.output) + ":";
    for (std::size_t i = 0; i < rule.inputs.size(); ++i) {
      text += (i == 0 ? " " : " \\\n  ") + escaped_for_make(rule.inputs[i]);
      if (i > 0) alone.insert(escaped_for_make(rule.inputs[i]));
    }
    text += "\n";
  }
  for (const std::string& input : alone) text += input + ":\n";
  return text;
}

}  // namespace meshlode::app
