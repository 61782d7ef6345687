// SPDX-License-Identifier: GPL-3.0-or-later
// CLI11 and oneTBB's thread limit, seen by this file alone.
#include "options.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <CLI/CLI.hpp>

#include "base/byte_size.h"

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kMaxJobs = 256;  ///< threads beyond that only cost memory

}  // namespace

struct OptionParser::State {
  explicit State(const Verb& verb) : app(verb.summary, std::string("meshlode ") + verb.name) {
    app.footer(std::string("Example:\n  ") + verb.example);
    app.allow_extras(false);
  }
  CLI::App app;
};

OptionParser::OptionParser(const Verb& verb) : state_(std::make_unique<State>(verb)) {}
OptionParser::~OptionParser() = default;

void OptionParser::add_flag(const char* name, bool& target, const char* help) {
  state_->app.add_flag(name, target, help);
}

namespace {

/// One value, the last one given wins nothing: giving an option twice is a usage error (CLI11's default).
template <class T>
CLI::Option* add_option(CLI::App& app, const char* name, T& target, const char* help) {
  return app.add_option(name, target, help);
}

}  // namespace

void OptionParser::add_value(const char* name, std::string& target, const char* help,
                             const std::vector<std::string>& choices) {
  CLI::Option* option = add_option(state_->app, name, target, help);
  if (!choices.empty()) option->check(CLI::IsMember(choices));
}
void OptionParser::add_value(const char* name, double& target, const char* help) {
  add_option(state_->app, name, target, help);
}
void OptionParser::add_value(const char* name, std::uint32_t& target, const char* help) {
  add_option(state_->app, name, target, help);
}
void OptionParser::add_value(const char* name, std::uint64_t& target, const char* help) {
  add_option(state_->app, name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<double>& target, const char* help) {
  add_option(state_->app, name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<std::uint32_t>& target, const char* help) {
  add_option(state_->app, name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<std::uint64_t>& target, const char* help) {
  add_option(state_->app, name, target, help);
}
void OptionParser::add_value(const char* name, std::optional<std::string>& target, const char* help,
                             const std::vector<std::string>& choices) {
  CLI::Option* option = add_option(state_->app, name, target, help);
  if (!choices.empty()) option->check(CLI::IsMember(choices));
}
void OptionParser::add_positional(const char* name, std::string& target, const char* help) {
  add_option(state_->app, name, target, help)->required();
}
void OptionParser::add_positionals(const char* name, std::vector<std::string>& target, const char* help) {
  add_option(state_->app, name, target, help)->required();
}

void add_max_decoded_option(OptionParser& parser, std::string& size) {
  parser.add_value(
      "--max-decoded", size,
      "what images, and geometry beyond 64 times the file, may take in memory: bytes, or with KiB, MiB, GiB (512MiB)");
}

Result<std::uint64_t> parse_max_decoded(const std::string& size) {
  const std::optional<std::uint64_t> bytes = parse_byte_size(size);
  if (!bytes) return Error{ErrorCode::kUsage, "--max-decoded", "give a size, such as 512MiB"};
  return *bytes;
}

std::optional<int> OptionParser::parse(std::span<char* const> args) {
  // CLI11 takes the arguments last first.
  std::vector<std::string> reversed(args.rbegin(), args.rend());
  try {
    state_->app.parse(std::move(reversed));
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    return print_out(state_->app.help()) ? 0 : static_cast<int>(ErrorCode::kIo);
  } catch (const CLI::ParseError& e) {
    const std::string name = state_->app.get_name();
    return print_error({ErrorCode::kUsage, "", std::string(e.what()) + "; see " + name + " --help"});
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
