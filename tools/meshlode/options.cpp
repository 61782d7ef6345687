// SPDX-License-Identifier: GPL-3.0-or-later
// CLI11 and oneTBB's thread limit, seen by this file alone.
#include "options.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <limits>
#include <type_traits>
#include <utility>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>
#include <CLI/CLI.hpp>

#include "base/byte_size.h"
#include "base/nearest_name.h"
#include "base/printable.h"
#include "format/names.h"

namespace meshlode::cli {

namespace {

std::string running_verb;  ///< for errors; written once, before any thread is started

constexpr std::uint32_t kMaxJobs = 256;  ///< threads beyond that only cost memory

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

/// What an option that names a file or a folder is given; nullptr for all others.
const char* place_of(std::string_view option) {
  constexpr std::string_view kFiles[] = {"--output",  "--report", "--manifest", "--junit",
                                         "--depfile", "--html",   "--source",   "--path"};
  constexpr std::string_view kFolders[] = {"--output-folder", "--cache", "--settings-root", "--out-dir",
                                           "--allow-outside"};
  const auto is_among = [&](std::span<const std::string_view> names) {
    return std::find(names.begin(), names.end(), option) != names.end();
  };
  return is_among(kFiles) ? "a file name" : is_among(kFolders) ? "the name of a folder" : nullptr;
}

/// An empty name is none: a variable of a script that is not set.
std::string empty_fault(const CLI::Option& option, const std::string& word) {
  if (!word.empty()) return "";
  if (option.get_positional()) return "the argument is empty";
  const char* const place = option.get_lnames().empty() ? nullptr : place_of("--" + option.get_lnames().back());
  return place != nullptr ? std::string("needs ") + place : "";
}

}  // namespace

struct OptionParser::State {
  explicit State(const Verb& verb)
      : app(verb.summary, std::string("meshlode ") + verb.name),
        verb_name(verb.name),
        listed_options(verb.listed_options) {
    app.footer(std::string("Example:\n  ") + verb.example);
    app.allow_extras(false);
    note(*app.get_help_ptr(), {}, {});
  }

  /// One value, the last one given wins nothing: giving an option twice is a usage error (CLI11's default).
  template <class T>
  void add(const char* name, T& target, const char* help, const std::vector<std::string>& choices = {},
           bool is_required = false) {
    CLI::Option& option = *app.add_option(name, target, help);
    const std::string value = option.get_type_name();
    option.check(CLI::Validator(
        [choices, &option](std::string& word) {
          if (std::string fault = empty_fault(option, word); !fault.empty()) return fault;
          return choices.empty() ? value_fault<T>(word) : choice_fault(word, choices);
        },
        ""));
    option.required(is_required);
    note(option, value, choices);
  }

  void note(const CLI::Option& option, std::string value, const std::vector<std::string>& choices) {
    OptionInfo info;
    for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
    info.is_positional = option.get_positional();
    if (info.is_positional) info.names = {option.get_name(true)};
    info.value = std::move(value);
    info.choices = choices;
    info.help = option.get_description();
    info.is_required = option.get_required();
    info.is_many = option.get_items_expected_max() > 1;
    options.push_back(std::move(info));
  }

  CLI::App app;
  std::string verb_name;
  OptionTable options;  ///< as the app has them, in the order of the help
  OptionTable* listed_options;
};

OptionParser::OptionParser(const Verb& verb) : state_(std::make_unique<State>(verb)) {}
OptionParser::~OptionParser() = default;

void OptionParser::add_flag(const char* name, bool& target, const char* help) {
  state_->note(*state_->app.add_flag(name, target, help), {}, {});
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
  CLI::Option& option = *state_->app.add_option(name, target, help);
  option.allow_extra_args(false);  // else it takes the scene that stands behind its value
  option.check(CLI::Validator([&option](std::string& word) { return empty_fault(option, word); }, ""));
  state_->note(option, option.get_type_name(), {});
}
void OptionParser::add_positional(const char* name, std::string& target, const char* help) {
  state_->add(name, target, help, {}, true);
}
void OptionParser::add_positional(const char* name, std::optional<std::string>& target, const char* help,
                                  const std::vector<std::string>& choices) {
  state_->add(name, target, help, choices);
}
void OptionParser::add_positionals(const char* name, std::vector<std::string>& target, const char* help) {
  state_->add(name, target, help, {}, true);
}

void add_max_decoded_option(OptionParser& parser, std::string& size) {
  parser.add_value("--max-decoded", size,
                   "what images, and geometry beyond 64 times the file, may take in memory: bytes, or with KiB, MiB, "
                   "GiB, KB, MB, GB (512MiB)");
}

void add_allow_outside_option(OptionParser& parser, std::vector<std::string>& folders) {
  parser.add_values("--allow-outside", folders, "read files that the scene names from below DIR too; may be repeated");
}

Result<std::vector<std::filesystem::path>> parse_allow_outside(const std::vector<std::string>& folders) {
  std::vector<std::filesystem::path> out;
  for (const std::string& folder : folders) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) {
      return Error{ErrorCode::kIo, "--allow-outside", "'" + printable(folder) + "' is no folder"};
    }
    out.emplace_back(folder);
  }
  return out;
}

Status check_samples(std::uint64_t samples) {
  constexpr std::uint64_t kMost = 100'000'000;
  if (samples >= 1 && samples <= kMost) return Ok{};
  return Error{ErrorCode::kUsage, "--samples", "give 1 to 100000000"};
}

Error wrong_size(const char* option, const std::string& got, const char* wanted) {
  return {ErrorCode::kUsage, option, "expected " + std::string(wanted) + got_text(got)};
}

Result<std::uint64_t> parse_max_decoded(const std::string& size) {
  const std::optional<std::uint64_t> bytes = parse_byte_size(size);
  if (!bytes) return wrong_size("--max-decoded", size, "a size, such as 512MiB or 500MB");
  return *bytes;
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

/// What an option without its value lacks.
std::string needed_value(const OptionInfo& option) {
  if (!option.choices.empty()) return "needs a value: " + list_of_choices(option.choices);
  if (option.value == "UINT") return "needs a whole number";
  if (option.value == "FLOAT") return "needs a number";
  const char* const place = place_of(option.names.back());
  return place != nullptr ? std::string("needs ") + place : "needs a value";
}

/// "info takes one argument (file)".
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
    return {name + (text.ends_with("missing") ? ": " + needed_value(*option) : ": given more than once"), true};
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
    *state_->listed_options = state_->options;
    return 0;
  }
  // CLI11 takes the arguments last first.
  std::vector<std::string> reversed(args.rbegin(), args.rend());
  try {
    state_->app.parse(std::move(reversed));
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    return print_out(state_->app.help()) ? 0 : static_cast<int>(ErrorCode::kIo);
  } catch (const CLI::ParseError& e) {
    const UsageFault fault = usage_fault(state_->app, state_->verb_name, state_->options, e);
    return print_error({ErrorCode::kUsage, "",
                        fault.text + (fault.is_explained ? "" : "; see " + state_->app.get_name() + " --help")});
  }
}

void add_output_options(OptionParser& parser, OutputOptions& options, const std::vector<std::string>& more_formats) {
  std::vector<std::string> formats{"text", "json"};
  formats.insert(formats.end(), more_formats.begin(), more_formats.end());
  std::string help = "what is printed on stdout: " + formats.front();
  for (std::size_t i = 1; i < formats.size(); ++i) help += (i + 1 < formats.size() ? ", " : " or ") + formats[i];
  parser.add_value("--format", options.format, help.c_str(), formats);
  parser.add_flag("-q,--quiet", options.quiet, "no progress and no summary; errors are still printed");
}

void add_jobs_option(OptionParser& parser, std::uint32_t& jobs) {
  parser.add_value("-j,--jobs", jobs, "threads; 0 is one per core. The output never depends on it");
}

struct JobLimit::State {
  explicit State(std::uint32_t jobs)
      : control(tbb::global_control::max_allowed_parallelism, jobs), arena(static_cast<int>(jobs)) {}
  tbb::global_control control;
  tbb::task_arena arena;
};

JobLimit::JobLimit(std::uint32_t jobs)
    : state_(jobs == 0 ? nullptr : std::make_unique<State>(std::min(jobs, kMaxJobs))) {}
JobLimit::~JobLimit() = default;

void JobLimit::run(const std::function<void()>& work) {
  if (!state_) return work();
  state_->arena.execute(work);
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || end != part.data() + part.size() || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

std::string unknown_word(std::string_view what, std::string_view word, const std::vector<std::string>& known) {
  return "unknown " + std::string(what) + " '" + printable(word, 64) + "'" + nearest_hint(word, known);
}

std::string cli11_version() {
  return CLI11_VERSION;
}

std::string onetbb_version() {
  return TBB_runtime_version();
}

void name_verb_in_errors(std::string_view verb) {
  running_verb = std::string(verb);
}

int print_error(const Error& error) {
  // One line whatever the detail holds: file names and JSON texts may have line breaks and control characters.
  const bool is_usage = error.code == ErrorCode::kUsage && !running_verb.empty();
  std::string line = (is_usage ? "meshlode " + running_verb : "meshlode") + ": " + error.message();
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  line += '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
  return static_cast<int>(error.code);
}

bool print_out(const std::string& text) {
  const bool ok = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (ok) return true;
  // A reader that has enough, such as head, is no failure: what the command found still decides the exit code.
  if (errno == EPIPE) return true;
  print_error({ErrorCode::kIo, "stdout", std::string("cannot write: ") + std::strerror(errno)});
  return false;
}

}  // namespace meshlode::cli
