// SPDX-License-Identifier: GPL-3.0-or-later
// sweep: what each notch of accuracy costs in time and bytes, for one scene, measured.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "app/batch/cache/program_id.h"
#include "app/batch/tell/time_left.h"
#include "base/append_format.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/nearest_name.h"
#include "base/output_files.h"
#include "base/printable.h"
#include "base/try.h"
#include "camera_options.h"
#include "doctor_words.h"
#include "lab/page/numbers.h"
#include "lab/page/page.h"
#include "lab/page/read_pictures.h"
#include "lab/sweep/page_data.h"
#include "lab/sweep/sweep.h"
#include "options.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

/// "90", "90s", "5m", "1.5h": seconds above 0.
std::optional<double> parse_duration(std::string_view text) {
  double unit = 1.0;
  if (text.ends_with('h')) unit = 3600.0;
  if (text.ends_with('m')) unit = 60.0;
  if (text.ends_with('h') || text.ends_with('m') || text.ends_with('s')) text.remove_suffix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc{} && end == text.data() + text.size();
  if (!is_whole || !(value > 0.0) || !std::isfinite(value * unit)) return std::nullopt;
  return value * unit;
}

/// Wishes with semicolons between them.
Result<std::vector<lab::Wish>> parse_wishes(const std::string& text) {
  std::vector<lab::Wish> wishes;
  for (std::size_t at = 0; at <= text.size() && !text.empty();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    TRY_LET(wish, lab::parse_wish(std::string_view(text).substr(at, end - at)));
    wishes.push_back(std::move(*wish));
    at = end + 1;
  }
  return wishes;
}

/// Names with commas between them. Error: kUsage for one that no knob has.
Result<std::vector<std::string>> parse_knobs(std::string text) {
  std::replace(text.begin(), text.end(), '-', '_');
  const std::vector<std::string> known = lab::all_knob_names();
  std::vector<std::string> names;
  for (std::size_t at = 0; at <= text.size(); at = std::min(text.find(',', at), text.size()) + 1) {
    const std::string name = text.substr(at, text.find(',', at) - at);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return Error{ErrorCode::kUsage, "--knobs",
                   "'" + name.substr(0, 64) + "' is not a knob" + nearest_or_all(name, known)};
    }
    names.push_back(name);
  }
  return names;
}

struct SweepWords {
  std::string scene, report, max_decoded = kDefaultMaxDecodedText;
  std::optional<std::string> budget, want, knobs;
  std::vector<std::string> allow_outside;
  std::optional<std::uint64_t> samples;
  OutputOptions out;
};

/// A bar on a terminal, a line a build elsewhere.
class SweepShow {
 public:
  explicit SweepShow(bool quiet) : is_quiet_(quiet), has_bar_(!quiet && ::isatty(STDERR_FILENO) == 1) {}
  ~SweepShow() { wipe(); }
  SweepShow(const SweepShow&) = delete;
  SweepShow& operator=(const SweepShow&) = delete;

  void show(const lab::SweepProgress& progress) {
    if (is_quiet_) return;
    std::string line;
    append_format(line, "round %u/%u, asset %zu/%zu: %.60s", progress.round, progress.rounds, progress.point + 1,
                  progress.points, progress.label.c_str());
    if (progress.seconds_left > 0.0) line += ", " + app::time_left_text(progress.seconds_left);
    if (!has_bar_) {
      std::fprintf(stderr, "%s\n", line.c_str());
      return;
    }
    constexpr std::size_t kBar = 24;
    const auto filled = static_cast<std::size_t>(progress.fraction * kBar);
    const std::string bar = std::string(filled, '#') + std::string(kBar - filled, '.');
    std::fprintf(stderr, "\r\033[K[%s] %3d%% %s", bar.c_str(), static_cast<int>(100.0 * progress.fraction),
                 line.c_str());
    std::fflush(stderr);
    is_drawn_ = true;
  }

  void wipe() {
    if (is_drawn_) std::fputs("\r\033[K", stderr);
    is_drawn_ = false;
  }

 private:
  bool is_quiet_, has_bar_, is_drawn_ = false;
};

std::string command_of(const SweepWords& words, const lab::SweepOptions& options) {
  std::string text = "meshlode sweep " + lab::shell_word(words.scene) + " -o " + lab::shell_word(words.report);
  if (words.budget) text += " --budget " + lab::shell_word(*words.budget);
  if (words.want) text += " --want " + lab::shell_word(*words.want);
  if (words.knobs) text += " --knobs " + lab::shell_word(*words.knobs);
  if (!options.scene_choice.empty()) text += " --scene " + lab::shell_word(options.scene_choice);
  text += " --rounds " + std::to_string(options.rounds);
  if (words.samples) text += " --samples " + std::to_string(*words.samples);
  if (!options.max_decoded_text.empty()) text += " --max-decoded " + lab::shell_word(options.max_decoded_text);
  for (const auto& folder : options.allow_outside) text += " --allow-outside " + lab::shell_word(folder.string());
  if (options.jobs > 0) text += " --jobs " + std::to_string(options.jobs);
  return text;
}

/// A path that no command takes for an option.
std::string as_operand(const std::string& path) {
  return path.starts_with('-') ? "./" + path : path;
}

Status set_options(const SweepWords& words, lab::SweepOptions& options) {
  if (words.report.empty()) return Error{ErrorCode::kUsage, "--output", "name the folder of the report"};
  if (options.rounds < 1 || options.rounds > 1000) return Error{ErrorCode::kUsage, "--rounds", "give 1 to 1000"};
  if (words.samples) {
    if (Status samples = check_samples(*words.samples); !samples) return samples;
    options.samples = *words.samples;
  }
  if (words.budget) {
    const auto seconds = parse_duration(*words.budget);
    if (!seconds)
      return Error{ErrorCode::kUsage, "--budget", "give a time such as 90s, 5m or 1h" + got_text(*words.budget)};
    options.budget = *seconds;
  }
  TRY_LET(wishes, parse_wishes(words.want.value_or("")));
  options.wishes = std::move(*wishes);
  if (words.knobs) {
    TRY_LET(knobs, parse_knobs(*words.knobs));
    options.knobs = std::move(*knobs);
  }
  TRY_LET(decoded, parse_max_decoded(words.max_decoded));
  options.max_decoded = *decoded;
  if (words.max_decoded != kDefaultMaxDecodedText) options.max_decoded_text = words.max_decoded;
  TRY_LET(allowed, parse_allow_outside(words.allow_outside));
  options.allow_outside = std::move(*allowed);
  options.scene = words.scene;
  options.report = words.report;
  options.command = command_of(words, options);
  options.frame_scene = [](const run::Asset& asset, std::uint32_t width, std::uint32_t height) {
    return frame_scene(asset, width, height);
  };
  options.diagnose_scene = diagnose_scene;
  // Before any thread is started: libraries that are loaded later are not this program's.
  TRY_LET(program, app::find_program_id());
  options.program_id = to_hex(*program);
  TRY_LET(launcher, app::find_launcher());
  options.program = std::move(*launcher);
  return Ok{};
}

/// The answers, a line each.
std::string summary_text(const lab::SweepOptions& options, const lab::SweepResult& result) {
  std::string text;
  std::size_t done = 0, failed = 0;
  for (const lab::PointResult& one : result.points) {
    done += one.is_done && one.error.empty() ? 1U : 0U;
    failed += one.error.empty() ? 0U : 1U;
  }
  append_format(text, "%zu %s measured, %zu failed, %zu left out, %.0f s: ", done, done == 1 ? "point" : "points",
                failed, result.points.size() - done - failed, result.spent);
  text += printable(options.report.string(), std::string::npos) + "/index.html\n";
  for (const lab::IdleKnob& knob : result.idle_knobs) {
    append_format(text, "%s has nothing to turn: %s\n", knob.name.c_str(), knob.why);
  }
  for (const lab::Recommendation& one : result.recommendations) {
    text += one.wish.text + ": ";
    if (!one.answer.point) {
      text += one.answer.why + "\n";
      continue;
    }
    const lab::PointResult& point = result.points[*one.answer.point];
    text += std::string(one.wish.goal->key) + " " +
            lab::page::amount_text(point.figures.at(one.wish.goal->key).value, one.wish.goal->unit) + ", ";
    text +=
        one.answer.why + "\n  " + printable(lab::build_command(options, result, point.point), std::string::npos) + "\n";
  }
  return text;
}

Status keep_result(const lab::SweepOptions& options, const lab::SweepResult& result) {
  const auto write = [&](const char* name, const std::string& text) {
    return write_file_atomically(options.report / name,
                                 {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  if (Status written = write("sweep.csv", lab::sweep_csv(result)); !written) return written;
  if (Status written = write("sweep.json", lab::sweep_json(options, result)); !written) return written;
  lab::page::ReportData data = lab::page_data(options, result);
  if (Status read = lab::page::read_pictures(data, options.report); !read) return read;
  OutputFiles files;
  return lab::page::write_report(data, options.report, files);
}

int run_sweep(const Verb& verb, std::span<char* const> args) {
  SweepWords words;
  lab::SweepOptions options;
  OptionParser parser(verb);
  parser.add_positional("SCENE", words.scene, "a .gltf, .glb, .ply, .obj or .stl scene");
  parser.group("Output");
  parser.add_value("-o,--output FOLDER", words.report,
                   "folder of the report (required); a sweep that was interrupted continues there");
  add_output_options(parser, words.out);
  parser.group("What is measured");
  parser.add_value("--budget TIME", words.budget,
                   "wall time to stay within, such as 90s, 5m or 1h (default: all points)");
  parser.add_value("--want WISHES", words.want,
                   "bounds and a goal, such as 'deviation<=1e-4, bytes min'; several are separated by semicolons "
                   "(default: none)");
  parser.add_value("--knobs NAMES", words.knobs,
                   "settings to vary, comma-separated, as docs/guides/sweep.md lists them (default: all)");
  parser.add_value("--rounds", options.rounds, "how often each asset is built");
  parser.add_value("--samples", words.samples,
                   "area-uniform samples per direction of a deviation (default: 100000, fewer for a short --budget)");
  parser.group("Input");
  add_scene_option(parser, options.scene_choice);
  add_allow_outside_option(parser, words.allow_outside);
  parser.group("Resources");
  add_jobs_option(parser, options.jobs);
  add_max_decoded_option(parser, words.max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  words.scene = as_operand(words.scene);
  words.report = as_operand(words.report);
  if (const Status set = set_options(words, options); !set) return print_error(set.error());

  SweepShow show(words.out.quiet);
  std::string text;
  Status swept = Ok{};
  JobLimit limit(options.jobs);
  limit.run([&] {
    swept = lab::run_sweep(
        options, [&](const lab::SweepProgress& progress) { show.show(progress); },
        [&](const lab::SweepResult& result) {
          text = words.out.json() ? lab::sweep_json(options, result) : summary_text(options, result);
          return keep_result(options, result);
        });
  });
  show.wipe();
  if (!swept) return print_error(swept.error());
  const bool is_silent = words.out.quiet && !words.out.json();
  if (!is_silent && !print_out(text)) return static_cast<int>(ErrorCode::kIo);
  return 0;
}

}  // namespace

const Verb kSweepVerb{"sweep", "measure what accuracy costs in time and bytes, for one scene",
                      "Builds a scene with many combinations of settings and measures time, bytes and deviation of "
                      "each. The report is a folder with a page for a browser, a CSV and a JSON file. A sweep that was "
                      "interrupted continues where it stopped.\n\n"
                      "With --want it names the settings that meet your limits best.",
                      "meshlode sweep scene.glb -o report/ --budget 5m\n"
                      "  meshlode sweep scene.glb -o report/ --want 'deviation<=1e-4, bytes min'",
                      run_sweep};

}  // namespace meshlode::cli
