// SPDX-License-Identifier: GPL-3.0-or-later
// What the verbs share: option parsing (CLI11 behind it), the options that several verbs have, and errors on stderr.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "option_table.h"
#include "verb.h"

namespace meshlode::cli {

/// Options and positional arguments of one verb. `--help` and `--color` are always there. Targets keep their value
/// where the option is not given, and must outlive parse().
class OptionParser {
 public:
  explicit OptionParser(const Verb& verb);
  ~OptionParser();
  OptionParser(const OptionParser&) = delete;
  OptionParser& operator=(const OptionParser&) = delete;

  /// The heading that `--help` lists the options added from here on under.
  void group(const char* heading);

  /// Names are CLI11's and, after a space, what the help calls the value: "--size WxH", or "-o,--output FILE" for two
  /// spellings. The help says meaning, unit and range. The default is taken from the target; where that is empty `help`
  /// ends in "(default: ...)" or "(required)".
  void add_flag(const char* name, bool& target, const char* help);
  /// With `choices`, anything else is a usage error; they are what the help calls the value unless the name has one.
  void add_value(const char* name, std::string& target, const char* help, const std::vector<std::string>& choices = {});
  void add_value(const char* name, double& target, const char* help);
  void add_value(const char* name, std::uint32_t& target, const char* help);
  void add_value(const char* name, std::uint64_t& target, const char* help);
  void add_value(const char* name, std::optional<double>& target, const char* help);
  void add_value(const char* name, std::optional<std::uint32_t>& target, const char* help);
  void add_value(const char* name, std::optional<std::uint64_t>& target, const char* help);
  void add_value(const char* name, std::optional<std::string>& target, const char* help,
                 const std::vector<std::string>& choices = {});
  /// May be given several times, a value each time.
  void add_values(const char* name, std::vector<std::string>& target, const char* help);
  void add_positional(const char* name, std::string& target, const char* help);  ///< exactly one
  void add_positional(const char* name, std::optional<std::string>& target, const char* help,
                      const std::vector<std::string>& choices);  ///< one or none
  /// One or more, or where `is_required` is false any number.
  void add_positionals(const char* name, std::vector<std::string>& target, const char* help, bool is_required = true);

  /// Nothing: go on. A value: leave with this exit code (help was printed, a usage error, or the verb was only asked
  /// for its options: Verb::listed_options).
  [[nodiscard]] std::optional<int> parse(std::span<char* const> args);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// `--format text|json` and `-q,--quiet`; with `more_formats` these too.
struct OutputOptions {
  std::string format = "text";
  bool quiet = false;
  [[nodiscard]] bool json() const { return format == "json"; }
};
void add_output_options(OptionParser& parser, OutputOptions& options,
                        const std::vector<std::string>& more_formats = {});

/// `-j,--jobs N`: threads; 0 (the default) is one per core.
void add_jobs_option(OptionParser& parser, std::uint32_t& jobs);

/// `--max-memory SIZE` in bytes; 0 for "auto": what the machine has. Error: kUsage.
[[nodiscard]] Result<std::uint64_t> parse_max_memory(const std::string& text);

/// `--max-decoded SIZE`: what images and geometry may take decoded.
void add_max_decoded_option(OptionParser& parser, std::string& size);
/// Errors: kUsage for what is no size.
[[nodiscard]] Result<std::uint64_t> parse_max_decoded(const std::string& size);
constexpr const char* kDefaultMaxDecodedText = "512MiB";

/// `--scene NAME|INDEX|all`, of verbs that import a scene.
void add_scene_option(OptionParser& parser, std::string& choice);

/// `--device NAME|INDEX`, of verbs that draw with --gpu.
void add_device_option(OptionParser& parser, std::string& device);

/// `--pixel-error T`: what a camera's cut may be off by.
void add_pixel_error_option(OptionParser& parser, double& pixels);

/// `--allow-outside DIR`, of verbs that import a scene.
void add_allow_outside_option(OptionParser& parser, std::vector<std::string>& folders);
/// As scene::ImportOptions takes them. Errors: kIo for what is no folder.
[[nodiscard]] Result<std::vector<std::filesystem::path>> parse_allow_outside(const std::vector<std::string>& folders);
/// "expected WANTED, got 'TEXT'": kUsage.
[[nodiscard]] Error wrong_size(const char* option, const std::string& got, const char* wanted);

/// --samples of verbs that measure deviations. Error: kUsage unless 1 to 100,000,000.
[[nodiscard]] Status check_samples(std::uint64_t samples);

/// Limits oneTBB to `jobs` threads while it lives; 0 leaves it alone.
class JobLimit {
 public:
  explicit JobLimit(std::uint32_t jobs);
  ~JobLimit();
  /// Runs the work on exactly that many threads, more than there are cores too, as tests of determinism want.
  void run(const std::function<void()>& work);
  JobLimit(const JobLimit&) = delete;
  JobLimit& operator=(const JobLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// "1,0.5,2e-3": numbers between commas; nothing where a part is not a finite number.
[[nodiscard]] std::optional<std::vector<double>> parse_numbers(std::string_view text);

/// "unknown WHAT 'word'; the nearest is NAME", for words of the command line; where no name is near, without one.
[[nodiscard]] std::string unknown_word(std::string_view what, std::string_view word,
                                       const std::vector<std::string>& known);

/// Versions of the two libraries that are seen by options.cpp alone.
[[nodiscard]] std::string cli11_version();
[[nodiscard]] std::string onetbb_version();

/// From here on a usage error is one of this verb's: "meshlode build: …".
void name_verb_in_errors(std::string_view verb);
/// From here on errors call what has this path by this name.
void rename_in_errors(const std::string& path, const std::string& name);

/// One line on stderr, "meshlode: where: detail" ("meshlode VERB: …" for kUsage), and the exit code to return.
int print_error(const Error& error);

/// Writes to stdout. Error: kIo, as on a full disk. A pipe that is no longer read is no failure.
[[nodiscard]] Status write_stdout(std::string_view text);
/// The same; false (and an error on stderr) where that fails, such as on a full disk. A pipe that is no
/// longer read is no failure.
[[nodiscard]] bool print_out(const std::string& text);

}  // namespace meshlode::cli
