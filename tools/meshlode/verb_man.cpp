// SPDX-License-Identifier: GPL-3.0-or-later
// man: the manual pages, as this very program would have them.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/version.h"
#include "man_page.h"
#include "options.h"
#include "outputs.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

constexpr const char* kProgram = "meshlode";  ///< the page of the program itself

/// File names and pages.
std::vector<std::pair<std::string, std::string>> all_pages(const std::vector<VerbHelp>& verbs) {
  std::vector<std::pair<std::string, std::string>> pages;
  pages.emplace_back(man_page_name({}), program_man_page(verbs, program_version()));
  for (const VerbHelp& verb : verbs) {
    pages.emplace_back(man_page_name(verb.name), verb_man_page(verb, verbs, program_version()));
  }
  return pages;
}

int run_man(const Verb& verb, std::span<char* const> args) {
  std::optional<std::string> page;
  std::string folder;
  std::vector<std::string> names{kProgram};
  for (const Verb* other : all_verbs()) names.emplace_back(other->name);
  OptionParser parser(verb);
  parser.add_positional("page", page, "a verb; the program's own page where not given", names);
  parser.add_value("-O,--output-folder", folder, "an existing folder to write all pages into");
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (page && !folder.empty()) return print_error({ErrorCode::kUsage, "", "give a page or -O, not both"});
  const auto pages = all_pages(all_verb_help());
  const std::string wanted = man_page_name(page.value_or(kProgram) == kProgram ? "" : *page);
  for (const auto& [name, text] : pages) {
    if (!folder.empty()) {
      const std::string path = (std::filesystem::path(folder) / name).string();
      if (const Status written = write_text(path, text); !written) return print_error(written.error());
    } else if (name == wanted) {
      return print_out(text) ? 0 : static_cast<int>(ErrorCode::kIo);
    }
  }
  return 0;
}

}  // namespace

const Verb kManVerb{"man", "the manual pages, of the program or of a verb",
                    "meshlode man build | man -l -\n  meshlode man -O /usr/local/share/man/man1", run_man};

}  // namespace meshlode::cli
