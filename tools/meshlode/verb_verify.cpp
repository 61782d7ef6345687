// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/doctor/diagnosis.h"
#include "app/report/read_meta.h"
#include "base/file.h"
#include "bulk.h"
#include "explain.h"
#include "file_kind.h"
#include "gpu_checks.h"
#include "judge/validate/rules.h"
#include "judge/verify/verify.h"
#include "options.h"
#include "outputs.h"
#include "promise_option.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "source_scene.h"
#include "terminal.h"
#include "verb.h"
#include "verify_json.h"

namespace meshlode::cli {

namespace {

/// Of one asset that differs from its source in pictures: both are drawn once more with more pixels (V211).
constexpr std::uint64_t kMemoryOfPictures = 140U << 20U;

constexpr ColoredWord kStatusWords[] = {{"ok", Color::kGreen},
                                        {"FAILED", Color::kRed},
                                        {"skipped", Color::kYellow},
                                        {"verified:", Color::kGreen},
                                        {"NOT", Color::kRed}};

/// A second for the dragon, and so many that a rule which is wrong for some does not pass by luck.
constexpr std::uint32_t kResidencies = 5000;
constexpr std::uint32_t kMostFrames = 100'000;          ///< a day of lavapipe
constexpr std::uint32_t kMostResidencies = 10'000'000;  ///< a camera for 50 keeps what it found until the end

std::string describe(const judge::VerifyReport& report, bool quiet) {
  std::string text;
  for (const judge::VerifyReport::Check& check : report.checks) {
    if (quiet && check.failures == 0) continue;
    char head[64];
    std::snprintf(head, sizeof head, "%-4s %-8s %12llu  ", check.invariant.empty() ? "-" : check.invariant.c_str(),
                  check.skipped         ? "skipped"
                  : check.failures == 0 ? "ok"
                                        : "FAILED",
                  static_cast<unsigned long long>(check.items));
    text += head + check.what;
    if (check.failures > 0) text += ": " + app::counted(check.failures, "failures");
    text += "\n";
  }
  for (const judge::Finding& finding : report.findings) {
    text += finding.id + (finding.invariant.empty() ? "" : " (" + finding.invariant + ")") + ": " + finding.where +
            ": " + finding.detail + "\n";
  }
  if (report.finding_count > report.findings.size()) {
    text += "and " + app::counted(report.finding_count - report.findings.size(), "more findings") + "\n";
  }
  if (!quiet)
    text += report.finding_count == 0 ? "verified: nothing found\n"
                                      : "NOT verified: " + app::counted(report.finding_count, "findings") + "\n";
  return text;
}

/// Clusters decoded, and a cut that draws each in every instance: what verify keeps at once.
Status check_size(const run::Asset& asset) {
  if (Status geometry = run::check_decoded_bytes(asset, run::count_decoded_bytes(asset)); !geometry) return geometry;
  std::uint64_t clusters = 0;
  for (const format::InstanceRecord& instance : asset.instances())
    clusters += asset.meshes()[instance.mesh].cluster_count;
  const Status cuts = run::check_decoded_bytes(asset, clusters * sizeof(run::ClusterInstance));
  return cuts ? cuts : Status(Error{cuts.error().code, "cuts of all instances", cuts.error().detail});
}

/// A report that the scene is another one than the asset was built from, and of that alone: there is nothing to
/// compare.
judge::VerifyReport report_other_source(const std::string& detail) {
  judge::VerifyReport report;
  report.checks.push_back({"", "the source is the one the asset was built from", 1, 1});
  report.findings.push_back({std::string(judge::info_of(judge::Rule::kV108).id), "", "section META: /source/hash",
                             detail + "; nothing else was compared: give that scene, or --force"});
  report.finding_count = 1;
  return report;
}

/// All that is asked of each asset.
struct VerifyCommand {
  SourceOptions source;
  GpuOptions gpu;
  judge::VerifyOptions checks;
  OutputOptions output;
  std::uint64_t max_decoded = 0;
  bool is_source_folder = false;
};

/// Of several assets --source is a folder: below it a scene lies as its asset does below the folder that was given, or
/// directly in it, under the name that the asset has of it.
std::string source_below(const std::string& folder, const BulkInput& input, const run::Asset& asset) {
  namespace fs = std::filesystem;
  fs::path inner;
  if (input.is_found) {
    inner =
        (input.base.empty() ? fs::path(input.path) : fs::path(input.path).lexically_relative(input.base)).parent_path();
  }
  return (folder / inner / fs::path(app::read_meta(asset.meta_json()).source_file).filename()).string();
}

/// The row of several assets, and what was found below it.
void describe_row(const judge::VerifyReport& report, FileOutcome& out) {
  const auto failed = std::count_if(report.checks.begin(), report.checks.end(),
                                    [](const judge::VerifyReport::Check& check) { return check.failures > 0; });
  out.cells = {std::to_string(report.checks.size()), std::to_string(failed), std::to_string(report.finding_count)};
  for (const judge::Finding& finding : report.findings) {
    out.details.push_back(finding.id + (finding.invariant.empty() ? "" : " (" + finding.invariant + ")") + ": " +
                          finding.where + ": " + finding.detail);
  }
}

FileOutcome verify_file(const BulkInput& input, const VerifyCommand& command) {
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const std::string& path = input.path;
  SourceOptions source_options = command.source;
  if (!input.source.empty()) source_options.path = input.source;
  judge::VerifyOptions options = command.checks;
  const GpuOptions& gpu_options = command.gpu;
  const bool is_alone = options.residencies > 0 && source_options.path.empty();  // what --stream checks needs no source
  if (is_alone && gpu_options.is_on && !(gpu_options.path.empty() && gpu_options.out_folder.empty())) {
    return fail({ErrorCode::kUsage, "", "--path and --out-dir need --source: they are of what is compared with it"});
  }
  if (!is_alone) {
    const Status given = check_source_options("verify", path, source_options);
    if (!given) return fail(given.error());
  }
  Result<run::Asset> asset = open_asset(path, command.max_decoded);
  if (!asset) return fail(asset.error());
  if (const auto id = asset->file_id()) output_files().keep(*id);
  if (command.is_source_folder && input.source.empty()) {
    source_options.path = source_below(command.source.path, input, *asset);
  }
  if (gpu_options.is_on) {  // asked before anything is measured
    if (const auto promised = with_promise(*asset, gpu_options.promise); !promised) return fail(promised.error());
  }
  if (const Status size = check_size(*asset); !size) {
    return fail({size.error().code, path + ": " + size.error().where, size.error().detail});
  }
  if (gpu_options.is_explained) out.notes = describe_recorded_plan(*asset);
  if (gpu_options.is_on) std::fputs(std::exchange(out.notes, {}).c_str(), stderr);  // before what the device says
  if (options.is_quick || is_alone) {                                               // as it is reported
    options.uniform_cuts = options.cameras = 0;
    options.deviation_budget = std::min(options.deviation_budget, judge::kQuickDeviationBudget);
  }
  judge::VerifyReport report;
  if (is_alone) {
    options.deviation_cuts = 0;
    report = judge::verify_streaming(*asset, options);
  } else {
    const Result<scene::Scene> source = import_source(*asset, source_options, command.max_decoded);
    if (!source) return fail(source.error());
    const Result<MappedFile> file = MappedFile::open(source_options.path);
    if (file) options.source_bytes = file->bytes();
    const std::optional<std::string> other = describe_other_source(*asset, *source, source_options);
    report = other ? report_other_source(*other) : judge::verify_asset(*asset, *source, options);
    if (gpu_options.is_on && !other) {
      const Status judged = verify_with_gpu(*asset, *source, gpu_options, report);
      if (!judged) return fail(judged.error());
    }
  }
  if (gpu_options.is_on && report.streaming) {  // V212 ran: it is the source's, and whole
    const Status judged = verify_streaming_with_gpu(*asset, gpu_options, report);
    if (!judged) return fail(judged.error());
  }
  const OutputOptions& output = command.output;
  out.text = output.json() ? verify_json(path, source_options.path, options, report)
                           : with_colored_words(describe(report, output.quiet), kStatusWords);
  describe_row(report, out);
  out.exit_code = report.finding_count == 0 ? 0 : static_cast<int>(ErrorCode::kCheckFailed);
  return out;
}

int run_verify(const Verb& verb, std::span<char* const> args) {
  VerifyCommand command;
  BulkWords bulk;
  bool streams = false;
  std::uint32_t residencies = kResidencies;
  std::string deviation_cuts = "12";
  std::string max_decoded_text = kDefaultMaxDecodedText;
  SourceOptions& source_options = command.source;
  GpuOptions& gpu_options = command.gpu;
  judge::VerifyOptions& options = command.checks;
  OutputOptions& output = command.output;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE", ".lode assets, folders of them, or patterns such as 'out/**/*.lode'",
                  "verify the assets of this manifest of a build, each with its scene (default: none)");
  parser.group("Source");
  add_source_options(parser, source_options);
  parser.group("Checks");
  parser.add_flag(
      "--quick", options.is_quick,
      "only structure, the border proof and one measured cut per mesh; does not search the source triangles");
  parser.add_value("--cuts", options.uniform_cuts, "uniform cuts per mesh that cross-check the border proof");
  parser.add_value("--cameras", options.cameras, "random cameras that cross-check selection and hierarchy");
  parser.add_value("--deviation-cuts N|all", deviation_cuts,
                   "uniform cuts per mesh that are measured against the source");
  parser.add_value("--deviation-budget", options.deviation_budget,
                   "splits per triangle of such a cut; what is open after that is reported as undecided");
  parser.add_value("--samples", options.deviation_samples,
                   "area-uniform samples per direction of such a cut, for the promises texels and appearance, 1 to "
                   "100000000");
  parser.add_value("--seed", options.seed, "seed of the random cameras and residencies");
  parser.add_flag("--stream", streams,
                  "also select from resident pages alone; without --source nothing else but structure is checked");
  parser.add_value("--residencies", residencies, "random residencies of the pages for --stream, 1 to 10000000");
  parser.group("Output");
  add_output_options(parser, output);
  parser.add_flag("-v,--explain", gpu_options.is_explained,
                  "print what the asset keeps and why; with --gpu also which passes the device runs");
  add_bulk_outputs(parser, bulk);
  parser.group("GPU");
  parser.add_flag("--gpu", gpu_options.is_on, "also decode, select and draw on a Vulkan device, and compare");
  add_device_option(parser, gpu_options.device);
  parser.add_value("--orbits", gpu_options.orbits, "cameras around the scene that are judged against the source");
  parser.add_value("--path FILE", gpu_options.path,
                   "cameras to judge as well, one 'ex ey ez tx ty tz [fovy [near]]' per line (default: none)");
  parser.add_value("--out-dir FOLDER", gpu_options.out_folder,
                   "existing folder for heat maps of the worst cameras and the report gpu.json (default: none)");
  parser.add_value("--frames", gpu_options.frames,
                   "frames of --stream --gpu, which draws from a pool of a quarter of the pages, 1 to 100000");
  add_pixel_error_option(parser, gpu_options.pixel_error);
  add_promise_option(parser, gpu_options.promise);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, max_decoded_text);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (gpu_options.promise != "position" && !gpu_options.is_on) {
    return print_error(
        {ErrorCode::kUsage, "--promise", "chooses what --gpu draws: uniform cuts are measured by all promises"});
  }
  if (residencies < 1 || residencies > kMostResidencies) {
    return print_error({ErrorCode::kUsage, "--residencies", "a number from 1 to 10000000"});
  }
  if (residencies != kResidencies && !streams) {
    return print_error({ErrorCode::kUsage, "--residencies", "is of --stream"});
  }
  if (gpu_options.frames < 1 || gpu_options.frames > kMostFrames) {
    return print_error({ErrorCode::kUsage, "--frames", "a number from 1 to 100000"});
  }
  if (gpu_options.frames != GpuOptions().frames && !(streams && gpu_options.is_on)) {
    return print_error({ErrorCode::kUsage, "--frames", "are of --stream --gpu"});
  }
  if (streams) options.residencies = residencies;
  if (deviation_cuts == "all") {
    options.deviation_cuts = judge::kAllCuts;
  } else if (const auto read = std::from_chars(deviation_cuts.data(), deviation_cuts.data() + deviation_cuts.size(),
                                               options.deviation_cuts);
             read.ec != std::errc() || read.ptr != deviation_cuts.data() + deviation_cuts.size()) {
    return print_error({ErrorCode::kUsage, "--deviation-cuts", "a number of cuts, or all"});
  }
  if (const Status samples = check_samples(options.deviation_samples); !samples) return print_error(samples.error());

  const Result<std::uint64_t> max_decoded = parse_max_decoded(max_decoded_text);
  if (!max_decoded) return print_error(max_decoded.error());
  command.max_decoded = gpu_options.max_decoded = *max_decoded;
  const auto inputs = find_bulk_inputs(verb, bulk, app::InputKind::kAssets, ManifestSide::kAssets);
  if (!inputs) return print_error(inputs.error());
  if (inputs->is_single) {
    const JobLimit limit(bulk.jobs);
    return verify_file(inputs->files.front(), command).print();
  }
  if (gpu_options.is_on) return print_error({ErrorCode::kUsage, "--gpu", "give one asset: it has the device alone"});
  std::error_code error;
  command.is_source_folder = std::filesystem::is_directory(source_options.path, error);
  const bool has_all_sources = std::all_of(inputs->files.begin(), inputs->files.end(), [](const BulkInput& input) {
    return !input.source.empty() || !input.error.empty();
  });
  const bool needs_sources = !streams || !source_options.path.empty();
  if (needs_sources && !has_all_sources && !command.is_source_folder &&
      (source_options.path.empty() || inputs->files.size() > 1)) {
    return print_error({ErrorCode::kUsage, "--source",
                        "of several assets name the folder of their scenes, or give "
                        "--manifest"});
  }
  if (has_all_sources && !source_options.path.empty()) {
    return print_error(
        {ErrorCode::kUsage, "--source", "the manifest names the scene of each asset; give one of the two"});
  }
  BulkVerb bulk_verb{"verify", {{"checks", 6}, {"failed", 6}, {"findings", 8}}, [&](const BulkInput& input) {
                       return verify_file(input, command);
                     }};
  if (needs_sources && !options.is_quick) bulk_verb.memory_besides = kMemoryOfPictures;
  return run_bulk(bulk_verb, inputs->files, bulk, output);
}

}  // namespace

const Verb kVerifyVerb{
    "verify", "compare an asset with the scene it was built from",
    "Checks that every source triangle is there, that no cut has a crack, that selection by "
    "hierarchy and by the flat rule agree, and that cuts deviate from the source by no more than "
    "the asset states. It shares no code with the builder.\n\n"
    "With --stream random pages are resident, and selection must draw a closed cut of these.\n\n"
    "With --gpu a Vulkan device decodes, selects and draws the same, and must agree bit for bit; with --stream too it "
    "draws from a pool of pages that follows its requests.\n\n"
    "Of several assets each has a row; their scenes come from the manifest of their build, or lie "
    "below the folder --source as the assets lie below theirs.",
    "meshlode verify scene.lode --source scene.glb\n"
    "  meshlode verify scene.lode --source scene.glb --quick\n"
    "  meshlode verify scene.lode --source scene.glb --cuts 1000 --cameras 500 --seed 7\n"
    "  meshlode verify scene.lode --source scene.glb --gpu --orbits 50\n"
    "  meshlode verify scene.lode --stream\n"
    "  meshlode verify --manifest out/manifest.json --quick --junit verify.xml",
    run_verify};

}  // namespace meshlode::cli
