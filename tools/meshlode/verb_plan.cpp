// SPDX-License-Identifier: GPL-3.0-or-later
// plan: what a build of a scene will keep, and why, without building it.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/preview/plan_report.h"
#include "app/preview/scene_plan.h"
#include "app/settings/settings.h"
#include "app/textures/convert_images.h"
#include "base/json_writer.h"
#include "base/printable.h"
#include "build_options.h"
#include "bulk.h"
#include "explain.h"
#include "material_looks.h"
#include "measure_plan.h"
#include "options.h"
#include "outputs.h"
#include "scene/import/import.h"
#include "scene_passes.h"
#include "streams.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

/// All that is printed.
struct Planned {
  app::Settled settings;
  std::vector<app::SettledMesh> meshes;  ///< empty: none has settings of its own
  app::ScenePlan scene;
  draw::PassPlan passes;
  std::optional<PlanMeasurement> measured;
};

void write_settings(JsonWriter& json, const Planned& planned) {
  const auto write = [&](app::Setting setting, const app::SettledWord& word) {
    json.field("name", app::info_of(setting).name);
    json.field("word", word.word);
    json.field("from", word.from);
    json.end_object();
  };
  json.key("settings");
  json.begin_array();
  for (const app::SettingInfo& info : app::all_settings()) {
    json.begin_object();
    write(info.setting, planned.settings[info.setting]);
  }
  json.end_array();
  json.key("mesh_settings");
  json.begin_array();
  for (std::size_t i = 0; i < planned.meshes.size(); ++i) {
    for (const auto& [setting, word] : planned.meshes[i].own) {
      json.begin_object();
      json.field("mesh", i);
      write(setting, word);
    }
  }
  json.end_array();
}

std::string plan_text(const scene::Scene& scene, const Planned& planned) {
  const app::ScenePlan& plan = planned.scene;
  std::uint64_t triangles = 0;
  for (const app::PlannedMesh& mesh : plan.meshes) triangles += mesh.triangles;
  std::string text = "scene: " + std::to_string(triangles) + " triangles in " + std::to_string(plan.meshes.size()) +
                     " mesh(es), " + std::to_string(scene.instances.size()) + " instance(s), " +
                     std::to_string(scene.materials.size()) + " material(s)\n";
  text += describe_settings(planned.settings, planned.meshes, scene) + app::describe_plan(plan);
  text += "passes of render --gpu and verify --gpu\n" + draw::describe_plan(planned.passes, "  ");
  return planned.measured ? text + describe_measurement(*planned.measured) : text;
}

std::string plan_json(const scene::Scene& scene, const Planned& planned) {
  JsonWriter json;
  json.begin_object();
  json.field("source", scene.source_name);
  json.field("instances", scene.instances.size());
  json.field("materials", scene.materials.size());
  write_settings(json, planned);
  app::write_plan(json, planned.scene);
  json.key("passes");
  json.begin_array();
  for (const draw::PassDecision& pass : planned.passes.decisions) {
    json.begin_object();
    json.field("pass", pass.pass);
    json.field("runs", pass.runs);
    json.field("reason", pass.reason);
    json.end_object();
  }
  json.end_array();
  json.key("measured");
  if (planned.measured) {
    write_measurement(json, *planned.measured);
  } else {
    json.null();
  }
  json.end_object();
  return json.text();
}

struct PlanCommand {
  std::string report = kStream;
  BuildWords words;
  MeasureOptions measure;
  std::uint64_t max_decoded = 0;
  std::vector<std::filesystem::path> allow_outside;
  OutputOptions output;
  bool is_measured = false, is_single = true;
};

Status claim_plan(const PlanCommand& command) {
  return command.output.json() ? claim_report(command.report, {".json"}) : claim_report(command.report, {});
}

/// The row of several scenes.
std::vector<std::string> row_of(const scene::Scene& scene, const app::ScenePlan& plan) {
  std::uint64_t triangles = 0;
  double bytes = 0.0;
  for (const app::PlannedMesh& mesh : plan.meshes) {
    triangles += mesh.triangles;
    bytes += mesh.bytes;
  }
  return {grouped_digits(triangles), grouped_digits(plan.meshes.size()), grouped_digits(scene.instances.size()),
          grouped_digits(static_cast<std::uint64_t>(std::clamp(bytes, 0.0, 0x1p63)))};
}

FileOutcome plan_file(const BulkInput& input, const PlanCommand& command, JobLimit* limit) {
  FileOutcome out;
  const std::string& path = input.path;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const auto fail_in = [&](Error error) {
    error.where = path + (error.where.empty() ? "" : ": ") + error.where;
    return fail(std::move(error));
  };
  const auto layers = settings_for(command.words, path, input.base);
  if (!layers) return fail(layers.error());
  Result<app::Settled> settled = app::settle(*layers);
  if (!settled) return fail(settled.error());
  builder::PipelineOptions options = settled->options;
  options.looks = &image_looks();
  const app::ImageConverter converter(command.max_decoded);
  options.images = &converter;

  std::vector<FileId> files_read;
  const Result<scene::Scene> scene = scene::import_scene(path, {.repair = options.repair,
                                                                .scene = command.words.scene,
                                                                .files_read = &files_read,
                                                                .max_decoded = command.max_decoded,
                                                                .may_lack_images = true,
                                                                .allow_outside = command.allow_outside,
                                                                .linear_colors = options.linear_colors});
  if (!scene) return fail(scene.error());
  output_files().keep(files_read);
  const Status free = command.is_single ? claim_plan(command) : Status(Ok{});
  if (!free) return fail(free.error());
  auto meshes = app::settle_meshes(*layers, app::names_of_meshes(*scene));
  if (!meshes) return fail_in(meshes.error());
  for (const app::SettledMesh& mesh : *meshes) options.mesh_options.push_back(mesh.options);
  Result<app::ScenePlan> plan = app::plan_scene(*scene, options);
  if (!plan) return fail_in(plan.error());
  Planned planned{std::move(*settled), std::move(*meshes), std::move(*plan), {}, {}};
  planned.passes = plan_scene_passes(*scene, planned.scene, options.max_cluster_triangles);
  if (command.is_measured) {
    std::optional<Result<PlanMeasurement>> measured;
    limit->run([&] { measured = measure_plan(*scene, options, command.measure); });
    if (!*measured) return fail_in(measured->error());
    planned.measured = std::move(**measured);
  }
  out.text = command.output.json() ? plan_json(*scene, planned) : plan_text(*scene, planned);
  out.cells = row_of(*scene, planned.scene);
  return out;
}

int run_plan(const Verb& verb, std::span<char* const> args) {
  std::string max_decoded = kDefaultMaxDecodedText;
  std::vector<std::string> allow_outside;
  PlanCommand command;
  BulkWords bulk;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "INPUT", ".gltf, .glb, .ply, .obj or .stl scenes, folders of them, or patterns",
                  "plan the scenes of this manifest of a build (default: none)");
  parser.group("Output");
  add_report_option(parser, command.report);
  add_output_options(parser, command.output);
  parser.add_flag("--measure", command.is_measured,
                  "build with this plan and with --keep all, three times each, and compare both");
  parser.add_value("--device NAME|INDEX", command.measure.device,
                   "Vulkan device of --measure, by index or part of its name (default: the first that can)");
  add_bulk_outputs(parser, bulk);
  add_build_options(parser, command.words);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, max_decoded);
  add_allow_outside_option(parser, allow_outside);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const Result<std::uint64_t> decoded = parse_max_decoded(max_decoded);
  if (!decoded) return print_error(decoded.error());
  command.max_decoded = command.measure.max_decoded = *decoded;
  auto allowed = parse_allow_outside(allow_outside);
  if (!allowed) return print_error(allowed.error());
  command.allow_outside = std::move(*allowed);
  const auto inputs = find_bulk_inputs(verb, bulk, app::InputKind::kScenes, ManifestSide::kScenes);
  if (!inputs) return print_error(inputs.error());
  if (inputs->is_single) {
    JobLimit limit(bulk.jobs);
    return plan_file(inputs->files.front(), command, &limit).print(command.report);
  }
  if (command.is_measured) return print_error({ErrorCode::kUsage, "--measure", "give one scene: it has all threads"});
  if (const Status free = claim_plan(command); !free) return print_error(free.error());
  command.is_single = false;
  return run_bulk({"plan",
                   {{"triangles", 11}, {"meshes", 6}, {"instances", 9}, {"est. bytes", 13}},
                   [&](const BulkInput& input) { return plan_file(input, command, nullptr); }},
                  inputs->files, bulk, command.output, command.report);
}

}  // namespace

const Verb kPlanVerb{
    "plan", "show what a build keeps of a scene and why, without building it",
    "Prints the settings and where each comes from, which attributes of each mesh are stored or left out and why, the "
    "features of the scene that the asset carries, and the passes that a GPU will run. Bytes are estimates.\n\n"
    "With --measure the scene is built twice, by the plan and with every attribute, and both are compared in bytes and "
    "time. Of several scenes each has a row.",
    "meshlode plan scene.glb\n"
    "  meshlode plan scenes/ --max-memory 4GiB\n"
    "  meshlode plan scene.glb --measure --format json",
    run_plan};

}  // namespace meshlode::cli
