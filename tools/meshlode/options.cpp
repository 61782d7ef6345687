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
#include <utility>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>
#include <CLI/CLI.hpp>

#include "base/byte_size.h"
#include "base/nearest_name.h"
#include "base/printable.h"

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kMaxJobs = 256;  ///< threads beyond that only cost memory

}  // namespace

struct OptionParser::State {
  explicit State(const Verb& verb)
      : app(verb.summary, std::string("meshlode ") + verb.name), listed_options(verb.listed_options) {
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
    if (!choices.empty()) option.check(CLI::IsMember(choices));
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
  parser.add_value(
      "--max-decoded", size,
      "what images, and geometry beyond 64 times the file, may take in memory: bytes, or with KiB, MiB, GiB (512MiB)");
}

void add_allow_outside_option(OptionParser& parser, std::vector<std::string>& folders) {
  parser.add_values("--allow-outside", folders,
                    "a folder beside the scene's from which files that the scene names may be read; may be repeated");
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

Result<std::uint64_t> parse_max_decoded(const std::string& size) {
  const std::optional<std::uint64_t> bytes = parse_byte_size(size);
  if (!bytes) return Error{ErrorCode::kUsage, "--max-decoded", "give a size, such as 512MiB"};
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

/// What is wrong with the arguments. An unknown option is named first: that an argument is missing is often its fault.
std::string usage_fault(const CLI::App& app, const OptionTable& options, const CLI::ParseError& error) {
  const auto word = find_unknown_option(app);
  if (!word) return error.what();
  std::vector<std::string> known;
  const bool is_long = word->starts_with("--");  // nobody who wrote two dashes meant a letter
  for (const OptionInfo& option : options) {
    if (option.is_positional) continue;
    std::copy_if(option.names.begin(), option.names.end(), std::back_inserter(known),
                 [&](const std::string& name) { return !is_long || name.starts_with("--"); });
  }
  return unknown_word("option", *word, known);
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
    const std::string fault = usage_fault(state_->app, state_->options, e);
    return print_error({ErrorCode::kUsage, "", fault + "; see " + state_->app.get_name() + " --help"});
  }
}

void add_output_options(OptionParser& parser, OutputOptions& options, const std::vector<std::string>& more_formats) {
  std::vector<std::string> formats{"text", "json"};
  formats.insert(formats.end(), more_formats.begin(), more_formats.end());
  std::string help = "what is printed on stdout: " + formats.front();
  for (std::size_t i = 1; i < formats.size(); ++i) help += (i + 1 < formats.size() ? ", " : " or ") + formats[i];
  parser.add_value("--format", options.format, help.c_str(), formats);
  parser.add_flag("--quiet", options.quiet, "no progress and no summary; errors are still printed");
}

void add_jobs_option(OptionParser& parser, std::uint32_t& jobs) {
  parser.add_value("--jobs", jobs, "threads; 0 is one per core. The output never depends on it");
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
  return "unknown " + std::string(what) + " '" + printable(word, 64) + "'; the nearest is " + nearest_name(word, known);
}

std::string cli11_version() {
  return CLI11_VERSION;
}

std::string onetbb_version() {
  return TBB_runtime_version();
}

int print_error(const Error& error) {
  // One line whatever the detail holds: file names and JSON texts may have line breaks and control characters.
  std::string line = "meshlode: " + error.message();
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  line += '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
  return static_cast<int>(error.code);
}

bool print_out(const std::string& text) {
  const bool ok = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!ok) print_error({ErrorCode::kIo, "stdout", std::string("cannot write: ") + std::strerror(errno)});
  return ok;
}

}  // namespace meshlode::cli
