// SPDX-License-Identifier: GPL-3.0-or-later
#include "help_text.h"

#include <algorithm>

#include "exit_codes.h"
#include "terminal.h"

namespace meshlode::cli {

namespace {

constexpr std::size_t kTextColumn = 29;  ///< where the texts of options begin; longer names have a line of their own

std::string names_text(const OptionInfo& option) {
  if (option.is_positional) return option.names.front() + (option.is_many ? "..." : "");
  std::string text;
  for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + name;
  return option.value.empty() ? text : text + " " + option.value;
}

std::string option_lines(const OptionInfo& option) {
  const bool has_short = option.is_positional || !option.names.front().starts_with("--");
  std::string head = (has_short ? "  " : "      ") + names_text(option);
  std::string lines;
  if (head.size() + 2 > kTextColumn) {
    lines = head + "\n";
    head.clear();
  }
  head.resize(kTextColumn, ' ');
  return lines + fill_lines(help_with_default(option), head, kTextColumn, kHelpWidth);
}

std::string heading(const std::string& text) {
  return "\n" + colored(Stream::kOut, Color::kBold, text + ":") + "\n";
}

/// Text of an option as Markdown shows it.
std::string markdown(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<' || c == '*' || c == '_' || c == '\\' || c == '`' || c == '[') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::vector<std::string> groups_of(const OptionTable& options) {
  std::vector<std::string> groups;
  for (const OptionInfo& option : options) {
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  }
  const auto rank = [](const std::string& group) {
    return group == kArguments ? 0 : group == kAdvanced ? 2 : group == kGeneral ? 3 : 1;
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return groups;
}

std::string fill_lines(std::string_view text, const std::string& first, std::size_t indent, std::size_t width) {
  constexpr std::size_t kLongestDefault = 24;
  std::string lines, line = first;
  bool is_empty = true;
  while (!text.empty()) {
    std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    const std::size_t close = text.starts_with("(default: ") ? text.find(')') : std::string_view::npos;
    if (close < kLongestDefault) end = close + 1;
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (word.empty()) continue;
    if (!is_empty && line.size() + 1 + word.size() > width) {
      lines += line + "\n";
      line = std::string(indent, ' ');
      is_empty = true;
    }
    line += (is_empty ? "" : " ") + std::string(word);
    is_empty = false;
  }
  return lines + line + "\n";
}

std::vector<std::string> lines_of(std::string_view example) {
  std::vector<std::string> lines;
  while (!example.empty()) {
    const std::size_t end = std::min(example.find('\n'), example.size());
    std::string_view line = example.substr(0, end);
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    lines.emplace_back(line);
    example.remove_prefix(std::min(end + 1, example.size()));
  }
  return lines;
}

std::string usage_line(const VerbHelp& verb) {
  std::string text = "meshlode " + verb.name + " [OPTIONS]";
  for (const OptionInfo& option : verb.options) {
    if (option.is_positional) text += option.is_required ? " " + names_text(option) : " [" + names_text(option) + "]";
  }
  return text;
}

std::string exit_codes_line() {
  std::string text;
  for (const ExitCodeInfo& info : kExitCodes) {
    text += (text.empty() ? "" : ", ") + std::to_string(info.code) + " " + info.meaning;
  }
  return text;
}

std::string reference_path(const std::string& verb) {
  return "docs/reference/cli/" + verb + ".md";
}

std::string help_text(const VerbHelp& verb) {
  std::string text = fill_lines(verb.summary + ".", "", 0, kHelpWidth);
  text[0] = static_cast<char>(text[0] >= 'a' && text[0] <= 'z' ? text[0] - 'a' + 'A' : text[0]);
  text += "\n" + colored(Stream::kOut, Color::kBold, "Usage:") + " " + usage_line(verb) + "\n";
  text += heading("Examples") + "  " + verb.example + "\n";
  for (const std::string& group : groups_of(verb.options)) {
    text += heading(group);
    for (const OptionInfo& option : verb.options) {
      if (option.group == group) text += option_lines(option);
    }
  }
  text += "\n" + fill_lines("Exit status: " + exit_codes_line(), "", 2, kHelpWidth);
  return text + "Manual: man meshlode-" + verb.name + ", " + reference_path(verb.name) + "\n";
}

std::string reference_page(const VerbHelp& verb) {
  std::string text =
      "# meshlode " + verb.name + "\n\n" + markdown(verb.description) + "\n\n```\n" + usage_line(verb) + "\n```\n";
  text += "\n## Examples\n\n```\n";
  for (const std::string& line : lines_of(verb.example)) text += line + "\n";
  text += "```\n";
  for (const std::string& group : groups_of(verb.options)) {
    text += "\n## " + group + "\n\n";
    for (const OptionInfo& option : verb.options) {
      if (option.group == group)
        text += "- `" + names_text(option) + "`: " + markdown(help_with_default(option)) + "\n";
    }
  }
  return text + "\n## Exit status\n\n" + exit_codes_line() + "\n";
}

std::string reference_index(std::span<const VerbHelp> verbs) {
  std::string text =
      "# Command line\n\n" + markdown(kProgramDescription) + "\n\n| command | what it does |\n| --- | --- |\n";
  for (const VerbHelp& verb : verbs)
    text += "| [" + verb.name + "](" + verb.name + ".md) | " + markdown(verb.summary) + " |\n";
  return text + "\nExit status: " + exit_codes_line() +
         ".\n\nThese pages are made by `meshlode man --format markdown -O docs/reference/cli`.\n";
}

}  // namespace meshlode::cli
