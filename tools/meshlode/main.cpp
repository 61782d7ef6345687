// SPDX-License-Identifier: GPL-3.0-or-later
// meshlode VERB ARGUMENTS: finds the verb and runs it. Exit codes are ErrorCode's values (include/meshlode/result.h).
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/guarded.h"
#include "base/printable.h"
#include "base/system.h"
#include "help_text.h"
#include "large_arrays.h"
#include "library_versions.h"
#include "options.h"
#include "outputs.h"
#include "terminal.h"
#include "verb.h"

namespace meshlode::cli {
namespace {

std::string help() {
  constexpr std::size_t kWidth = 80;
  std::string text = fill_lines(kProgramDescription, "", 0, kWidth) + "\n" +
                     colored(Stream::kOut, Color::kBold, "Usage:") + " meshlode COMMAND [ARGUMENTS]\n\n" +
                     colored(Stream::kOut, Color::kBold, "Examples:") +
                     "\n  meshlode build scene.glb -o scene.lode\n  meshlode info scene.lode\n"
                     "  meshlode verify scene.lode --source scene.glb\n\n" +
                     colored(Stream::kOut, Color::kBold, "Commands:") + "\n";
  for (const Verb* verb : all_verbs()) {
    std::string name = std::string("  ") + verb->name;
    name.resize(14, ' ');
    text += fill_lines(verb->summary, name, name.size(), kWidth);
  }
  return text + "\n" + colored(Stream::kOut, Color::kBold, "Options:") +
         "\n  -h, --help        print this help; 'meshlode help COMMAND' that of a command\n"
         "  -V, --version     print the versions of the program and its libraries\n\n" +
         fill_lines("Exit status: " + exit_codes_line(), "", 2, kWidth) +
         "Manual: man meshlode, docs/reference/cli/README.md\n";
}

/// Names the command or the option of the program that is nearest.
int unknown_verb(std::string_view name) {
  std::vector<std::string> known;
  const bool is_option = name.starts_with('-');
  if (is_option) {
    known = {"--help", "--version"};
  } else {
    for (const Verb* verb : all_verbs()) known.emplace_back(verb->name);
  }
  return print_error(
      {ErrorCode::kUsage, "", unknown_word(is_option ? "option" : "command", name, known) + "; see meshlode --help"});
}

int print_or_fail(const std::string& text) {
  return print_out(text) ? 0 : static_cast<int>(ErrorCode::kIo);
}

int run_verb(const Verb& verb, std::span<char* const> args) {
  name_verb_in_errors(verb.name);
  return verb.run(verb, args);
}

/// `meshlode help VERB`.
int help_of(std::string_view name) {
  std::string option = "--help";
  char* const args[] = {option.data()};
  const Verb* const verb = find_verb(name);
  return verb != nullptr ? run_verb(*verb, args) : unknown_verb(name);
}

bool is_help(std::string_view word) {
  return word == "--help" || word == "-h" || word == "help";
}

int unexpected(std::string_view word, const char* what_is_taken) {
  return print_error({ErrorCode::kUsage, "", "unexpected argument '" + printable(word, 64) + "': " + what_is_taken});
}

int run(std::span<char* const> args) {
  if (args.empty()) {
    std::fputs((help() + "\n").c_str(), stderr);
    return print_error({ErrorCode::kUsage, "", "no command given"});
  }
  const std::string_view name = args[0];
  const bool is_version = name == "--version" || name == "-V" || name == "version";
  if (is_version && args.size() > 1 && is_help(args[1])) return print_or_fail(help());
  if (is_version && args.size() > 1) return unexpected(args[1], "version takes none");
  if (is_version) return print_or_fail(version_text());
  if (name == "help" && args.size() > 2) return unexpected(args[2], "help takes one (COMMAND)");
  if (name == "help" && args.size() > 1 && !is_help(args[1])) return help_of(args[1]);
  if (is_help(name)) return print_or_fail(help());
  const Verb* const verb = find_verb(name);
  return verb != nullptr ? run_verb(*verb, args.subspan(1)) : unknown_verb(name);
}

/// Each of malloc's arenas, of which every thread wants one, reserves 64 MiB of addresses. Where a limit (ulimit -v)
/// leaves none, glibc asks the system for every allocation by itself: with 16 threads under 150 MB that is 25 times as
/// slow. Fewer arenas than threads cost 10%, so that a quarter of the addresses are for arenas. So many that there is
/// one for each thread are left to glibc, and so is what the user sets.
void share_arenas_where_addresses_are_few() {
#ifdef __GLIBC__
  constexpr std::uint64_t kArena = 64ULL << 20U, kShare = 4, kMany = 64;
  const std::optional<std::uint64_t> left = system::memory_left();
  if (!left || std::getenv("MALLOC_ARENA_MAX") != nullptr) return;
  const std::uint64_t arenas = std::max<std::uint64_t>(*left / (kShare * kArena), 1);
  if (arenas < kMany) mallopt(M_ARENA_MAX, static_cast<int>(arenas));
#endif
}

}  // namespace
}  // namespace meshlode::cli

int main(int argc, char** argv) {
  using meshlode::cli::print_error;
  meshlode::cli::give_back_large_arrays();
  meshlode::cli::end_where_memory_runs_out();
  meshlode::cli::share_arenas_where_addresses_are_few();
  meshlode::cli::watch_signals();
  const auto arguments = std::span<char* const>(argv, static_cast<std::size_t>(argc)).subspan(argc > 0 ? 1 : 0);
  const auto code = meshlode::guarded({}, [&]() -> meshlode::Result<int> { return meshlode::cli::run(arguments); });
  return code ? *code : print_error(code.error());
}
