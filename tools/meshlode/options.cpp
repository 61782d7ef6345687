// SPDX-License-Identifier: GPL-3.0-or-later
// CLI11, seen by this file alone.
#include "options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>
#include <utility>

#include <CLI/CLI.hpp>

#include "base/nearest_name.h"
#include "base/printable.h"
#include "format/names.h"
#include "help_text.h"
#include "terminal.h"

namespace meshlode::cli {

namespace {

template <class T>
struct Plain {
  using Type = T;
};
template <class T>
struct Plain<std::optional<T>> {
  using Type = T;
};

/// Why a word is no value of this type; empty where it is one.
template <class T>
std::string value_fault(const std::string& word) {
  using Value = typename Plain<T>::Type;
  if constexpr (std::is_unsigned_v<Value>) {
    Value value = 0;
    const bool is_number = !word.starts_with('-') && CLI::detail::lexical_cast(word, value);
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
      return "expected a whole number, at most " + std::to_string(std::numeric_limits<Value>::max()) + got_text(word);
    }
    return is_number ? "" : "expected a whole number, 0 or more" + got_text(word);
  } else if constexpr (std::is_floating_point_v<Value>) {
    Value value = 0;
    return CLI::detail::lexical_cast(word, value) && std::isfinite(value) ? "" : "expected a number" + got_text(word);
  } else {
    return "";
  }
}

std::string choice_fault(const std::string& word, const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), word) != choices.end()) return "";
  if (word.empty()) return "needs a value: " + list_of_choices(choices);
  const bool is_of_codecs = choices == all_names(format::kWrittenCodecNames);
  if (is_of_codecs && value_in(format::kCodecNames, word)) return format::not_written(word);
  return unknown_choice(printable(word, 64), choices);
}

/// What a value of this type, that the help calls so, is in words; empty: any text.
template <class T>
const char* wanted_value(std::string_view value) {
  using Value = typename Plain<T>::Type;
  if (std::is_unsigned_v<Value>) return "a whole number";
  if (std::is_floating_point_v<Value>) return "a number";
  return value == "FILE" ? "a file name" : value == "FOLDER" ? "the name of a folder" : "";
}

/// An empty name is none: a variable of a script that is not set.
std::string empty_fault(const CLI::Option& option, const std::string& wanted, const std::string& word) {
  if (!word.empty()) return "";
  if (option.get_positional()) return "the argument is empty";
  return wanted.empty() ? "" : "needs " + wanted;
}

/// What the help says of a target that nothing is given for; empty where the target does not say it.
template <class T>
std::string usual_text(const T& target) {
  if constexpr (std::is_same_v<T, std::string>) return target;
  if constexpr (std::is_arithmetic_v<T>) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, target).ptr};
  }
  return {};
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// "--size WxH": what CLI11 takes, and what the help calls the value.
struct NamedValue {
  std::string names, value;

  NamedValue(std::string_view name, const char* other_value) : names(name.substr(0, name.find(' '))) {
    value = names.size() < name.size() ? name.substr(names.size() + 1) : other_value;
  }
};

}  // namespace

struct OptionParser::State {
  explicit State(const Verb& verb)
      : app(verb.summary, std::string("meshlode ") + verb.name),
        help{verb.name, verb.summary, verb.description, verb.example, {}},
        listed_options(verb.listed_options) {
    app.allow_extras(false);
    group = kGeneral;
    app.set_help_flag("-h,--help", "print this help");
    note(*app.get_help_ptr());
    add("--color", color, "colour in what a terminal shows; auto: unless NO_COLOR is set", {"auto", "always", "never"});
    group = "Options";
  }

  /// One value, the last one given wins nothing: giving an option twice is a usage error (CLI11's default).
  template <class T>
  void add(const char* name, T& target, const char* text, const std::vector<std::string>& choices = {},
           bool is_required = false) {
    const bool is_number = std::is_arithmetic_v<typename Plain<T>::Type>;
    const std::string all = joined(choices, "|");
    const NamedValue named(name, !choices.empty() ? all.c_str() : is_number ? "N" : "TEXT");
    CLI::Option& option = *app.add_option(named.names, target, text);
    const std::string wanted = wanted_value<T>(named.value);
    option.check(CLI::Validator(
        [choices, wanted, &option](std::string& word) {
          if (choices.empty() && !std::is_arithmetic_v<typename Plain<T>::Type>)
            return empty_fault(option, wanted, word);
          return choices.empty() ? value_fault<T>(word) : choice_fault(word, choices);
        },
        ""));
    option.required(is_required);
    OptionInfo& info = note(option);
    info.value = named.value;
    info.wanted = choices.empty() ? wanted : "a value: " + list_of_choices(choices);
    info.choices = choices;
    info.usual = usual_text(target);
  }

  OptionInfo& note(const CLI::Option& option) {
    OptionInfo& info = help.options.emplace_back();
    for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
    info.is_positional = option.get_positional();
    if (info.is_positional) info.names = {option.get_name(true)};
    info.help = option.get_description();
    info.group = info.is_positional ? kArguments : group;
    info.is_required = option.get_required();
    info.is_many = option.get_items_expected_max() > 1;
    return info;
  }

  CLI::App app;
  VerbHelp help;  ///< options as the app has them, in the order in which they were added
  OptionTable* listed_options;
  std::string group;
  std::string color = "auto";
};

OptionParser::OptionParser(const Verb& verb) : state_(std::make_unique<State>(verb)) {}
OptionParser::~OptionParser() = default;

void OptionParser::group(const char* heading) {
  state_->group = heading;
}
void OptionParser::add_flag(const char* name, bool& target, const char* help) {
  state_->note(*state_->app.add_flag(name, target, help));
}
void OptionParser::add_value(const char* name, std::string& target, const char* help,
                             const std::vector<std::string>& choices) {
  state_->add(name, target, help, choices);
}
void OptionParser::add_value(const char* name, double& target, const char* help) {
  state_->add(name, target, help);
}
void OptionParser::add_value(const char* name, std::uint32_t& target, const char* help) {
  state_->add(name, target, help);
}
void OptionParser::add_value(const char* name, std::uint64_t& target, const char* help) {
  state_->add(name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<double>& target, const char* help) {
  state_->add(name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<std::uint32_t>& target, const char* help) {
  state_->add(name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<std::uint64_t>& target, const char* help) {
  state_->add(name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<std::string>& target, const char* help,
                             const std::vector<std::string>& choices) {
  state_->add(name, target, help, choices);
}
void OptionParser::add_values(const char* name, std::vector<std::string>& target, const char* help) {
  const NamedValue named(name, "TEXT");
  CLI::Option& option = *state_->app.add_option(named.names, target, help);
  option.allow_extra_args(false);  // else it takes the scene that stands behind its value
  const std::string wanted = wanted_value<std::string>(named.value);
  option.check(CLI::Validator([wanted, &option](std::string& word) { return empty_fault(option, wanted, word); }, ""));
  OptionInfo& info = state_->note(option);
  info.value = named.value;
  info.wanted = wanted;
}
void OptionParser::add_positional(const char* name, std::string& target, const char* help) {
  state_->add(name, target, help, {}, true);
}
void OptionParser::add_positional(const char* name, std::optional<std::string>& target, const char* help,
                                  const std::vector<std::string>& choices) {
  state_->add(name, target, help, choices);
}
void OptionParser::add_positionals(const char* name, std::vector<std::string>& target, const char* help,
                                   bool is_required) {
  state_->add(name, target, help, {}, is_required);
}

namespace {

/// The first word that looks like an option and is none.
std::optional<std::string> find_unknown_option(const CLI::App& app) {
  for (const std::string& word : app.remaining()) {
    if (word == "--") break;  // what follows are arguments, whatever they look like
    if (word.size() > 1 && word.front() == '-') return word.substr(0, word.find('='));
  }
  return std::nullopt;
}

/// The option that CLI11's text is about: it stands before the first colon.
const OptionInfo* find_option(const OptionTable& options, const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  for (const OptionInfo& option : options) {
    if (std::find(option.names.begin(), option.names.end(), name) != option.names.end()) return &option;
  }
  return nullptr;
}

/// "info takes one (FILE)".
std::string arguments_of(const std::string& verb, const OptionTable& options) {
  std::vector<std::string> names;
  for (const OptionInfo& option : options) {
    if (option.is_positional) names.push_back(option.names.front());
  }
  if (names.empty()) return verb + " takes none";
  std::string text = verb + " takes " + (names.size() == 1 ? "one" : std::to_string(names.size())) + " (";
  for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return text + ")";
}

struct UsageFault {
  std::string text;
  bool is_explained = false;  ///< the text says what to do
};

/// What is wrong with the arguments. An unknown option is named first: that an argument is missing is often its fault.
UsageFault usage_fault(const CLI::App& app, const std::string& verb, const OptionTable& options,
                       const CLI::ParseError& error) {
  if (const auto word = find_unknown_option(app)) {
    std::vector<std::string> known;  // of an option of one letter nobody knows which other one was meant
    for (const OptionInfo& option : options) {
      if (option.is_positional) continue;
      std::copy_if(option.names.begin(), option.names.end(), std::back_inserter(known),
                   [](const std::string& name) { return name.starts_with("--"); });
    }
    return {unknown_word("option", *word, known)};
  }
  const std::string text = error.what();
  const OptionInfo* option = find_option(options, text);
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) {
    // By the short name where it is the one that all use.
    const bool is_empty = text.starts_with("--output: needs");
    return {is_empty ? "-o" + text.substr(text.find(':')) : text, true};
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && option != nullptr) {
    const std::string name = text.substr(0, text.find(':'));
    const std::string needed = option->wanted.empty() ? "a value" : option->wanted;
    return {name + (text.ends_with("missing") ? ": needs " + needed : ": given more than once"), true};
  }
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {  // "Could not convert: --strict = maybe"
    const std::size_t name = text.find("--"), equals = text.find(" = ", name);
    if (equals != std::string::npos) {
      return {text.substr(name, equals - name) + ": takes no value" + got_text(text.substr(equals + 3)), true};
    }
  }
  const std::vector<std::string> rest = app.remaining();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !rest.empty()) {
    return {"unexpected argument '" + printable(rest.front(), 64) + "': " + arguments_of(verb, options), true};
  }
  return {text};
}

}  // namespace

std::optional<int> OptionParser::parse(std::span<char* const> args) {
  if (state_->listed_options != nullptr) {
    *state_->listed_options = state_->help.options;
    return 0;
  }
  // CLI11 takes the arguments last first.
  std::vector<std::string> reversed(args.rbegin(), args.rend());
  try {
    state_->app.parse(std::move(reversed));
    use_color(state_->color);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    return print_out(help_text(state_->help)) ? 0 : static_cast<int>(ErrorCode::kIo);
  } catch (const CLI::ParseError& e) {
    const UsageFault fault = usage_fault(state_->app, state_->help.name, state_->help.options, e);
    return print_error({ErrorCode::kUsage, "",
                        fault.text + (fault.is_explained ? "" : "; see " + state_->app.get_name() + " --help")});
  }
}

std::string cli11_version() {
  return CLI11_VERSION;
}

}  // namespace meshlode::cli
