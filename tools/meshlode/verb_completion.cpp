// SPDX-License-Identifier: GPL-3.0-or-later
// completion: a script by which a shell completes what this very program knows.
#include <optional>
#include <string>
#include <vector>

#include "completion.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct Shell {
  const char* name;
  std::string (*script)(std::span<const VerbHelp> verbs);
};
constexpr Shell kShells[] = {{"bash", bash_completion}, {"zsh", zsh_completion}, {"fish", fish_completion}};

int run_completion(const Verb& verb, std::span<char* const> args) {
  std::optional<std::string> name;
  std::string output;
  std::vector<std::string> names;
  for (const Shell& shell : kShells) names.emplace_back(shell.name);
  OptionParser parser(verb);
  parser.add_positional("SHELL", name, "shell to complete in", names);
  parser.group("Output");
  parser.add_value("-o,--output FILE", output, "file to write (default: stdout)");
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (const Status sound = check_text_name("-o", output, {}); !sound) return print_error(sound.error());
  for (const Shell& shell : kShells) {
    if (name != shell.name) continue;
    const std::string text = shell.script(all_verb_help());
    if (output.empty()) return print_out(text) ? 0 : static_cast<int>(ErrorCode::kIo);
    const Status written = write_text(output, text);
    return written ? 0 : print_error(written.error());
  }
  return print_error({ErrorCode::kUsage, "SHELL", "choose bash, zsh or fish"});
}

}  // namespace

const Verb kCompletionVerb{"completion", "print a script with which bash, zsh or fish completes commands and options",
                           "The script knows the commands, the options and the values of this program. Load it in the "
                           "shell's start file, or write it to where the shell looks for completions.",
                           "source <(meshlode completion bash)\n"
                           "  meshlode completion fish -o ~/.config/fish/completions/meshlode.fish",
                           run_completion};

}  // namespace meshlode::cli
