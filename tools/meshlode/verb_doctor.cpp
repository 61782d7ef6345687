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
#include "doctor_advice.h"
#include "doctor_words.h"
#include "options.h"
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
  TRY_LET(scene, scene::import_scene(path, options));
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

int run_doctor(const Verb& verb, std::span<char* const> args) {
  std::string path, max_decoded = kDefaultMaxDecodedText;
  std::vector<std::string> allow_outside;
  std::optional<std::string> fail_on;
  scene::ImportOptions options;
  OutputOptions output;
  OptionParser parser(verb);
  parser.add_positional("FILE", path, "a .gltf, .glb, .ply, .obj or .stl scene, or a .lode asset; - for stdin");
  parser.group("Output");
  add_output_options(parser, output);
  parser.add_value("--fail-on FAULTS", fail_on,
                   "exit with 6 if one of these is found: fault ids, high, medium (and worse) or any, comma-separated "
                   "(default: none)");
  parser.group("Input");
  add_scene_option(parser, options.scene);
  parser.add_flag("--linear-colors", options.linear_colors, "read colours as 'build --linear-colors' does");
  add_allow_outside_option(parser, allow_outside);
  parser.group("Resources");
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
  Status sound = Ok{};
  const Result<std::string> place = input_path(path);
  if (!place) return print_error(place.error());
  path = input_name(path);
  Result<app::DoctorReport> report = examine(*place, options, sound);
  if (!report) return print_error(report.error());
  report->file = path;
  if (fail_on) report->failed_on = *app::find_failures(*fail_on, all_fault_ids(), report->diagnoses);
  const std::string text =
      output.json() ? app::doctor_json(*report) : with_colored_words(app::doctor_text(*report), kSeverities);
  const bool is_silent = output.quiet && !output.json() && report->diagnoses.empty();
  if (!is_silent && !print_out(text)) return static_cast<int>(ErrorCode::kIo);
  if (!sound) return print_error({sound.error().code, path + ": " + sound.error().where, sound.error().detail});
  return report->failed_on.empty() ? 0 : static_cast<int>(ErrorCode::kCheckFailed);
}

}  // namespace

const Verb kDoctorVerb{
    "doctor", "find what in a scene costs accuracy, bytes or time, worst first, with the remedy",
    "Looks for faults of a scene, such as seams that are not welded, degenerate triangles or positions far from the "
    "origin, and says what each costs and how to fix it. Nothing is built or changed.\n\n"
    "For an asset it reports what its tables show, such as groups that could not be simplified.",
    "meshlode doctor scene.glb\n"
    "  meshlode doctor scene.glb --fail-on unwelded-seams,not-finite\n"
    "  meshlode doctor scene.lode --format json",
    run_doctor};

}  // namespace meshlode::cli
