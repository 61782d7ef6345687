// SPDX-License-Identifier: GPL-3.0-or-later
// build: scenes in, assets out. One input with -o, or many inputs and folders with -O; a batch goes on after a failure
// and exits with its worst code. study: the same with what only a study asks for.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "app/batch/batch.h"
#include "app/batch/cache/cache.h"
#include "app/batch/cache/ingredients.h"
#include "app/batch/cache/program_id.h"
#include "app/batch/depend/depfile.h"
#include "app/batch/jobs/jobs.h"
#include "app/batch/jobs/weigh.h"
#include "app/batch/shard/costs.h"
#include "app/batch/shard/partition.h"
#include "app/batch/shard/read_manifest.h"
#include "app/batch/tell/tell.h"
#include "app/settings/settings.h"
#include "app/textures/convert_images.h"
#include "base/printable.h"
#include "base/try.h"
#include "batch_files.h"
#include "batch_options.h"
#include "batch_show.h"
#include "budget_options.h"
#include "build_options.h"
#include "explain.h"
#include "file_kind.h"
#include "library_versions.h"
#include "material_looks.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "study_options.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

namespace fs = std::filesystem;

using app::Job;
using app::JobResult;

/// No output may be any input, nor a file beside the assets one of these or another of its kind: checked before the
/// first job has written anything. With --dry-run nothing is claimed: that may remove what killed writers left.
Status check_outputs(const std::vector<Job>& jobs, const std::vector<std::string>& side_outputs, bool is_dry) {
  std::error_code error;
  for (const Job& job : jobs) {
    keep_file(job.input);
    if (fs::is_directory(job.output, error)) return Error{ErrorCode::kIo, job.output.string(), "is a folder"};
  }
  for (std::size_t i = 0; i < side_outputs.size(); ++i) {
    const std::string& path = side_outputs[i];
    if (fs::is_directory(path, error)) return Error{ErrorCode::kIo, path, "is a folder"};
    if (Status free = is_dry ? Status(Ok{}) : output_files().claim(path); !free) return free;
    for (std::size_t other = 0; other < i; ++other) {
      if (!is_same_place(side_outputs[other], path)) continue;
      return Error{ErrorCode::kUsage, path, "two outputs would both become this file"};
    }
    for (const Job& job : jobs) {
      if (is_dry && is_same_place(job.input, path)) {
        return Error{ErrorCode::kUsage, path, "the output would overwrite a file that was read"};
      }
      if (!is_same_place(job.output, path)) continue;
      return Error{ErrorCode::kUsage, path, "would overwrite the asset " + job.output.string()};
    }
  }
  return Ok{};
}

Status make_folder(const fs::path& folder) {
  std::error_code ec;
  if (!folder.empty()) fs::create_directories(folder, ec);
  if (ec) return Error{ErrorCode::kIo, folder.string(), ec.message()};
  return Ok{};
}

/// What comes of the command line beside the jobs.
struct BuildCommand {
  BatchWords words;
  app::BatchOptions options;
  Hash128 program{};  ///< where a cache or a manifest wants it
  std::optional<app::Cache> cache;
  std::optional<std::string> fail_if;
  std::optional<builder::BuildHooks> hooks;  ///< of a study
  std::optional<app::ImageConverter> converter;
  std::optional<app::ShardPlan> shard;
  bool is_explained = false;
  std::uint32_t jobs = 0;
  OutputOptions out;
};

/// Before anything is built: TBB loads further libraries as it starts, which are not to be told apart by.
Status find_program(BuildCommand& command) {
  if (command.words.cache_folder().empty() && command.words.manifest.empty()) return Ok{};
  TRY_LET(program, app::find_program_id());
  command.program = *program;
  return Ok{};
}

/// Opens the cache where one is wanted. \pre find_program()
Status open_cache(BuildCommand& command) {
  const std::string folder = command.words.cache_folder();
  TRY_LET(limit, command.words.limit());
  if (folder.empty()) return Ok{};
  TRY_LET(store, app::Store::open(folder, {*limit, command.words.dry_run}));
  command.cache.emplace(std::move(*store), command.program);
  command.options.cache = &*command.cache;
  return Ok{};
}

/// Of all jobs those that this command is to do.
Result<std::vector<Job>> take_share(const std::vector<Job>& jobs, BuildCommand& command) {
  const std::string& costs = command.words.shard_costs;
  if (command.words.shard.empty() && !costs.empty()) {
    return Error{ErrorCode::kUsage, "--shard-costs", "give --shard too: it says how shares are balanced"};
  }
  if (command.words.shard.empty()) return jobs;
  TRY_LET(shard, app::parse_shard(command.words.shard));
  if (command.words.fail_fast) {
    return Error{ErrorCode::kUsage, "--shard",
                 "give this or --fail-fast, not both: shards do not know of each other's failures"};
  }
  std::vector<std::uint64_t> weights;
  weights.reserve(jobs.size());
  for (const Job& job : jobs) weights.push_back(app::weigh_scene(job.input));
  if (!costs.empty()) {
    keep_file(costs);
    TRY(check_is_manifest(costs, "meshlode merge"));
    TRY_LET(last, app::read_costs(costs));
    if (!last->empty() && !jobs.empty() && !app::knows_any(*last, jobs)) {
      return Error{ErrorCode::kInvalid, costs, "names none of these inputs; paths are compared as they were given"};
    }
    weights = app::weigh_by_costs(jobs, weights, *last);
  }
  command.shard = app::plan_shard(jobs, weights, *shard);
  std::vector<Job> mine;
  for (const std::uint64_t position : command.shard->positions) mine.push_back(jobs[position]);
  return mine;
}

/// A shard's manifest says that the shard is complete. So one of an earlier run goes before anything is done: should
/// this run be killed, nobody must take it for its.
Status remove_old_manifest(const BuildCommand& command) {
  const fs::path path = command.words.manifest;
  if (!command.shard || path.empty() || command.words.dry_run) return Ok{};
  const auto old = app::read_manifest(path);
  if (!old || !old->shard) return Ok{};  // none, or a file of another kind, which is not ours to remove
  std::error_code error;
  const fs::path target = fs::canonical(path, error);
  if (!error) fs::remove(target, error);
  if (error) return Error{ErrorCode::kIo, path.string(), error.message()};
  return Ok{};
}

/// What --dry-run prints.
std::string plan_text(const std::vector<JobResult>& results) {
  std::string text;
  for (const JobResult& r : results) {
    std::string words = app::name_of(r.status);
    std::replace(words.begin(), words.end(), '_', ' ');
    text += words + ": " + r.job.input.string() + " -> " + r.job.output.string();
    text += r.reason.empty() ? "\n" : ": " + r.reason + "\n";
  }
  return text + app::summary_line(results) + "\n";
}

BatchFileNames names_of_files(const BuildCommand& command) {
  return {command.words.manifest, command.words.junit,
          command.words.depfile,  command.words.report,
          command.program,        app::settings_text(command.options.pipeline, command.options.import),
          command.shard,          command.options.import.allow_outside,
          library_versions()};
}

/// The formats of the files beside the assets, and of the asset that is named.
Status check_formats(const BuildCommand& command, const std::string& output) {
  Status checks[] = {check_output_name("-o", output, ".lode"),
                     check_text_name("--manifest", command.words.manifest, {".json"}),
                     check_text_name("--report", command.words.report, {".json"}),
                     check_text_name("--junit", command.words.junit, {".xml"}),
                     check_text_name("--depfile", command.words.depfile, {})};
  for (Status& status : checks) {
    if (!status) return std::move(status);
  }
  return Ok{};
}

/// Before any work: an asset is no scene, and a depfile cannot hold every name.
Status check_names(const BuildCommand& command, const std::vector<Job>& jobs) {
  for (const Job& job : jobs) {
    if (is_same_place(job.input, job.output) && look_at_file(job.input.string()).form == FileForm::kAsset) {
      return Error{
          ErrorCode::kUnsupported, job.input.string(),
          "this is a .lode asset already; look at it with 'meshlode info', change its codec with 'meshlode repack'"};
    }
    if (command.words.depfile.empty()) continue;
    for (const fs::path& path : {job.input, job.output}) {
      if (Status sound = app::check_depfile_path(path); !sound) return sound;
    }
  }
  return Ok{};
}

/// --explain.
void print_plan(const scene::Scene& scene, std::span<const app::SettingLayer> layers,
                const builder::PipelineOptions& options) {
  const Result<std::string> text = explain_build({layers.begin(), layers.end()}, options, scene);
  if (!text) return;  // the build will refuse it for the same reason
  std::fprintf(stderr, "plan of %s\n%s", printable(scene.source_name, 200).c_str(), text->c_str());
}

/// Runs the jobs and tells of them. \returns the exit code
int run_jobs(const std::vector<Job>& jobs, const BuildCommand& command) {
  const bool is_dry = command.words.dry_run;
  std::optional<BatchFiles> files;
  if (!is_dry) files.emplace(jobs, names_of_files(command)).begin();
  BatchShow show(jobs, command.out.quiet, !command.out.json() && !is_dry);
  JobLimit limit(command.jobs);
  std::vector<JobResult> results;
  app::BatchWatcher watcher = show.watcher();
  std::size_t running = 0;
  if (files) {
    watcher.on_start = [&running, shown = watcher.on_start](std::size_t job) {
      running = job;
      if (shown) shown(job);
    };
    watcher.on_write = [&files, &running](const JobResult& result) { files->expect(running, result); };
    watcher.on_end = [&files, shown = watcher.on_end](std::size_t job, const JobResult& result, const Error* error) {
      files->add(job, result);
      shown(job, result, error);
    };
  }
  if (command.is_explained) watcher.on_scene = print_plan;
  limit.run([&] { results = app::run_batch(jobs, command.options, output_files(), watcher); });
  int worst = app::worst_exit_code(results);
  const std::string report = app::report_json(results, command.jobs, worst);
  if (files) worst = std::max(worst, files->finish(results, report));
  if (command.cache) {
    // An asset is no worse for it: the code stays.
    if (const auto error = command.cache->store().first_error()) print_error(*error);
  }
  const bool is_told = !command.out.quiet && !command.out.json() && !is_dry;
  if (is_told && jobs.size() > 1) std::fputs(app::summary_text(results).c_str(), stderr);
  if (command.out.json() && !print_out(report)) worst = std::max(worst, static_cast<int>(ErrorCode::kIo));
  if (is_dry && !command.out.json() && !print_out(plan_text(results))) {
    worst = std::max(worst, static_cast<int>(ErrorCode::kIo));
  }
  return worst;
}

/// What may be taken and read.
struct LimitWords {
  std::string max_memory = "auto", max_decoded = kDefaultMaxDecodedText;
  std::vector<std::string> allow_outside;
};

/// `converter`: of images, which the options refer to.
Status set_options(const BuildWords& words, const LimitWords& limits, app::BatchOptions& options,
                   std::optional<app::ImageConverter>& converter) {
  const app::SettingLayer given = given_settings(words);
  TRY_LET(settled, app::settle({&given, 1}));
  options.pipeline = settled->options;
  options.pipeline.looks = &image_looks();
  options.settings_of = [words](const Job& job) { return settings_for(words, job.input, job.root); };
  options.import.repair = options.pipeline.repair;
  options.import.linear_colors = options.pipeline.linear_colors;
  options.import.scene = words.scene;
  TRY_LET(memory, parse_max_memory(limits.max_memory));
  options.pipeline.max_memory = *memory;
  TRY_LET(decoded, parse_max_decoded(limits.max_decoded));
  options.import.max_decoded = *decoded;
  converter.emplace(*decoded);
  options.pipeline.images = &*converter;
  TRY_LET(allowed, parse_allow_outside(limits.allow_outside));
  options.import.allow_outside = std::move(*allowed);
  return Ok{};
}

/// --fail-if: each asset is looked at when it is there.
Status set_budget(BuildCommand& command) {
  TRY_LET(conditions, read_budget_option(command.fail_if, app::info_schema()));
  if (conditions->empty()) return Ok{};
  command.options.check_asset = [budget = std::move(*conditions), max_decoded = command.options.import.max_decoded](
                                    const fs::path& asset) { return check_asset_budget(asset, budget, max_decoded); };
  return Ok{};
}

int run_command(const Verb& verb, std::span<char* const> args, bool is_study) {
  std::vector<std::string> inputs;
  std::string output, output_folder;
  BuildWords words;
  LimitWords limits;
  StudyWords study;
  BuildCommand command;
  OptionParser parser(verb);
  parser.add_positionals("INPUT", inputs,
                         ".gltf, .glb, .ply, .obj or .stl files; with -O also folders and patterns such as "
                         "'art/**/*.glb'");
  parser.group("Output");
  parser.add_value("-o,--output FILE", output, "asset to write (default: INPUT with the extension .lode)");
  parser.add_value("-O,--output-folder FOLDER", output_folder,
                   "folder for the assets of many inputs; created if missing (default: beside each input)");
  add_output_options(parser, command.out);
  parser.add_flag("-v,--explain", command.is_explained, "print the settings and what is kept, as 'meshlode plan' does");
  add_build_options(parser, words);
  if (is_study) add_study_options(parser, study);
  parser.group("Output");
  add_batch_options(parser, command.words);
  add_budget_option(parser, command.fail_if, "info --format json",
                    "totals.bytes_per_source_triangle>10, any(meshes).stuck_groups>0");
  parser.group("Resources");
  add_jobs_option(parser, command.jobs);
  parser.add_value("--max-memory SIZE", limits.max_memory,
                   "limit of the process, such as 8GiB: fewer meshes are built at once, and a build that needs more is "
                   "refused; auto: what the machine has left");
  add_max_decoded_option(parser, limits.max_decoded);
  add_allow_outside_option(parser, limits.allow_outside);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (!output.empty() && !output_folder.empty()) {
    return print_error({ErrorCode::kUsage, "", "give -o or -O, not both"});
  }
  if (const Status set = set_options(words, limits, command.options, command.converter); !set)
    return print_error(set.error());
  auto hooks = hooks_of(study);
  if (!hooks) return print_error(hooks.error());
  command.hooks = std::move(*hooks);
  if (command.hooks) command.options.pipeline.hooks = &*command.hooks;
  if (const Status set = set_budget(command); !set) return print_error(set.error());
  const auto plan = app::plan_jobs(inputs, output, output_folder);
  if (!plan) return print_error(plan.error());
  if (const Status names = check_names(command, *plan); !names) return print_error(names.error());
  const auto share = take_share(*plan, command);
  if (!share) return print_error(share.error());
  std::vector<std::string> side_outputs = command.words.outputs();
  const bool is_dry = command.words.dry_run;
  if (const Status free = check_outputs(*plan, side_outputs, is_dry); !free) return print_error(free.error());
  if (const Status formats = check_formats(command, output); !formats) return print_error(formats.error());
  if (const Status found = find_program(command); !found) return print_error(found.error());
  if (const Status opened = open_cache(command); !opened) return print_error(opened.error());

  if (!is_dry) {
    if (const Status made = make_folder(output_folder); !made) return print_error(made.error());
    if (const Status removed = remove_old_manifest(command); !removed) return print_error(removed.error());
  }
  command.options.import.may_lack_images = !command.words.strict;
  command.options.is_strict = command.words.strict;
  command.options.is_dry_run = command.words.dry_run;
  command.options.fail_fast = command.words.fail_fast;
  command.options.make_folders = !output_folder.empty();
  command.options.lists_files = !command.words.depfile.empty() || !command.words.manifest.empty();
  command.options.side_outputs = std::move(side_outputs);
  int none = 0;
  if (plan->empty()) none = print_error({ErrorCode::kIo, inputs.front(), "no scene in this folder"});
  return std::max(none, run_jobs(*share, command));
}

int run_build(const Verb& verb, std::span<char* const> args) {
  return run_command(verb, args, false);
}

int run_study(const Verb& verb, std::span<char* const> args) {
  return run_command(verb, args, true);
}

}  // namespace

const Verb kBuildVerb{
    "build", "convert glTF, PLY, OBJ or STL scenes to .lode assets",
    "Builds a level-of-detail DAG of clusters for each mesh of a scene and writes it, with nodes, materials, textures "
    "and animations, as one .lode asset.\n\n"
    "The settings can also be in a file meshlode.json beside the scene; an option wins over the file. The asset's "
    "bytes depend on the scene and the settings alone, not on the number of threads or the machine.\n\n"
    "With -O many scenes are built. A scene that fails does not stop the others, and the exit status is the worst one. "
    "Each file appears whole or not at all.",
    "meshlode build scene.glb -o scene.lode\n"
    "  meshlode build scene.glb -o scene.lode --preset best --error-tier certified\n"
    "  meshlode build a.glb folder/ 'more/**/*.gltf' -O out/ --cache cache/",
    run_build};

const Verb kStudyVerb{"study", "build with experimental settings, which the asset records",
                      "Does what build does, with parts of the builder left out or replaced, to measure what they are "
                      "worth. Its assets are not meant to be shipped.",
                      "meshlode study scene.glb -o scene.lode --care needles=off", run_study};

}  // namespace meshlode::cli
