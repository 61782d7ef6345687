// SPDX-License-Identifier: GPL-3.0-or-later
// man: the manual pages, as this very program would have them.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/version.h"
#include "help_text.h"
#include "man_page.h"
#include "options.h"
#include "outputs.h"
#include "terminal.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

constexpr const char* kProgram = "meshlode";  ///< the page of the program itself

struct Page {
  std::string verb, file, text;
};

/// As of --format.
std::vector<Page> all_pages(const std::vector<VerbHelp>& verbs, bool is_markdown) {
  std::vector<Page> pages;
  if (is_markdown) {
    pages.push_back({kProgram, "README.md", reference_index(verbs)});
    for (const VerbHelp& verb : verbs) pages.push_back({verb.name, verb.name + ".md", reference_page(verb)});
    return pages;
  }
  pages.push_back({kProgram, man_page_name({}), program_man_page(verbs, program_version())});
  for (const VerbHelp& verb : verbs) {
    pages.push_back({verb.name, man_page_name(verb.name), verb_man_page(verb, verbs, program_version())});
  }
  return pages;
}

/// By `man`, with its pager. False where the machine has none, or one that shows no file.
bool show_by_man(const std::string& page) {
  if (std::system("command -v man >/dev/null 2>&1") != 0) return false;
  std::FILE* const man = ::popen("man -l -", "w");
  if (man == nullptr) return false;
  std::fputs(page.c_str(), man);
  return ::pclose(man) == 0;
}

int run_man(const Verb& verb, std::span<char* const> args) {
  std::optional<std::string> page, format;
  std::string folder;
  std::vector<std::string> names{kProgram};
  for (const Verb* other : all_verbs()) names.emplace_back(other->name);
  OptionParser parser(verb);
  parser.add_positional("PAGE", page, "a command (default: the program's own page)", names);
  parser.group("Output");
  parser.add_value("-O,--output-folder FOLDER", folder, "write all pages to this folder (default: one page to stdout)");
  parser.add_value(
      "--format", format,
      "format of the pages (default: roff; on a terminal man shows the page, or without man it is markdown)",
      {"roff", "markdown"});
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (page && !folder.empty()) return print_error({ErrorCode::kUsage, "", "give a page or -O, not both"});
  const bool is_shown = folder.empty() && !format && is_terminal(Stream::kOut);
  if (is_shown) {
    for (const Page& one : all_pages(all_verb_help(), false)) {
      if (one.verb == page.value_or(kProgram) && show_by_man(one.text)) return 0;
    }
  }
  for (const Page& one : all_pages(all_verb_help(), is_shown || format == "markdown")) {
    if (!folder.empty()) {
      const std::string path = (std::filesystem::path(folder) / one.file).string();
      if (const Status written = write_text(path, one.text); !written) return print_error(written.error());
    } else if (one.verb == page.value_or(kProgram)) {
      return print_out(one.text) ? 0 : static_cast<int>(ErrorCode::kIo);
    }
  }
  return 0;
}

}  // namespace

const Verb kManVerb{"man", "print the manual pages of the program and of its commands",
                    "Prints one manual page, or writes all of them to a folder, as pages for man or in Markdown. They "
                    "are made from the options of this program.",
                    "meshlode man build | man -l -\n"
                    "  meshlode man -O /usr/local/share/man/man1\n"
                    "  meshlode man --format markdown -O docs/reference/cli",
                    run_man};

}  // namespace meshlode::cli
