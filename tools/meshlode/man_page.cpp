// SPDX-License-Identifier: GPL-3.0-or-later
#include "man_page.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include "exit_codes.h"
#include "help_text.h"

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

/// "-o, --output FILE", and under it what it is for.
std::string option_text(const OptionInfo& option) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < option.names.size(); ++i) {
    if (i > 0) text += ", ";
    text += option.is_positional ? italic(option.names[i]) : bold(option.names[i]);
  }
  if (option.is_positional && option.is_many) text += " ...";
  if (!option.is_positional && !option.value.empty()) text += " " + italic(option.value);
  return text + "\n" + roff(in_lines(help_with_default(option))) + "\n";
}

std::string options_of(const VerbHelp& verb) {
  std::string text;
  bool has_heading = false;
  for (const std::string& group : groups_of(verb.options)) {
    const bool is_arguments = group == kArguments;
    if (!is_arguments && !has_heading) text += ".SH OPTIONS\n";
    has_heading = has_heading || !is_arguments;
    text += is_arguments ? ".SH ARGUMENTS\n" : ".SS " + roff(group) + "\n";
    for (const OptionInfo& option : verb.options) {
      if (option.group == group) text += option_text(option);
    }
  }
  return text;
}

/// Paragraphs with an empty line between them.
std::string description(std::string_view text) {
  std::string out = ".SH DESCRIPTION\n";
  while (true) {
    const std::size_t end = text.find("\n\n");
    out += roff(in_lines(std::string(text.substr(0, end)))) + "\n";
    if (end == std::string_view::npos) return out;
    out += ".PP\n";
    text.remove_prefix(end + 2);
  }
}

/// What a page says of one variable or file.
struct Mention {
  const char* name;
  const char* text;
  std::vector<std::string_view> verbs;  ///< empty: all
};

const std::vector<Mention>& environment() {
  static const std::vector<Mention> all = {
      {"MESHLODE_CACHE", "folder of earlier builds, unless --cache or --no-cache is given", {"build"}},
      {"NO_COLOR", "if set and not empty, nothing is coloured unless --color always is given", {}},
      {"TERM", "nothing is coloured if it is not set or is dumb", {}},
      {"LC_ALL, LC_CTYPE, LANG",
       "the first that is set decides whether a terminal shows bars in blocks (UTF-8) or in ASCII",
       {"info"}},
  };
  return all;
}

const std::vector<Mention>& files() {
  static const std::vector<Mention> all = {
      {"meshlode.json",
       "settings of the scenes in the same folder; an option wins over it, and it wins over the defaults",
       {"build", "plan"}},
      {".meshlode-*.tmp",
       "an output while it is written, in the folder of the output. It is renamed when it is complete. What a killed "
       "process left is removed by the next command that writes there",
       {"build", "extract", "info", "measure", "merge", "plan", "render", "repack", "sweep"}},
  };
  return all;
}

/// Nothing where the verb has none; all of them for the program's page, whose verb is empty.
std::string mentions(const char* heading, const std::vector<Mention>& all, const std::string& verb) {
  std::string text;
  for (const Mention& one : all) {
    const bool is_own = one.verbs.empty() || std::find(one.verbs.begin(), one.verbs.end(), verb) != one.verbs.end();
    if (is_own || verb.empty()) text += ".TP\n" + bold(one.name) + "\n" + roff(in_lines(one.text)) + "\n";
  }
  return text.empty() ? text : std::string(".SH ") + heading + "\n" + text;
}

std::string synopsis(const VerbHelp& verb) {
  std::string text = bold("meshlode " + verb.name) + " [" + italic("OPTIONS") + "]";
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
  std::string text = head({}, version, kProgramSummary);
  text += ".SH SYNOPSIS\n" + bold("meshlode") + " " + italic("COMMAND") + " [" + italic("ARGUMENTS") + "]\n.br\n" +
          bold("meshlode help") + " [" + italic("COMMAND") + "]\n" + description(kProgramDescription) +
          ".SH COMMANDS\nEach has a page of its own, and " + bold("--help") + ".\n";
  for (const VerbHelp& verb : verbs) {
    text += ".TP\n" + bold(verb.name) + "\n" + roff(in_lines(verb.summary)) + "\n";
  }
  text += ".SH OPTIONS\n.TP\n" + bold("-h") + ", " + bold("--help") + "\nprint the commands and the exit codes\n.TP\n" +
          bold("-V") + ", " + bold("--version") +
          "\nprint the program\\(aqs version and build id, and the versions of its libraries\n";
  return text + mentions("ENVIRONMENT", environment(), {}) + mentions("FILES", files(), {}) + exit_status() +
         see_also(verbs, {});
}

std::string verb_man_page(const VerbHelp& verb, std::span<const VerbHelp> verbs, const std::string& version) {
  std::string text = head(verb.name, version, verb.summary) + synopsis(verb) + description(verb.description) +
                     options_of(verb) + ".SH EXAMPLES\n.nf\n";
  for (const std::string& line : lines_of(verb.example)) text += roff(line) + "\n";
  return text + ".fi\n" + mentions("ENVIRONMENT", environment(), verb.name) + mentions("FILES", files(), verb.name) +
         exit_status() + see_also(verbs, verb.name);
}

std::string man_page_name(const std::string& verb) {
  return page_title(verb) + ".1";
}

}  // namespace meshlode::cli
