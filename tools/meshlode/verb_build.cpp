// SPDX-License-Identifier: GPL-3.0-or-later
// build: scenes in, assets out. One input with -o, or many inputs and folders with -O; a batch goes on after a failure
// and exits with its worst code.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>
#include <utility>

#include "base/byte_size.h"
#include "base/json_writer.h"
#include "base/version.h"
#include "build/build.h"
#include "build/settings/settings.h"
#include "build_options.h"
#include "options.h"
#include "outputs.h"
#include "progress.h"
#include "scene/import/import.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

namespace fs = std::filesystem;

struct Job {
  fs::path input;
  fs::path output;
};

struct JobResult {
  Job job;
  int exit_code = 0;
  std::string error;
  bool is_report_refused = false;  ///< --report names a file of the scene
  double seconds = 0.0;
  std::uint64_t triangles = 0;
  std::uint64_t meshes = 0, instances = 0;
  std::uint64_t bytes = 0;
  std::uint64_t memory_estimate = 0;  ///< 0: not reached
  std::uint64_t dropped = 0;          ///< by --repair, of all kinds
  scene::MeshRepairs repairs;         ///< of all meshes
  std::vector<build::StageTime> stages;
  std::vector<build::LevelTime> levels;
  std::vector<scene::LeftOut> left_out;     ///< by the importer
  std::vector<scene::LeftOut> planned_out;  ///< by the plan
  std::vector<scene::LeftOut> losses;       ///< those of them that the scene's materials can show
};

class Timer {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool is_scene_file(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const char* known : {".gltf", ".glb", ".ply", ".obj", ".stl"}) {
    if (extension == known) return true;
  }
  return false;
}

/// Every scene below a folder, in byte order of the paths so that a batch runs the same way everywhere.
Result<std::vector<fs::path>> scan_folder(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code ec;
  for (fs::recursive_directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    std::error_code type_error;
    if (it->is_regular_file(type_error) && is_scene_file(it->path())) found.push_back(it->path());
  }
  if (ec) return Error{ErrorCode::kIo, folder.string(), ec.message()};
  std::sort(found.begin(), found.end(), [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  return found;
}

fs::path with_lode_extension(const fs::path& path) {
  fs::path out = path;
  return out.replace_extension(".lode");
}

/// Which file becomes which. Below -O, a folder's inner structure is kept; `a.glb` and `a.ply` that would both become
/// `a.lode` keep their extensions (`a.glb.lode`).
Result<std::vector<Job>> plan_jobs(const std::vector<std::string>& inputs, const std::string& output,
                                   const std::string& output_folder) {
  std::vector<Job> jobs;
  std::error_code ec;
  for (const std::string& input : inputs) {
    if (!fs::is_directory(input, ec)) {
      const fs::path name = with_lode_extension(fs::path(input).filename());
      jobs.push_back({input, !output.empty()         ? fs::path(output)
                             : output_folder.empty() ? with_lode_extension(input)
                                                     : output_folder / name});
      continue;
    }
    if (output_folder.empty())
      return Error{ErrorCode::kUsage, input, "a folder as input needs -O FOLDER for the output"};
    auto found = scan_folder(input);
    if (!found) return found.error();
    for (const fs::path& path : *found) {
      jobs.push_back({path, output_folder / with_lode_extension(path.lexically_relative(input))});
    }
  }
  if (!output.empty() && (jobs.size() != 1 || inputs.size() != 1)) {
    return Error{ErrorCode::kUsage, "-o", "one output for several inputs; give -O FOLDER"};
  }
  std::set<fs::path> seen, twice;
  for (const Job& job : jobs) {
    if (!seen.insert(job.output.lexically_normal()).second) twice.insert(job.output.lexically_normal());
  }
  std::set<fs::path> final_names;
  for (Job& job : jobs) {
    if (twice.contains(job.output.lexically_normal())) {
      job.output.replace_filename(job.input.filename().string() + ".lode");
    }
    if (!final_names.insert(job.output.lexically_normal()).second) {
      return Error{ErrorCode::kUsage, job.input.string(), "two inputs would both become " + job.output.string()};
    }
  }
  return jobs;
}

/// No output may be any input, nor the report an asset: checked before the first job has written anything.
Status check_outputs(const std::vector<Job>& jobs, const std::string& report_path) {
  for (const Job& job : jobs) {
    if (const auto id = find_file_id(job.input)) output_files().keep(*id);
  }
  if (report_path.empty()) return Ok{};
  if (Status free = output_files().claim(report_path); !free) return free;
  for (const Job& job : jobs) {
    if (is_same_place(job.output, report_path)) {
      return Error{ErrorCode::kUsage, "--report", "the report would overwrite the asset " + job.output.string()};
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

/// What the import has opened, the scene's buffers and images among it, is no place for an output.
Status check_against_read(const fs::path& output, const std::string& report_path, JobResult& result) {
  if (Status free = output_files().claim(output); !free) return free;
  if (report_path.empty()) return Ok{};
  Status free = output_files().claim(report_path);
  result.is_report_refused = !free;
  return free;
}

struct JobOptions {
  build::PipelineOptions pipeline;
  scene::ImportOptions import;
  std::string report_path;
  bool make_folders = false;  ///< for the output, below -O
};

/// What --repair did, summed over the meshes.
void count_repairs(const scene::Scene& scene, JobResult& result) {
  for (const scene::SourceMesh& mesh : scene.meshes) {
    result.dropped += mesh.drops.repaired;
    result.repairs.degenerate += mesh.repairs.degenerate;
    result.repairs.duplicate += mesh.repairs.duplicate;
    result.repairs.turned += mesh.repairs.turned;
    result.repairs.stitched += mesh.repairs.stitched;
    result.repairs.cut_edges += mesh.repairs.cut_edges;
    result.repairs.split += mesh.repairs.split;
  }
}

Result<std::vector<std::uint8_t>> import_and_build(const Job& job, const JobOptions& options, Progress& progress,
                                                   JobResult& result) {
  const Timer import_timer;
  std::vector<FileId> files_read;
  scene::ImportOptions import_options = options.import;
  import_options.files_read = &files_read;
  Result<scene::Scene> scene = scene::import_scene(job.input, import_options);
  output_files().keep(files_read);
  if (const Status free = check_against_read(job.output, options.report_path, result); !free) return free.error();
  if (!scene) return scene.error();
  result.stages.push_back({"import", import_timer.seconds()});
  result.meshes = scene->meshes.size();
  result.instances = scene->instances.size();
  for (const scene::SourceMesh& mesh : scene->meshes) {
    for (const scene::Primitive& primitive : mesh.primitives) result.triangles += primitive.indices.size() / 3;
  }
  count_repairs(*scene, result);
  result.left_out = scene->left_out;
  build::PipelineReport report;
  auto bytes = build::build_lode(std::move(*scene), options.pipeline, progress.callback(), report);
  result.memory_estimate = report.memory_estimate;
  result.stages.insert(result.stages.end(), report.stages.begin(), report.stages.end());
  result.levels = std::move(report.levels);
  for (const build::PlanDecision& decision : report.decisions) {
    if (decision.kept) continue;
    result.planned_out.push_back({decision.what, decision.reason});
    if (decision.is_loss) result.losses.push_back(result.planned_out.back());
  }
  return bytes;
}

JobResult run_job(const Job& job, const JobOptions& options, Progress& progress) {
  JobResult result;
  result.job = job;
  const Timer timer;
  const auto fail = [&](const Error& error) {
    progress.finish();
    result.error = error.message();
    result.exit_code = print_error(error);
    result.seconds = timer.seconds();
    return result;
  };
  if (options.make_folders) {
    if (const Status made = make_folder(job.output.parent_path()); !made) return fail(made.error());
  }
  if (const Status free = output_files().claim(job.output); !free) return fail(free.error());
  progress.start(job.input.filename().string());
  auto bytes = import_and_build(job, options, progress, result);
  if (!bytes) {
    Error error = bytes.error();
    if (error.where.empty()) error.where = job.input.string();
    return fail(error);
  }
  const Timer write_timer;
  if (const Status ok = output_files().write(job.output, *bytes); !ok) return fail(ok.error());
  result.stages.push_back({"write_file", write_timer.seconds()});
  result.bytes = bytes->size();
  result.seconds = timer.seconds();
  progress.finish();
  return result;
}

/// Each kind of repair with its count: what the report and the summary say.
std::vector<std::pair<const char*, std::uint64_t>> list_repairs(const JobResult& r) {
  return {{"unusable", r.dropped - r.repairs.degenerate - r.repairs.duplicate},
          {"degenerate", r.repairs.degenerate},
          {"duplicate", r.repairs.duplicate},
          {"turned", r.repairs.turned},
          {"stitched", r.repairs.stitched},
          {"cut_edges", r.repairs.cut_edges},
          {"split", r.repairs.split}};
}

void print_repairs(const JobResult& r) {
  std::string text;
  for (const auto& [kind, count] : list_repairs(r)) {
    if (count == 0) continue;
    text += text.empty() ? "" : ", ";
    text += std::to_string(count) + " " + kind;
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!text.empty()) std::fprintf(stderr, "  repaired: %s\n", text.c_str());
}

void print_summary(const JobResult& r) {
  std::fprintf(stderr, "%s: %llu triangles in %llu mesh(es) -> %s, %llu bytes, %.2f s (%.0f triangles/s)\n",
               r.job.input.string().c_str(), static_cast<unsigned long long>(r.triangles),
               static_cast<unsigned long long>(r.meshes), r.job.output.string().c_str(),
               static_cast<unsigned long long>(r.bytes), r.seconds,
               r.seconds > 0.0 ? static_cast<double>(r.triangles) / r.seconds : 0.0);
  print_repairs(r);
  for (const scene::LeftOut& left : r.left_out) {
    std::fprintf(stderr, "  left out: %s: %s\n", left.what.c_str(), left.why.c_str());
  }
  if (r.losses.empty()) return;  // one line for all meshes of a scene
  const std::string more = r.losses.size() > 1 ? " and " + std::to_string(r.losses.size() - 1) + " more" : "";
  std::fprintf(stderr, "  left out: %s%s: %s\n", r.losses[0].what.c_str(), more.c_str(), r.losses[0].why.c_str());
}

void write_left_out(JsonWriter& w, const std::vector<scene::LeftOut>& items) {
  for (const scene::LeftOut& left : items) {
    w.begin_object();
    w.field("what", left.what);
    w.field("why", left.why);
    w.end_object();
  }
}

void write_times(JsonWriter& w, const JobResult& r) {
  w.key("stages");
  w.begin_array();
  for (const build::StageTime& stage : r.stages) {
    w.begin_object();
    w.field("stage", stage.stage);
    w.field("seconds", stage.seconds);
    w.end_object();
  }
  w.end_array();
  w.key("levels");
  w.begin_array();
  for (const build::LevelTime& level : r.levels) {
    w.begin_object();
    w.field("mesh", level.mesh);
    w.field("level", level.level);
    w.field("triangles", level.triangles);
    w.field("seconds", level.seconds);
    w.end_object();
  }
  w.end_array();
}

/// docs/schemas/report.schema.json. Times and paths live here and never in an asset.
std::string report_json(const std::vector<JobResult>& results, std::uint32_t jobs, int exit_code) {
  JsonWriter w;
  w.begin_object();
  w.field("generator", program_version());
  w.field("jobs", jobs);
  w.field("exit_code", exit_code);
  w.key("builds");
  w.begin_array();
  for (const JobResult& r : results) {
    w.begin_object();
    w.field("input", r.job.input.string());
    w.field("output", r.job.output.string());
    w.field("exit_code", r.exit_code);
    w.key("error");
    if (r.error.empty()) {
      w.null();
    } else {
      w.value(r.error);
    }
    w.field("meshes", r.meshes);
    w.field("instances", r.instances);
    w.field("source_triangles", r.triangles);
    w.field("file_bytes", r.bytes);
    w.key("memory_estimate_bytes");
    if (r.memory_estimate > 0) {
      w.value(r.memory_estimate);
    } else {
      w.null();
    }
    w.field("seconds", r.seconds);
    w.key("triangles_per_second");
    if (r.seconds > 0.0 && r.exit_code == 0) {
      w.value(static_cast<double>(r.triangles) / r.seconds);
    } else {
      w.null();
    }
    write_times(w, r);
    w.key("repaired");
    w.begin_object();
    for (const auto& [kind, count] : list_repairs(r)) w.field(kind, count);
    w.end_object();
    w.key("left_out");
    w.begin_array();
    write_left_out(w, r.left_out);
    write_left_out(w, r.planned_out);
    w.end_array();
    w.end_object();
  }
  w.end_array();
  w.end_object();
  return w.text();
}

int run_build(const Verb& verb, std::span<char* const> args) {
  std::vector<std::string> inputs;
  std::string output, output_folder, report_path;
  BuildWords words;
  std::uint32_t jobs = 0;
  OutputOptions out;
  std::string max_memory = "auto", max_decoded = kDefaultMaxDecodedText;
  OptionParser parser(verb);
  parser.add_positionals("input", inputs, ".gltf, .glb, .ply, .obj or .stl files, and folders of them with -O");
  parser.add_value("-o,--output", output, "the asset to write; the input's name with .lode where not given");
  parser.add_value("-O,--output-folder", output_folder, "folder for the assets of many inputs; made where missing");
  add_build_options(parser, words);
  parser.add_value(
      "--max-memory", max_memory,
      "what the build may take, such as 8GiB: meshes one by one to keep it, or refused; auto: what is left");
  add_max_decoded_option(parser, max_decoded);
  add_jobs_option(parser, jobs);
  parser.add_value("--report", report_path, "write times and counts as JSON, the same that --format json prints");
  add_output_options(parser, out);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (!output.empty() && !output_folder.empty()) {
    return print_error({ErrorCode::kUsage, "", "give -o or -O, not both"});
  }
  const build::SettingLayer given = given_settings(words);
  const Result<build::Settled> settled = build::settle({&given, 1});
  if (!settled) return print_error(settled.error());
  build::PipelineOptions options = settled->options;
  if (max_memory != "auto") {
    const auto bytes = parse_byte_size(max_memory);
    if (!bytes || *bytes == 0)
      return print_error({ErrorCode::kUsage, "--max-memory", "give auto or a size above 0, such as 8GiB"});
    options.max_memory = *bytes;
  }
  const Result<std::uint64_t> decoded = parse_max_decoded(max_decoded);
  if (!decoded) return print_error(decoded.error());
  const auto plan = plan_jobs(inputs, output, output_folder);
  if (!plan) return print_error(plan.error());

  if (const Status made = make_folder(output_folder); !made) return print_error(made.error());
  if (const Status free = check_outputs(*plan, report_path); !free) return print_error(free.error());
  JobOptions job_options;
  job_options.pipeline = options;
  job_options.import.repair = options.repair;
  job_options.import.scene = words.scene;
  job_options.import.max_decoded = *decoded;
  job_options.report_path = report_path;
  job_options.make_folders = !output_folder.empty();

  JobLimit limit(jobs);
  std::vector<JobResult> results;
  int worst = 0;
  bool is_report_refused = false;
  if (plan->empty()) worst = print_error({ErrorCode::kIo, inputs.front(), "no scene below this folder"});
  for (std::size_t i = 0; i < plan->size(); ++i) {
    Progress progress(out.quiet, i, plan->size());
    limit.run([&] { results.push_back(run_job((*plan)[i], job_options, progress)); });
    worst = std::max(worst, results.back().exit_code);
    is_report_refused = is_report_refused || results.back().is_report_refused;
    if (!out.quiet && !out.json() && results.back().exit_code == 0) print_summary(results.back());
  }
  const std::string text = report_json(results, jobs, worst);
  if (!report_path.empty() && !is_report_refused) {
    if (const Status ok = write_text(report_path, text); !ok) {
      worst = std::max(worst, print_error(ok.error()));
    }
  }
  if (out.json() && !print_out(text)) worst = std::max(worst, static_cast<int>(ErrorCode::kIo));
  return worst;
}

}  // namespace

const Verb kBuildVerb{"build", "turn glTF, PLY, OBJ or STL scenes into .lode assets",
                      "meshlode build scene.glb -o scene.lode\n  meshlode build a.glb b.glb folder/ -O out/",
                      run_build};

}  // namespace meshlode::cli
