// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/work/run_job.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "app/batch/cache/cache.h"
#include "app/batch/cache/ingredients.h"
#include "app/batch/cache/mesh_entries.h"
#include "app/batch/work/decided.h"
#include "app/batch/work/warnings.h"
#include "app/measure/measure_asset.h"
#include "base/guarded.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/try.h"
#include "builder/builder.h"
#include "builder/needs.h"
#include "builder/stage_options.h"
#include "format/names.h"
#include "run/read/asset.h"
#include "scene/detect/detect.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

class Timer {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// What --repair did, summed over the meshes.
void count_repairs(const scene::Scene& scene, JobFacts& facts) {
  for (const scene::SourceMesh& mesh : scene.meshes) {
    facts.dropped += mesh.drops.repaired;
    facts.repairs.degenerate += mesh.repairs.degenerate;
    facts.repairs.duplicate += mesh.repairs.duplicate;
    facts.repairs.turned += mesh.repairs.turned;
    facts.repairs.stitched += mesh.repairs.stitched;
    facts.repairs.cut_edges += mesh.repairs.cut_edges;
    facts.repairs.split += mesh.repairs.split;
  }
}

void count_scene(const scene::Scene& scene, JobFacts& facts) {
  facts.meshes = scene.meshes.size();
  facts.instances = scene.instances.size();
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& primitive : mesh.primitives) facts.triangles += primitive.indices.size() / 3;
  }
  count_repairs(scene, facts);
  facts.file_triangles = scene.triangles_in_file;
  facts.missing = scene::count_missing_triangles(scene);
  facts.left_out = scene.left_out;
}

/// Whether the file at `path` holds an asset already.
bool holds(const fs::path& path, const AssetRecord& record) {
  const auto file = MappedFile::open(path);
  return file && file->bytes().size() == record.facts.bytes && hash128(file->bytes()) == record.asset;
}

class Run {
 public:
  Run(const Job& job, const BatchOptions& options, OutputFiles& files, const BatchWatcher& watcher)
      : options_(options), pipeline_(options.pipeline), import_(options.import), files_(files), watcher_(watcher) {
    result_.job = job;
  }

  JobResult take() { return std::move(result_); }

  Status go() {
    if (Status settled = settle(); !settled) return settled;
    const bool wants_files = options_.cache != nullptr || options_.lists_files || options_.is_dry_run;
    std::optional<Error> unreadable;
    if (wants_files) {
      auto found = find_dependencies(result_.job.input, import_.allow_outside);
      if (found) {
        result_.files = std::move(*found);
        scene_files_ = result_.files.size();
        if (options_.cache != nullptr) ingredients_ = ingredients_with(pipeline_);
        add_settings_files();
      } else {
        unreadable = found.error();  // the import will say the same, and more
      }
    }
    if (options_.is_dry_run) return unreadable ? Status(*unreadable) : plan();
    if (Status ready = make_ready(); !ready) return ready;
    if (!ingredients_.empty() && !lacks_files()) {
      result_.cache = CacheUse::kHit;
      if (auto record = options_.cache->find_record(ingredients_)) {
        if (auto done = take_from_cache(*record)) return std::move(*done);
      }
      result_.cache = CacheUse::kMiss;
      result_.reason = options_.cache->explain(result_.job.output, ingredients_);
    }
    // One scene that runs out of memory is one failed job.
    return guarded(result_.job.input, [&] { return build_and_write(); });
  }

 private:
  /// What files say of this job, and what was given.
  Status settle() {
    if (!options_.settings_of) return Ok{};
    TRY_LET(layers, options_.settings_of(result_.job));
    layers_ = std::move(*layers);
    TRY_LET(settled, app::settle(layers_));
    result_.settings = effective_settings(*settled, layers_);
    settled->options.max_memory = pipeline_.max_memory;
    settled->options.looks = pipeline_.looks;
    settled->options.images = pipeline_.images;
    settled->options.hooks = pipeline_.hooks;
    pipeline_ = std::move(settled->options);
    import_.repair = pipeline_.repair;
    import_.linear_colors = pipeline_.linear_colors;
    return Ok{};
  }

  [[nodiscard]] std::string ingredients_with(const builder::PipelineOptions& pipeline) const {
    return ingredients_text(options_.cache->program(), settings_text(pipeline, import_) + mesh_rules_text(layers_),
                            std::span(result_.files).first(scene_files_));
  }

  /// For who lists the files. What they say is in the settings, where they lie is nobody's business: not in the key.
  void add_settings_files() {
    for (const app::SettingLayer& layer : layers_) {
      if (layer.code == ErrorCode::kUsage) continue;  // the command line
      auto file = find_file(FileKind::kSettings, layer.from);
      if (file) result_.files.push_back(std::move(*file));
    }
  }

  /// What the import refuses is not taken from a run that was allowed more.
  [[nodiscard]] bool lacks_files() const {
    return !import_.may_lack_images &&
           std::any_of(result_.files.begin(), result_.files.end(), [](const Dependency& f) { return !f.stamp; });
  }

  /// --dry-run.
  Status plan() {
    for (const Dependency& file : result_.files) {
      const bool is_needed =
          file.kind == FileKind::kBuffer || (file.kind == FileKind::kImage && !import_.may_lack_images);
      if (file.stamp || !is_needed) continue;
      return Error{ErrorCode::kIo, file.path.empty() ? file.name : file.path.string(), "cannot be opened"};
    }
    result_.status = JobStatus::kWouldBuild;
    result_.reason = "no cache is used";
    if (options_.cache == nullptr) return Ok{};
    const auto record = options_.cache->find_record(ingredients_);
    if (record) {
      result_.facts = record->facts;
      if (Status whole = check_whole(record->facts); !whole) return whole;
      if (Status names = check_names(record->facts.planned_out); !names) return names;
    }
    if (record && holds(result_.job.output, *record)) {
      result_.status = JobStatus::kUnchanged;
      result_.reason = "the asset is there and nothing that it depends on changed";
    } else if (record && options_.cache->store().has(EntryKind::kAsset, record->asset)) {
      result_.status = JobStatus::kWouldCopy;
      result_.reason = "the cache has this asset";
    } else {
      result_.reason = options_.cache->explain(result_.job.output, ingredients_);
    }
    return Ok{};
  }

  /// Whether the asset is one to write, or to leave where it is.
  [[nodiscard]] Status check_whole(const JobFacts& facts) const {
    if (!options_.is_strict) return Ok{};
    const std::vector<JobWarning> warnings = list_warnings(facts);
    if (warnings.empty()) return Ok{};
    return Error{ErrorCode::kInvalid, result_.job.input.string(), "--strict: " + warnings.front().text};
  }

  Status make_ready() {
    const fs::path folder = result_.job.output.parent_path();
    if (options_.make_folders && !folder.empty()) {
      std::error_code ec;
      fs::create_directories(folder, ec);
      if (ec) return Error{ErrorCode::kIo, folder.string(), ec.message()};
    }
    return files_.claim(result_.job.output);
  }

  /// What the scene is made of is no place for an output.
  Status check_outputs(std::span<const FileId> read) {
    files_.keep(read);
    if (Status free = files_.claim(result_.job.output); !free) return free;
    Status status = Ok{};
    for (const std::string& path : options_.side_outputs) {
      Status free = files_.claim(path);
      if (free) continue;
      result_.refused_outputs.push_back(path);
      if (status) status = std::move(free);
    }
    return status;
  }

  /// Of --strict.
  template <class Decisions>
  [[nodiscard]] Status check_names(const Decisions& decisions) const {
    for (const auto& decision : decisions) {
      if (!options_.is_strict || !decision.what.starts_with(builder::kUnknownAggregate)) continue;
      const std::string name = decision.what.substr(builder::kUnknownAggregate.size() - 1);  // from its quote on
      return Error{ErrorCode::kUsage, result_.job.input.string(),
                   "--aggregate: no mesh and no material has the name " + name};
    }
    return Ok{};
  }

  /// Nothing: what the record promises is not there.
  std::optional<Status> take_from_cache(const AssetRecord& record) {
    std::vector<FileId> read;
    for (const Dependency& file : result_.files) {
      if (file.stamp) read.push_back(file.stamp->id);
    }
    if (Status free = check_outputs(read); !free) return free;
    if (Status whole = check_whole(record.facts); !whole) return whole;
    if (Status names = check_names(record.facts.planned_out); !names) return names;
    const bool is_there = holds(result_.job.output, record);
    if (!is_there) {
      const auto asset = options_.cache->store().find(EntryKind::kAsset, record.asset);
      if (!asset || asset->bytes.size() != record.facts.bytes) return std::nullopt;
      tell_write(JobStatus::kCached, record.facts, record.asset);
      if (Status written = files_.write(result_.job.output, asset->bytes); !written) return written;
    }
    result_.status = is_there ? JobStatus::kUnchanged : JobStatus::kCached;
    result_.facts = record.facts;
    result_.asset_hash = record.asset;
    options_.cache->remember(result_.job.output, ingredients_);
    return Status(Ok{});
  }

  /// What the result is if the process ends when the asset has its name, and before the job is over.
  void tell_write(JobStatus status, const JobFacts& facts, const Hash128& hash) const {
    if (!watcher_.on_write) return;
    JobResult result = result_;
    result.status = status;
    result.facts = facts;
    result.asset_hash = hash;
    result.warnings = list_warnings(facts);
    result.seconds = timer_.seconds();
    watcher_.on_write(result);
  }

  /// What a build would give, of a cached asset that differs in its error tier alone: no triangle depends on the tier.
  /// Nothing: there is none, measure_asset() cannot, or memory has no room for the build, which then says so.
  std::optional<std::vector<std::uint8_t>> measure_cached(const scene::Scene& scene) {
    // Rules of meshes may name tiers, and covisible is an order by errors.
    const bool may_differ = !mesh_rules_text(layers_).empty() || pipeline_.page_order != PageOrder::kLevel;
    if (ingredients_.empty() || pipeline_.hooks != nullptr || may_differ) return std::nullopt;
    const builder::MemoryEstimate estimate = builder::estimate_memory(scene, pipeline_);
    const auto fit =
        builder::fit_memory(estimate, scene, static_cast<std::uint32_t>(thread_limit()), pipeline_.max_memory);
    if (!fit) return std::nullopt;
    for (const auto& [tier, name] : format::kErrorTierNames) {
      builder::PipelineOptions other = pipeline_;
      other.error_tier = tier;
      if (tier == pipeline_.error_tier) continue;
      const auto record = options_.cache->find_record(ingredients_with(other));
      const auto entry = record ? options_.cache->store().find(EntryKind::kAsset, record->asset) : std::nullopt;
      if (!entry) continue;
      const auto asset = run::Asset::from_bytes(entry->bytes);
      if (!asset) continue;
      const Timer timer;
      auto bytes =
          with_threads_at_most(fit->threads, [&] { return measure_asset(*asset, scene, pipeline_.error_tier); });
      if (!bytes) continue;
      result_.reason += std::string("; triangles of the cached asset of --error-tier ") + name;
      result_.stages.push_back({"measure_cached", timer.seconds()});
      result_.facts = record->facts;
      result_.meshes_from_cache = record->facts.meshes;
      result_.memory_estimate = estimate.bytes(fit->at_once, fit->threads);
      return std::move(*bytes);
    }
    return std::nullopt;
  }

  Result<std::vector<std::uint8_t>> build(scene::Scene&& scene) {
    builder::PipelineReport report;
    std::optional<MeshEntries> meshes;
    if (options_.cache != nullptr) pipeline_.mesh_store = &meshes.emplace(*options_.cache);
    auto bytes = builder::build_lode(std::move(scene), pipeline_, watcher_.on_progress, report);
    pipeline_.mesh_store = nullptr;
    take_report(report);
    return bytes;
  }

  Status build_and_write() {
    const Timer import_timer;
    std::vector<FileId> read;
    import_.files_read = &read;
    Result<scene::Scene> scene = scene::import_scene(result_.job.input, import_);
    import_.files_read = nullptr;
    if (Status free = check_outputs(read); !free) return free;
    if (!scene) return scene.error();
    result_.stages.push_back({"import", import_timer.seconds()});
    count_scene(*scene, result_.facts);
    if (Status whole = check_whole(result_.facts); !whole) return whole;
    if (Status set = app::set_mesh_options(layers_, names_of_meshes(*scene), pipeline_); !set) return set;
    if (Status names = check_names(builder::unknown_names(*scene, pipeline_)); !names) return names;
    if (watcher_.on_scene) watcher_.on_scene(*scene, layers_, pipeline_);
    auto measured = measure_cached(*scene);
    const auto bytes = measured ? Result<std::vector<std::uint8_t>>(std::move(*measured)) : build(std::move(*scene));
    if (!bytes) return in_input(bytes.error());
    if (const Result<app::Settled> settled = app::settle(layers_); settled && !result_.decided.empty()) {
      if (const std::string use = app::describe_use(*settled); !use.empty())
        result_.decided = use + "; " + result_.decided;
    }
    if (Status whole = check_whole(result_.facts); !whole) return whole;
    JobFacts facts = result_.facts;
    facts.bytes = bytes->size();
    const bool has_hash = options_.cache != nullptr || options_.lists_files;
    const Hash128 hash = has_hash ? hash128(*bytes) : Hash128{};
    tell_write(JobStatus::kBuilt, facts, hash);
    const Timer write_timer;
    if (Status ok = files_.write(result_.job.output, *bytes); !ok) return ok;
    result_.stages.push_back({"write_file", write_timer.seconds()});
    result_.status = JobStatus::kBuilt;
    result_.facts = std::move(facts);
    result_.asset_hash = hash;
    // Only what was read as it was hashed, and nothing beside it, is known to make these bytes.
    if (!ingredients_.empty() && are_unchanged(result_.files) && cover(result_.files, read)) {
      options_.cache->keep({ingredients_, result_.asset_hash, result_.facts}, *bytes);
      options_.cache->remember(result_.job.output, ingredients_);
    }
    return Ok{};
  }

  /// The builder names places within the scene.
  [[nodiscard]] Error in_input(Error error) const {
    error.where = result_.job.input.string() + (error.where.empty() ? "" : ": " + error.where);
    return error;
  }

  void take_report(builder::PipelineReport& report) {
    result_.memory_estimate = report.memory_estimate;
    result_.meshes_from_cache = report.stored_meshes;
    result_.facts.draws_nothing = report.clusters == 0;
    result_.stages.insert(result_.stages.end(), report.stages.begin(), report.stages.end());
    result_.levels = std::move(report.levels);
    if (!report.decisions.empty()) result_.decided = describe_decided(pipeline_, report.decisions);
    for (const builder::PlanDecision& decision : report.decisions) {
      if (decision.kept) continue;
      result_.facts.planned_out.push_back({decision.what, decision.reason});
      if (decision.is_loss) result_.facts.losses.push_back(result_.facts.planned_out.back());
    }
  }

  const Timer timer_;
  const BatchOptions& options_;
  builder::PipelineOptions pipeline_;  ///< this job's
  scene::ImportOptions import_;
  std::vector<app::SettingLayer> layers_;  ///< empty where nobody asked for files
  OutputFiles& files_;
  const BatchWatcher& watcher_;
  std::size_t scene_files_ = 0;  ///< of result_.files, which come before settings files
  std::string ingredients_;      ///< empty: not known, so neither looked up nor kept
  JobResult result_;
};

}  // namespace

JobResult run_job(const Job& job, const BatchOptions& options, OutputFiles& files, const BatchWatcher& watcher,
                  Error& error) {
  const Timer timer;
  const std::clock_t processor_start = std::clock();
  const bool has_peak = options.lists_files && restart_peak_memory();  // of a manifest
  Run run(job, options, files, watcher);
  Status done = run.go();
  JobResult result = run.take();
  result.warnings = list_warnings(result.facts);
  if (done && options.check_asset && !options.is_dry_run) done = options.check_asset(job.output);
  result.seconds = timer.seconds();
  result.processor_seconds = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  result.peak_memory = has_peak ? peak_memory() : 0;
  if (done) return result;
  error = done.error();
  if (error.where.empty()) error.where = job.input.string();
  result.status = JobStatus::kFailed;
  result.error = error.message();
  result.exit_code = static_cast<int>(error.code);
  return result;
}

}  // namespace meshlode::app
