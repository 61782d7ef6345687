// SPDX-License-Identifier: GPL-3.0-or-later
#include "completion.h"

#include <string_view>
#include <vector>

namespace meshlode::cli {

namespace {

/// Of the program itself, beside its verbs.
constexpr const char* kProgramOptions[] = {"--help", "--version"};

/// `text` with a backslash before each of `special`.
std::string escaped(std::string_view text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// One word of a POSIX shell's line.
std::string shell_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      out += c;
    }
  }
  return out + "'";
}

/// In fish a backslash and a quote are escaped inside of quotes.
std::string fish_quoted(std::string_view text) {
  return "'" + escaped(text, "\\'") + "'";
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : between) + word;
  return line;
}

std::vector<std::string> option_names(const VerbHelp& verb) {
  std::vector<std::string> names;
  for (const OptionInfo& option : verb.options) {
    if (!option.is_positional) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

std::string bash_verb(const VerbHelp& verb) {
  std::vector<std::string> words, with_files;
  std::string cases;
  for (const OptionInfo& option : verb.options) {
    if (option.is_positional) {
      words.insert(words.end(), option.choices.begin(), option.choices.end());
    } else if (!option.choices.empty()) {
      cases +=
          "        " + joined(option.names, "|") + ") values=" + shell_quoted(joined(option.choices, " ")) + " ;;\n";
    } else if (!option.value.empty()) {
      with_files.insert(with_files.end(), option.names.begin(), option.names.end());
    }
  }
  if (!with_files.empty()) cases += "        " + joined(with_files, "|") + ") return ;;\n";
  std::string text = "    " + verb.name + ")\n";
  text += "      options=" + shell_quoted(joined(option_names(verb), " ")) + "\n";
  if (!words.empty()) text += "      words=" + shell_quoted(joined(words, " ")) + "\n";
  if (!cases.empty()) text += "      case $prev in\n" + cases + "      esac\n";
  return text + "      ;;\n";
}

/// What _arguments completes a value or an argument by.
std::string zsh_action(const OptionInfo& option) {
  if (option.choices.empty()) return "_files";
  std::string words;
  for (const std::string& choice : option.choices) words += (words.empty() ? "" : " ") + escaped(choice, "\\:() ");
  return "(" + words + ")";
}

std::string zsh_verb(const VerbHelp& verb) {
  constexpr std::string_view kSpecial = "\\:[]";
  std::string text = "    " + verb.name + ")\n      _arguments -S";
  for (const OptionInfo& option : verb.options) {
    const std::string action = ":" + escaped(option.value, kSpecial) + ":" + zsh_action(option);
    if (option.is_positional) {
      const std::string name = escaped(option.names.front(), kSpecial);
      const std::string many = option.is_many ? "*" : option.is_required ? "" : ":";
      std::string spec = many;
      spec += ":" + name + ":" + zsh_action(option);
      text += " \\\n        " + shell_quoted(spec);
      continue;
    }
    for (const std::string& name : option.names) {
      std::string spec = option.names.size() > 1 ? "(" + joined(option.names, " ") + ")" : std::string();
      spec += name;
      // A value stands behind it or, of a long name, behind '='.
      if (!option.value.empty()) spec += name.starts_with("--") ? "=" : "+";
      spec += "[" + escaped(option.help, kSpecial) + "]";
      text += " \\\n        " + shell_quoted(option.value.empty() ? spec : spec + action);
    }
  }
  return text + "\n      ;;\n";
}

std::string fish_option(const std::string& condition, const OptionInfo& option) {
  std::string line = "complete -c meshlode -n " + condition;
  if (option.is_positional) {
    if (option.choices.empty()) return {};
    return line + " -f -a " + fish_quoted(joined(option.choices, " ")) + " -d " + fish_quoted(option.help) + "\n";
  }
  for (const std::string& name : option.names) {
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!option.choices.empty()) {
    line += " -x -a " + fish_quoted(joined(option.choices, " "));
  } else if (!option.value.empty()) {
    line += " -r -F";
  }
  return line + " -d " + fish_quoted(option.help) + "\n";
}

}  // namespace

std::string bash_completion(std::span<const VerbHelp> verbs) {
  std::string names;
  for (const VerbHelp& verb : verbs) names += verb.name + " ";
  for (const char* option : kProgramOptions) names += std::string(option) + " ";
  names.pop_back();
  std::string text =
      "# bash completion of meshlode, made by `meshlode completion bash`\n"
      "_meshlode() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} options='' words='' values=''\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W " +
      shell_quoted(names) +
      " -- \"$cur\"))\n"
      "    return\n"
      "  fi\n"
      "  # --option=value comes as three words\n"
      "  if [ \"$cur\" = = ]; then cur=''; elif [ \"$prev\" = = ]; then prev=${COMP_WORDS[COMP_CWORD-2]}; fi\n"
      "  case ${COMP_WORDS[1]} in\n";
  for (const VerbHelp& verb : verbs) text += bash_verb(verb);
  return text +
         "  esac\n"
         "  if [ -n \"$values\" ]; then words=$values; elif [[ $cur == -* ]]; then words=$options; fi\n"
         "  [ -z \"$words\" ] || COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
         "}\n"
         "complete -o bashdefault -o default -F _meshlode meshlode\n";
}

std::string zsh_completion(std::span<const VerbHelp> verbs) {
  std::string text =
      "#compdef meshlode\n"
      "# zsh completion of meshlode, made by `meshlode completion zsh`\n"
      "_meshlode() {\n"
      "  if (( CURRENT == 2 )); then\n"
      "    local -a verbs\n"
      "    verbs=(\n";
  for (const VerbHelp& verb : verbs) {
    text += "      " + shell_quoted(escaped(verb.name, "\\:") + ":" + escaped(verb.summary, "\\:")) + "\n";
  }
  text += "    )\n    _describe -t verbs verb verbs\n    compadd -- ";
  for (const char* option : kProgramOptions) text += std::string(option) + " ";
  text.back() = '\n';
  text +=
      "    return\n"
      "  fi\n"
      "  local verb=$words[2]\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $verb in\n";
  for (const VerbHelp& verb : verbs) text += zsh_verb(verb);
  return text +
         "  esac\n"
         "}\n"
         "if [ \"$funcstack[1]\" = _meshlode ]; then _meshlode \"$@\"; else compdef _meshlode meshlode; fi\n";
}

std::string fish_completion(std::span<const VerbHelp> verbs) {
  std::string text =
      "# fish completion of meshlode, made by `meshlode completion fish`\n"
      "function __meshlode_verb_is\n"
      "  set -l words (commandline -opc)\n"
      "  test (count $words) -ge 2; and test \"$words[2]\" = \"$argv[1]\"\n"
      "end\n"
      "function __meshlode_needs_verb\n"
      "  test (count (commandline -opc)) -eq 1\n"
      "end\n";
  for (const VerbHelp& verb : verbs) {
    text +=
        "complete -c meshlode -n __meshlode_needs_verb -f -a " + verb.name + " -d " + fish_quoted(verb.summary) + "\n";
  }
  for (const char* option : kProgramOptions) {
    text += "complete -c meshlode -n __meshlode_needs_verb -f -l " + std::string(option).substr(2) + "\n";
  }
  for (const VerbHelp& verb : verbs) {
    for (const OptionInfo& option : verb.options) {
      text += fish_option("'__meshlode_verb_is " + verb.name + "'", option);
    }
  }
  return text;
}

}  // namespace meshlode::cli
