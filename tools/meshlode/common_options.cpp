// SPDX-License-Identifier: GPL-3.0-or-later
// What several verbs have: options, their words, errors and stdout.
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "base/byte_size.h"
#include "base/nearest_name.h"
#include "base/printable.h"
#include "options.h"
#include "terminal.h"

namespace meshlode::cli {

namespace {

std::string running_verb;              ///< for errors; written once, before any thread is started
std::string renamed_path, shown_name;  ///< the same

}  // namespace

void add_max_decoded_option(OptionParser& parser, std::string& size) {
  parser.add_value("--max-decoded SIZE", size,
                   "largest size of decoded images, and of decoded geometry beyond 64 times the file; bytes, or with "
                   "KiB, MiB, GiB, KB, MB, GB");
}

void add_scene_option(OptionParser& parser, std::string& choice) {
  parser.add_value("--scene NAME|INDEX|all", choice, "which scene of a glTF to use (default: the file's)");
}

void add_device_option(OptionParser& parser, std::string& device) {
  parser.add_value("--device NAME|INDEX", device,
                   "the Vulkan device, by index or part of its name (default: the first that can)");
}

void add_pixel_error_option(OptionParser& parser, double& pixels) {
  parser.add_value("--pixel-error T", pixels, "allowed error on the screen in pixels, 0 or more");
}

void add_allow_outside_option(OptionParser& parser, std::vector<std::string>& folders) {
  parser.add_values("--allow-outside FOLDER", folders,
                    "also read files below FOLDER that the scene refers to; may be repeated (default: only the scene's "
                    "own folder)");
}

Result<std::vector<std::filesystem::path>> parse_allow_outside(const std::vector<std::string>& folders) {
  std::vector<std::filesystem::path> out;
  for (const std::string& folder : folders) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) {
      return Error{ErrorCode::kIo, "--allow-outside", "'" + printable(folder) + "' is not a folder"};
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

Result<std::uint64_t> parse_max_memory(const std::string& text) {
  if (text == "auto") return std::uint64_t{0};
  const auto bytes = parse_byte_size(text);
  if (bytes && *bytes > 0) return *bytes;
  return wrong_size("--max-memory", text, "auto or a size above 0, such as 8GiB or 8GB");
}

void add_output_options(OptionParser& parser, OutputOptions& options, const std::vector<std::string>& more_formats) {
  std::vector<std::string> formats{"text", "json"};
  formats.insert(formats.end(), more_formats.begin(), more_formats.end());
  parser.add_value("--format", options.format, "format of what is printed on stdout", formats);
  parser.add_flag("-q,--quiet", options.quiet, "print errors only");
}

void add_jobs_option(OptionParser& parser, std::uint32_t& jobs) {
  parser.add_value("-j,--jobs", jobs, "threads, 0 for one per core; never changes the output");
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

void name_verb_in_errors(std::string_view verb) {
  running_verb = std::string(verb);
}

void rename_in_errors(const std::string& path, const std::string& name) {
  renamed_path = path;
  shown_name = name;
}

int print_error(const Error& error) {
  const bool is_usage = error.code == ErrorCode::kUsage && !running_verb.empty();
  const std::string program = (is_usage ? "meshlode " + running_verb : "meshlode") + ":";
  std::string line = error.message();
  for (std::size_t at = 0; !renamed_path.empty() && (at = line.find(renamed_path, at)) != std::string::npos;) {
    line.replace(at, renamed_path.size(), shown_name);
    at += shown_name.size();
  }
  // One line whatever the detail holds: file names and JSON texts may have line breaks and control characters.
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  line = colored(Stream::kErr, Color::kRed, program) + " " + line + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
  return static_cast<int>(error.code);
}

Status write_stdout(std::string_view text) {
  const bool ok = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  // A reader that has enough, such as head, is no failure: what the command found still decides the exit code.
  if (ok || errno == EPIPE) return Ok{};
  return Error{ErrorCode::kIo, "stdout", std::string("cannot write: ") + std::strerror(errno)};
}

bool print_out(const std::string& text) {
  const Status written = write_stdout(text);
  if (!written) print_error(written.error());
  return static_cast<bool>(written);
}

}  // namespace meshlode::cli
