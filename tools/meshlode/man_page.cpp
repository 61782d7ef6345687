// SPDX-License-Identifier: GPL-3.0-or-later
#include "man_page.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include "exit_codes.h"

namespace meshlode::cli {

namespace {

/// Text that shows as it is: roff reads a backslash as an escape, sets '-' as a hyphen and quotes in typographic form,
/// and takes a line that begins with '.' or a quote for a request.
std::string roff(std::string_view text) {
  std::string out;
  bool is_line_start = true;
  for (const char c : text) {
    if (is_line_start && (c == '.' || c == '\'')) out += "\\&";
    is_line_start = c == '\n';
    switch (c) {
      case '\\': out += "\\e"; break;
      case '-': out += "\\-"; break;
      case '\'': out += "\\(aq"; break;
      case '`': out += "\\(ga"; break;
      case '^': out += "\\(ha"; break;
      case '~': out += "\\(ti"; break;
      default: out += c;
    }
  }
  return out;
}

std::string bold(std::string_view text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(std::string_view text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

/// Lines of the page's source, which a reader fills anew, of 80 characters at most unless a word is longer.
std::string in_lines(std::string text) {
  constexpr std::size_t kWidth = 64;  // of what roff() may lengthen
  text = one_line(std::move(text));
  std::size_t first = 0;
  while (text.size() - first > kWidth) {
    std::size_t space = text.rfind(' ', first + kWidth);
    if (space == std::string::npos || space < first) space = text.find(' ', first);
    if (space == std::string::npos) break;
    text[space] = '\n';
    first = space + 1;
  }
  return text;
}

std::string page_title(const std::string& verb) {
  return verb.empty() ? "meshlode" : "meshlode-" + verb;
}

std::string head(const std::string& verb, const std::string& version, const std::string& summary) {
  std::string title = page_title(verb);
  const std::string name = title;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return ".TH " + roff(title) + " 1 \"\" \"" + roff(version) + "\" \"User Commands\"\n.SH NAME\n" + roff(name) +
         " \\- " + roff(one_line(summary)) + "\n";
}

/// "-o, --output TEXT", and under it what it is for.
std::string option_text(const OptionInfo& option) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < option.names.size(); ++i) {
    if (i > 0) text += ", ";
    text += option.is_positional ? italic(option.names[i]) : bold(option.names[i]);
  }
  if (option.is_positional && option.is_many) text += " ...";
  if (!option.is_positional && !option.value.empty()) text += " " + italic(option.value);
  text += "\n" + roff(in_lines(option.help)) + "\n";
  if (option.choices.empty()) return text;
  text += ".br\nOne of ";
  for (std::size_t i = 0; i < option.choices.size(); ++i) {
    text += (i == 0 ? "" : ", ") + bold(option.choices[i]);
  }
  return text + ".\n";
}

std::string options_of(const VerbHelp& verb, bool is_positional) {
  std::string text;
  for (const OptionInfo& option : verb.options) {
    if (option.is_positional == is_positional) text += option_text(option);
  }
  return text;
}

std::string synopsis(const VerbHelp& verb) {
  std::string text = bold("meshlode " + verb.name) + " [" + italic("options") + "]";
  for (const OptionInfo& option : verb.options) {
    if (!option.is_positional) continue;
    const std::string name = italic(option.names.front()) + (option.is_many ? " ..." : "");
    text += option.is_required ? " " + name : " [" + name + "]";
  }
  return ".SH SYNOPSIS\n" + text + "\n";
}

std::string exit_status() {
  std::string text = ".SH EXIT STATUS\n";
  for (const ExitCodeInfo& info : kExitCodes) {
    text += ".TP\n" + bold(std::to_string(info.code)) + "\n" + roff(info.meaning) + "\n";
  }
  return text;
}

/// All pages but `own`.
std::string see_also(std::span<const VerbHelp> verbs, const std::string& own) {
  std::vector<std::string> pages;
  if (!own.empty()) pages.emplace_back();
  for (const VerbHelp& verb : verbs) {
    if (verb.name != own) pages.push_back(verb.name);
  }
  std::string text = ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < pages.size(); ++i) {
    text += ".BR " + roff(page_title(pages[i])) + (i + 1 < pages.size() ? " (1),\n" : " (1)\n");
  }
  return text;
}

}  // namespace

std::string program_man_page(std::span<const VerbHelp> verbs, const std::string& version) {
  std::string text =
      head({}, version, "glTF in, a streamable LOD DAG of meshlets out, and a judge that proves it right");
  text += ".SH SYNOPSIS\n" + bold("meshlode") + " " + italic("verb") + " [" + italic("arguments") + "]\n.br\n" +
          bold("meshlode --help") + " | " + bold("--version") + "\n.SH VERBS\nEach has a page of its own, and " +
          bold("--help") + ".\n";
  for (const VerbHelp& verb : verbs) {
    text += ".TP\n" + bold(verb.name) + "\n" + roff(in_lines(verb.summary)) + "\n";
  }
  text += ".SH OPTIONS\n.TP\n" + bold("-h") + ", " + bold("--help") + "\nthe verbs and the exit codes\n.TP\n" +
          bold("--version") + "\nthe program\\(aqs version and build id, and the versions of its libraries\n";
  return text + exit_status() + see_also(verbs, {});
}

std::string verb_man_page(const VerbHelp& verb, std::span<const VerbHelp> verbs, const std::string& version) {
  std::string text = head(verb.name, version, verb.summary) + synopsis(verb);
  if (const std::string arguments = options_of(verb, true); !arguments.empty()) text += ".SH ARGUMENTS\n" + arguments;
  text += ".SH OPTIONS\n" + options_of(verb, false);
  text += ".SH EXAMPLES\n.nf\n";
  std::string_view lines = verb.example;
  while (true) {
    const std::size_t end = lines.find('\n');
    std::string_view line = lines.substr(0, end);
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    text += roff(line) + "\n";
    if (end == std::string_view::npos) break;
    lines.remove_prefix(end + 1);
  }
  return text + ".fi\n" + exit_status() + see_also(verbs, verb.name);
}

std::string man_page_name(const std::string& verb) {
  return page_title(verb) + ".1";
}

}  // namespace meshlode::cli
