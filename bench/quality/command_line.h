// SPDX-License-Identifier: GPL-3.0-or-later
// What the command lines of these benchmarks have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

namespace meshlode::bench {

/// Reads the arguments. The exit code where there is nothing to measure: help was asked for, or an argument is wrong.
inline std::optional<int> read_command_line(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  }
}

/// Numbers with commas between them, each above 0; the word `none` is an empty list.
inline void add_numbers(CLI::App& app, const std::string& name, std::vector<double>& numbers, const std::string& help) {
  app.add_option_function<std::string>(
      name,
      [&numbers, name](const std::string& text) {
        numbers.clear();
        if (text == "none") return;
        for (const std::string& word : CLI::detail::split(text, ',')) {
          double x = 0.0;
          if (!CLI::detail::lexical_cast(word, x) || !(x > 0.0))
            throw CLI::ValidationError(name, "a list of numbers above 0, or none");
          numbers.push_back(x);
        }
      },
      help);
}

/// For as long as it lives: 0 is one thread per core.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t jobs)
      : limit_(tbb::global_control::max_allowed_parallelism,
               jobs > 0 ? jobs : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)) {}

 private:
  tbb::global_control limit_;
};

constexpr const char* kSamplesHelp = "area-uniform samples each way, all vertices on top";
constexpr const char* kJobsHelp = "threads; 0 is one per core";

}  // namespace meshlode::bench
