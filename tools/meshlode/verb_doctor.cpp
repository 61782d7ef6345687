// SPDX-License-Identifier: GPL-3.0-or-later
// doctor: what in a source costs accuracy, bytes or time, worst first; of an asset, what its tables say of that.
#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <meshlode/format.h>

#include "app/compare/stored_bytes.h"
#include "app/doctor/asset_faults.h"
#include "app/doctor/diagnosis.h"
#include "base/file.h"
#include "base/try.h"
#include "bulk.h"
#include "doctor_advice.h"
#include "doctor_words.h"
#include "options.h"
#include "outputs.h"
#include "run/read/asset.h"
#include "scene/import/import.h"
#include "streams.h"
#include "terminal.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

/// By its first four bytes, whatever it is called.
Result<bool> is_asset(const std::string& path) {
  TRY_LET(file, MappedFile::open(path));
  const std::span<const std::uint8_t> bytes = file->bytes();
  std::uint32_t magic = 0;
  if (bytes.size() < sizeof(magic)) return false;
  std::memcpy(&magic, bytes.data(), sizeof(magic));
  return magic == format::kMagic;
}

/// `sound`: whether pages and images, which the tables do not speak of, are what was written.
Result<app::DoctorReport> examine_asset(const std::string& path, std::uint64_t max_decoded, Status& sound) {
  TRY_LET(asset, run::Asset::open(path, max_decoded));
  sound = app::check_stored_bytes(*asset);
  app::DoctorReport report;
  report.is_asset = true;
  report.meshes = asset->meshes().size();
  for (const format::MeshRecord& mesh : asset->meshes()) report.triangles += mesh.source_triangles;
  report.diagnoses = app::diagnose_asset(*asset);
  add_advice(*asset, report.diagnoses);
  app::rank(report.diagnoses);
  return report;
}

Result<app::DoctorReport> examine(const std::string& path, const scene::ImportOptions& options, Status& sound) {
  TRY_LET(asset, is_asset(path));
  if (*asset) return examine_asset(path, options.max_decoded, sound);
  std::vector<FileId> files_read;
  scene::ImportOptions noted = options;
  noted.files_read = &files_read;
  const Result<scene::Scene> scene = scene::import_scene(path, noted);
  output_files().keep(files_read);
  if (!scene) return scene.error();
  app::DoctorReport report = report_on_scene(*scene);
  add_advice(*scene, report.diagnoses);
  app::rank(report.diagnoses);
  return report;
}

std::vector<std::string> all_fault_ids() {
  std::vector<std::string> ids = source_fault_ids();
  for (std::string& id : app::asset_fault_ids()) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(std::move(id));
  }
  for (std::string& id : advice_ids()) ids.push_back(std::move(id));
  return ids;
}

constexpr ColoredWord kSeverities[] = {{"[high,", Color::kRed}, {"[medium,", Color::kYellow}, {"[low,", Color::kDim}};

struct DoctorCommand {
  std::optional<std::string> fail_on;
  scene::ImportOptions import;
  OutputOptions output;
};

/// The row of several files: how many faults of each severity, and their ids below it.
void describe_row(const app::DoctorReport& report, FileOutcome& out) {
  for (const char* severity : {"high", "medium", "low"}) {
    std::size_t count = 0;
    std::string ids;
    for (const app::Diagnosis& diagnosis : report.diagnoses) {
      if (std::strcmp(app::severity_of(diagnosis.share), severity) != 0) continue;
      ids += (count++ == 0 ? " " : ", ") + diagnosis.id;
    }
    out.cells.push_back(std::to_string(count));
    if (count > 0) out.details.push_back(severity + (":" + ids));
  }
}

FileOutcome examine_file(const BulkInput& input, const DoctorCommand& command) {
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const Result<std::string> place = input_path(input.path);
  if (!place) return fail(place.error());
  const std::string path = input_name(input.path);
  Status sound = Ok{};
  Result<app::DoctorReport> report = examine(*place, command.import, sound);
  if (!report) return fail(report.error());
  report->file = path;
  if (command.fail_on) report->failed_on = *app::find_failures(*command.fail_on, all_fault_ids(), report->diagnoses);
  const OutputOptions& output = command.output;
  const bool is_silent = output.quiet && !output.json() && report->diagnoses.empty();
  if (!is_silent) {
    out.text = output.json() ? app::doctor_json(*report) : with_colored_words(app::doctor_text(*report), kSeverities);
  }
  describe_row(*report, out);
  if (!sound) out.late_errors.push_back({sound.error().code, path + ": " + sound.error().where, sound.error().detail});
  out.exit_code = !sound                      ? static_cast<int>(sound.error().code)
                  : report->failed_on.empty() ? 0
                                              : static_cast<int>(ErrorCode::kCheckFailed);
  return out;
}

int run_doctor(const Verb& verb, std::span<char* const> args) {
  std::string max_decoded = kDefaultMaxDecodedText;
  std::vector<std::string> allow_outside;
  DoctorCommand command;
  std::optional<std::string>& fail_on = command.fail_on;
  scene::ImportOptions& options = command.import;
  BulkWords bulk;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE",
                  ".gltf, .glb, .ply, .obj or .stl scenes, .lode assets, folders or patterns; - for stdin",
                  "examine the assets of this manifest of a build (default: none)");
  parser.group("Output");
  add_output_options(parser, command.output);
  add_bulk_outputs(parser, bulk);
  parser.add_value("--fail-on FAULTS", fail_on,
                   "exit with 6 if one of these is found: fault ids, high, medium (and worse) or any, comma-separated "
                   "(default: none)");
  parser.group("Input");
  add_scene_option(parser, options.scene);
  parser.add_flag("--linear-colors", options.linear_colors, "read colours as 'build --linear-colors' does");
  add_allow_outside_option(parser, allow_outside);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const Result<std::uint64_t> decoded = parse_max_decoded(max_decoded);
  if (!decoded) return print_error(decoded.error());
  options.max_decoded = *decoded;
  options.may_lack_images = true;
  auto allowed = parse_allow_outside(allow_outside);
  if (!allowed) return print_error(allowed.error());
  options.allow_outside = std::move(*allowed);
  // Before any work: a misspelt id.
  if (fail_on) {
    if (auto known = app::find_failures(*fail_on, all_fault_ids(), {}); !known) return print_error(known.error());
  }
  const auto inputs = find_bulk_inputs(verb, bulk, app::InputKind::kScenesAndAssets, ManifestSide::kAssets);
  if (!inputs) return print_error(inputs.error());
  if (inputs->is_single) {
    const JobLimit limit(bulk.jobs);
    return examine_file(inputs->files.front(), command).print();
  }
  return run_bulk({"doctor",
                   {{"high", 4}, {"medium", 6}, {"low", 4}},
                   [&](const BulkInput& input) { return examine_file(input, command); }},
                  inputs->files, bulk, command.output);
}

}  // namespace

const Verb kDoctorVerb{
    "doctor", "find what in a scene costs accuracy, bytes or time, worst first, with the remedy",
    "Looks for faults of a scene, such as seams that are not welded, degenerate triangles or positions far from the "
    "origin, and says what each costs and how to fix it. Nothing is built or changed.\n\n"
    "For an asset it reports what its tables show, such as groups that could not be simplified. Of several files each "
    "has a row with its faults by severity.",
    "meshlode doctor scene.glb\n"
    "  meshlode doctor scene.glb --fail-on unwelded-seams,not-finite\n"
    "  meshlode doctor scenes/ --fail-on high --junit doctor.xml\n"
    "  meshlode doctor scene.lode --format json",
    run_doctor};

}  // namespace meshlode::cli
