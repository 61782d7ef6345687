// SPDX-License-Identifier: GPL-3.0-or-later
// meshlode VERB ARGUMENTS: finds the verb and runs it. Exit codes are ErrorCode's values (include/meshlode/result.h).
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/guarded.h"
#include "base/printable.h"
#include "exit_codes.h"
#include "library_versions.h"
#include "options.h"
#include "outputs.h"
#include "verb.h"

namespace meshlode::cli {
namespace {

std::string exit_codes() {
  const std::string head = "exit codes: ";
  std::string text, line = head;
  for (std::size_t i = 0; i < kExitCodes.size(); ++i) {
    const std::string item =
        std::to_string(kExitCodes[i].code) + " " + kExitCodes[i].meaning + (i + 1 < kExitCodes.size() ? "," : "");
    if (line.size() + item.size() > 110) {
      text += line + "\n";
      line = std::string(head.size(), ' ');
    } else if (i > 0) {
      line += ' ';
    }
    line += item;
  }
  return text + line + "\n";
}

std::string help() {
  std::string text =
      "meshlode: glTF in, a streamable LOD DAG of meshlets out, and a judge that proves it right.\n\n"
      "usage: meshlode VERB [ARGUMENTS]\n\nverbs:\n";
  for (const Verb* verb : all_verbs()) {
    std::string name = verb->name;
    name.resize(std::max<std::size_t>(name.size(), 10), ' ');
    text += "  " + name + " " + verb->summary + "\n";
  }
  return text +
         "\n`meshlode VERB --help` shows a verb's options and an example; `meshlode --version` what it is built of.\n" +
         exit_codes();
}

/// The verb or option of the program that is nearest to what it is not.
int unknown_verb(std::string_view name) {
  std::vector<std::string> known;
  const bool is_option = name.starts_with('-');
  if (is_option) {
    known = {"--help", "--version"};
  } else {
    for (const Verb* verb : all_verbs()) known.emplace_back(verb->name);
  }
  return print_error(
      {ErrorCode::kUsage, "", unknown_word(is_option ? "option" : "verb", name, known) + "; see meshlode --help"});
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
    std::fputs(help().c_str(), stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  const std::string_view name = args[0];
  const bool is_version = name == "--version" || name == "-V" || name == "version";
  if (is_version && args.size() > 1 && is_help(args[1])) return print_or_fail(help());
  if (is_version && args.size() > 1) return unexpected(args[1], "version takes none");
  if (is_version) return print_or_fail(version_text());
  if (name == "help" && args.size() > 2) return unexpected(args[2], "help takes one (verb)");
  if (name == "help" && args.size() > 1 && !is_help(args[1])) return help_of(args[1]);
  if (is_help(name)) return print_or_fail(help());
  const Verb* const verb = find_verb(name);
  return verb != nullptr ? run_verb(*verb, args.subspan(1)) : unknown_verb(name);
}

/// Large arrays go back to the system as soon as they are freed. Left to itself, glibc takes the first one that is
/// freed as a sign to keep all up to its size for later, in gaps between what is still in use: a sixth of a build's
/// peak.
void give_back_large_arrays() {
#ifdef __GLIBC__
  constexpr int kLargeArray = 2 << 20, kKeptAtTheEnd = 32 << 20;  // bytes
  mallopt(M_MMAP_THRESHOLD, kLargeArray);
  mallopt(M_TRIM_THRESHOLD, kKeptAtTheEnd);
#endif
}

}  // namespace
}  // namespace meshlode::cli

int main(int argc, char** argv) {
  using meshlode::cli::print_error;
  meshlode::cli::give_back_large_arrays();
  meshlode::cli::watch_signals();
  meshlode::cli::end_where_memory_runs_out();
  const auto arguments = std::span<char* const>(argv, static_cast<std::size_t>(argc)).subspan(argc > 0 ? 1 : 0);
  const auto code = meshlode::guarded({}, [&]() -> meshlode::Result<int> { return meshlode::cli::run(arguments); });
  return code ? *code : print_error(code.error());
}
