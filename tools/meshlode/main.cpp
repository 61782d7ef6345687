// SPDX-License-Identifier: GPL-3.0-or-later
// meshlode VERB ARGUMENTS: finds the verb and runs it. Exit codes are ErrorCode's values (include/meshlode/result.h).
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "options.h"
#include "verb.h"

namespace meshlode::cli {
namespace {

void print_help(std::FILE* out) {
  std::fputs(
      "meshlode: glTF in, a streamable LOD DAG of meshlets out, and a judge that proves it right.\n\n"
      "usage: meshlode VERB [ARGUMENTS]\n\nverbs:\n",
      out);
  for (const Verb* verb : all_verbs()) std::fprintf(out, "  %-10s %s\n", verb->name, verb->summary);
  std::fputs(
      "\n`meshlode VERB --help` shows a verb's options and an example.\n"
      "exit codes: 0 ok, 1 usage, 2 input or output failed, 3 invalid input, 4 build failed, 5 unsupported,\n"
      "            6 a check failed\n",
      out);
}

int run(std::span<char* const> args) {
  if (args.empty()) {
    print_help(stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  const std::string_view name = args[0];
  if (name == "--help" || name == "-h" || name == "help") {
    print_help(stdout);
    return 0;
  }
  if (name == "--version") {
    std::puts("meshlode " MESHLODE_VERSION);
    return 0;
  }
  for (const Verb* verb : all_verbs()) {
    if (name == verb->name) return verb->run(*verb, args.subspan(1));
  }
  return print_error({ErrorCode::kUsage, "", "unknown verb '" + std::string(name) + "'; see meshlode --help"});
}

}  // namespace
}  // namespace meshlode::cli

int main(int argc, char** argv) {
  using meshlode::ErrorCode;
  using meshlode::cli::print_error;
  // Rooms return errors as values; what may still arrive here is memory running out, and standard library surprises.
  try {
    return meshlode::cli::run(std::span<char* const>(argv, static_cast<std::size_t>(argc)).subspan(argc > 0 ? 1 : 0));
  } catch (const std::bad_alloc&) {
    return print_error({ErrorCode::kBuildFailed, "", "out of memory"});
  } catch (const std::exception& e) {
    return print_error({ErrorCode::kBuildFailed, "", e.what()});
  }
}
