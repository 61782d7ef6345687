// SPDX-License-Identifier: GPL-3.0-or-later
// stream: what a camera's path takes and shows where pages come over a link into a pool.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "app/stream/report.h"
#include "app/stream/simulate.h"
#include "base/file.h"
#include "base/printable.h"
#include "base/try.h"
#include "camera_options.h"
#include "file_kind.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "stream_plot.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct StreamWords {
  std::vector<std::string> assets;
  std::optional<std::string> scene, path, builtin;
  std::string size = "1920x1080", pool = "all,1/2,1/4", bandwidth = "10,50,200", latency = "5", layout = "file";
  double pixel_error = 1.0;
  std::optional<double> near_distance;
  std::uint32_t fps = 60, jobs = 0;
  std::string max_decoded = kDefaultMaxDecodedText;
  std::optional<std::string> plot, output_file;
  bool is_checked = false, has_log = false;
  OutputOptions output;
};

constexpr std::size_t kMostRuns = 256;
/// Text of a scene or a path: 100,000 rows are a tenth of it.
constexpr std::size_t kMostTextBytes = std::size_t{64} << 20U;

Result<std::string> read_text_file(const char* option, const std::string& path) {
  TRY_LET(file, MappedFile::open(path));
  output_files().keep(file->id());
  if (file->bytes().size() > kMostTextBytes)
    return Error{ErrorCode::kInvalid, path, "a file of text has at most 64MiB"};
  if (file->bytes().empty())
    return Error{ErrorCode::kInvalid, path, std::string("the file of ") + option + " is empty"};
  return std::string(file->bytes().begin(), file->bytes().end());
}

/// "all", megabytes, or a share of all pages as 1/4.
Result<std::vector<std::optional<std::uint64_t>>> parse_pools(const std::string& text, std::uint64_t all_bytes) {
  std::vector<std::optional<std::uint64_t>> pools;
  std::string_view rest = text;
  for (bool is_more = true; is_more;) {
    const std::size_t comma = rest.find(',');
    const std::string_view word = rest.substr(0, comma);
    is_more = comma != std::string_view::npos;
    if (is_more) rest.remove_prefix(comma + 1);
    if (word == "all") {
      pools.emplace_back();
      continue;
    }
    const std::size_t slash = word.find('/');
    const auto number = parse_numbers(word.substr(0, slash));
    const auto divisor = slash == std::string_view::npos ? parse_numbers("1") : parse_numbers(word.substr(slash + 1));
    const bool is_sound = number && divisor && number->size() == 1 && divisor->size() == 1 && (*number)[0] > 0.0 &&
                          (*divisor)[0] >= 1.0 && (slash == std::string_view::npos || (*number)[0] <= (*divisor)[0]);
    if (!is_sound) {
      return Error{ErrorCode::kUsage, "--pool", "expected all, megabytes, or a share as 1/4" + got_text(word)};
    }
    const double share = (*number)[0] / (*divisor)[0];
    const double bytes = slash == std::string_view::npos ? share * 1e6 : share * static_cast<double>(all_bytes);
    pools.emplace_back(static_cast<std::uint64_t>(std::min(bytes, 1e18)));
  }
  return pools;
}

Result<std::vector<double>> parse_amounts(const char* option, const std::string& text, double least, double most,
                                          const char* wanted) {
  const auto numbers = parse_numbers(text);
  const bool is_sound = numbers && !numbers->empty() && std::all_of(numbers->begin(), numbers->end(), [&](double x) {
                          return x >= least && x <= most;
                        });
  if (!is_sound) return Error{ErrorCode::kUsage, option, std::string("expected ") + wanted + got_text(text)};
  return *numbers;
}

/// All pools over all links, in the order of the words.
Result<std::vector<app::RunSpec>> make_specs(const StreamWords& words, std::uint64_t all_bytes) {
  TRY_LET(pools, parse_pools(words.pool, all_bytes));
  TRY_LET(bandwidths,
          parse_amounts("--bandwidth", words.bandwidth, 1e-3, 1e6, "megabytes per second, 0.001 to 1000000"));
  TRY_LET(latencies, parse_amounts("--latency", words.latency, 0.0, 60000.0, "milliseconds, 0 to 60000"));
  std::vector<app::RunSpec> specs;
  if (pools->size() * bandwidths->size() * latencies->size() > kMostRuns) {
    return Error{ErrorCode::kUsage, "", "--pool, --bandwidth and --latency make more than 256 runs"};
  }
  for (const auto& pool : *pools) {
    for (const double bandwidth : *bandwidths) {
      for (const double latency : *latencies) specs.push_back({pool, {bandwidth, latency}});
    }
  }
  return specs;
}

/// What --layout names beside the file's own pages.
Result<std::vector<app::PageLayout>> read_layouts(const std::string& word) {
  constexpr std::string_view kTry = "try:";
  if (word == "file") return std::vector<app::PageLayout>();
  if (!word.starts_with(kTry)) {
    return Error{ErrorCode::kUsage, "--layout", "expected file, or try: and layouts" + got_text(word)};
  }
  return app::parse_layouts(std::string_view(word).substr(kTry.size()), "--layout");
}

std::vector<app::TriedLayout> try_layouts(const app::StreamScene& scene, std::span<const app::PathFrame> path,
                                          const app::StreamView& view, const app::RunSpec& spec,
                                          std::span<const app::PageLayout> layouts) {
  std::vector<app::TriedLayout> tried;
  for (const app::PageLayout& layout : layouts) {
    const app::StreamScene other = app::with_layout(scene, layout);
    app::Simulation simulation = app::simulate(other, path, view, {&spec, 1});
    tried.push_back({layout, other.pages.size(), std::move(simulation.demand), std::move(simulation.runs.front())});
  }
  return tried;
}

Result<app::StreamView> make_view(const StreamWords& words) {
  app::StreamView view;
  if (!parse_size(words.size, view.width, view.height)) {
    return Error{ErrorCode::kUsage, "--size", "give WIDTHxHEIGHT, each 1 to 16384" + got_text(words.size)};
  }
  if (!(words.pixel_error >= 1e-3 && words.pixel_error <= 1e6)) {
    return Error{ErrorCode::kUsage, "--pixel-error", "give a number of pixels, 0.001 to 1000000"};
  }
  if (words.fps < 1 || words.fps > 1000) return Error{ErrorCode::kUsage, "--fps", "give 1 to 1000"};
  if (words.near_distance && !(*words.near_distance > 0.0 && *words.near_distance <= 1e15)) {
    return Error{ErrorCode::kUsage, "--near", "give a distance above 0"};
  }
  view.pixel_error = words.pixel_error;
  view.near_distance = words.near_distance.value_or(0.0);
  view.fps = words.fps;
  return view;
}

Result<app::StreamScene> read_scene(const StreamWords& words, std::uint64_t max_decoded) {
  std::set<FileId> seen;
  std::vector<run::Asset> assets;
  std::vector<app::Placement> placements;
  for (const std::string& name : words.assets) {
    TRY_LET(asset, open_asset(name, max_decoded));
    if (const auto id = asset->file_id()) {
      output_files().keep(*id);
      if (!seen.insert(*id).second) return Error{ErrorCode::kUsage, name, "is given twice; --scene places it often"};
    }
    placements.push_back({static_cast<std::uint32_t>(assets.size()), {}, 0.0, 1.0});
    assets.push_back(std::move(*asset));
  }
  if (words.scene) {
    TRY_LET(text, read_text_file("--scene", *words.scene));
    TRY_LET(placed, app::parse_placements(*text, *words.scene, words.assets));
    placements = std::move(*placed);
  }
  Result<app::StreamScene> scene = app::make_stream_scene(assets, words.assets, placements);
  if (scene || !scene.error().where.empty()) return scene;
  return Error{scene.error().code, words.scene ? *words.scene : words.assets.front(), scene.error().detail};
}

std::string builtin_of(const StreamWords& words) {
  return words.builtin.value_or("fly");
}

Result<std::vector<app::PathFrame>> read_path(const StreamWords& words, const app::StreamScene& scene) {
  if (!words.path) {
    const auto builtin = value_in(app::kBuiltinPathNames, builtin_of(words)).value_or(app::BuiltinPath::kFly);
    return app::sample_path(app::builtin_path(builtin, scene), words.fps, "--builtin");
  }
  TRY_LET(text, read_text_file("--path", *words.path));
  TRY_LET(rows, app::parse_path(*text, *words.path));
  return app::sample_path(*rows, words.fps, *words.path);
}

void add_options(OptionParser& parser, StreamWords& words) {
  parser.add_positionals("ASSET", words.assets, "one or more .lode assets");
  parser.group("Scene and camera");
  parser.add_value("--scene FILE", words.scene,
                   "lines 'asset x y z yaw scale' that place the assets; yaw in degrees (default: each once)");
  parser.add_value("--builtin", words.builtin, "path through the scene (default: fly)",
                   all_names(app::kBuiltinPathNames));
  parser.add_value(
      "--path FILE", words.path,
      "path as lines 't,ex,ey,ez,tx,ty,tz[,fovy][,cut]': seconds, eye, target, degrees (default: --builtin)");
  parser.add_value("--size WxH", words.size, "size of the picture in pixels, each 1 to 16384");
  parser.add_value("--pixel-error T", words.pixel_error, "allowed error on the screen in pixels, 0.001 to 1000000");
  parser.add_value("--near D", words.near_distance,
                   "near distance of the camera in world units, above 0 (default: 0.01 radii of the largest object)");
  parser.add_value("--fps N", words.fps, "frames per second, 1 to 1000");
  parser.group("Streaming");
  parser.add_value(
      "--pool LIST", words.pool,
      "room for decoded pages: all, megabytes (10^6 bytes), or a share of all pages as 1/4; comma-separated");
  parser.add_value("--bandwidth LIST", words.bandwidth, "of the link, in megabytes per second; comma-separated");
  parser.add_value("--latency LIST", words.latency, "of a request, in milliseconds; comma-separated");
  parser.add_value(
      "--layout file|try:LIST", words.layout,
      "pages: file, the assets' own; try:, those and what other builds would make of them, comma-separated: "
      "KiB per page, then /level or /covisible, then /BYTES of first pages, as in try:32,32/covisible");
  parser.add_flag("--check", words.is_checked,
                  "hold each frame's cut against its definition; findings are printed, the exit code is 6");
  parser.group("Output");
  add_output_options(parser, words.output);
  parser.add_value("-o,--output FILE", words.output_file, "write the report there (default: stdout)");
  parser.add_value("--plot FILE", words.plot, "an SVG of the largest error in each frame (default: none)");
  parser.add_flag("--log", words.has_log,
                  "with --format json: errors and drawn pages of frames, requests and sizes of pages too");
  parser.group("Resources");
  add_jobs_option(parser, words.jobs);
  add_max_decoded_option(parser, words.max_decoded);
}

Status check_together(const StreamWords& words) {
  if (words.has_log && !words.output.json()) return Error{ErrorCode::kUsage, "--log", "needs --format json"};
  if (words.path && words.builtin) return Error{ErrorCode::kUsage, "--path", "give this or --builtin, not both"};
  return Ok{};
}

/// Whether the outputs may be written: once all that is read is known, before the simulation.
Status claim_outputs(const StreamWords& words) {
  if (words.output_file) {
    if (words.output.json()) {
      TRY(check_text_name("-o", *words.output_file, {".json"}));
    } else {
      TRY(check_text_name("-o", *words.output_file, {".txt"}));
    }
    TRY(output_files().claim(*words.output_file));
  }
  if (words.plot) {
    TRY(check_text_name("--plot", *words.plot, {".svg"}));
    TRY(output_files().claim(*words.plot));
  }
  return Ok{};
}

Result<int> stream(const StreamWords& words) {
  TRY(check_together(words));
  TRY_LET(max_decoded, parse_max_decoded(words.max_decoded));
  TRY_LET(view, make_view(words));
  TRY_LET(layouts, read_layouts(words.layout));
  TRY_LET(scene, read_scene(words, *max_decoded));
  TRY_LET(specs, make_specs(words, scene->page_bytes()));
  TRY_LET(path, read_path(words, *scene));
  TRY(claim_outputs(words));
  JobLimit limit(words.jobs);
  app::Simulation simulation;
  std::vector<app::TriedLayout> tried;
  limit.run([&] {
    simulation = app::simulate(*scene, *path, *view, *specs, {words.is_checked, words.has_log});
    tried = try_layouts(*scene, *path, *view, specs->front(), *layouts);
  });
  const app::StreamReport report{words.assets,  words.path.value_or(builtin_of(words)),
                                 *scene,        *path,
                                 *view,         *specs,
                                 simulation,    words.is_checked,
                                 words.has_log, tried};
  if (words.plot) TRY(write_text(*words.plot, stream_plot(report)));
  const std::string text = words.output.json() ? app::stream_json(report) : app::stream_text(report);
  const bool has_findings = app::count_findings(simulation) > 0;
  if (words.output_file) {
    TRY(write_text(*words.output_file, text));
  } else if (words.output.json() || !words.output.quiet || has_findings) {
    TRY(write_stdout(text));
  }
  return has_findings ? static_cast<int>(ErrorCode::kCheckFailed) : 0;
}

int run_stream_verb(const Verb& verb, std::span<char* const> args) {
  StreamWords words;
  OptionParser parser(verb);
  add_options(parser, words);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const Result<int> exit_code = stream(words);
  return exit_code ? *exit_code : print_error(exit_code.error());
}

}  // namespace

const Verb kStreamVerb{
    "stream", "simulate streaming: pool, link, load, error shown",
    "A camera moves through one or more assets. Pages arrive over a link into a pool, and each frame draws the finest "
    "closed cut of the pages that are there. Printed are the working set, the share of it that is drawn, the load, how "
    "long after a jump the picture is as fine as asked, and the error shown, for each pool and link.\n\n"
    "The rules of selection decide, without a renderer. Hidden surfaces count as seen.",
    "meshlode stream scene.lode\n"
    "  meshlode stream tree.lode rock.lode --scene forest.txt --path walk.csv --pool 64,128\n"
    "  meshlode stream scene.lode --builtin teleport --check --format json",
    run_stream_verb};

}  // namespace meshlode::cli
