// SPDX-License-Identifier: GPL-3.0-or-later
// Many scenes become assets, one after another on all threads: the page to read first of this floor.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/output_files.h"
#include "batch/cache/cache.h"
#include "batch/jobs/jobs.h"
#include "batch/work/job_result.h"
#include "build/build.h"
#include "build/settings/settings.h"
#include "scene/import/import.h"

namespace meshlode::batch {

/// The settings of one job: files beside its scene and above it, outermost first, then what was given.
using SettingsOf = std::function<Result<std::vector<build::SettingLayer>>(const Job& job)>;

/// Looks at an asset that a job has made, or found made. Errors: kCheckFailed, or why it could not be looked at.
using CheckAsset = std::function<Status(const std::filesystem::path& asset)>;

struct BatchOptions {
  build::PipelineOptions pipeline;  ///< of all jobs
  SettingsOf settings_of;           ///< where there is one, a job's own settings go before `pipeline`
  scene::ImportOptions import;
  CheckAsset check_asset;                 ///< where there is one, its error is the job's; the asset stays
  const Cache* cache = nullptr;           ///< may be none
  bool is_dry_run = false;                ///< nothing is written: what would be done, and why
  bool is_strict = false;                 ///< what list_warnings() says of a job is its error, and an unknown name of --aggregate
  bool fail_fast = false;                 ///< what comes after a failure is skipped
  bool make_folders = false;              ///< for the outputs
  bool lists_files = false;               ///< JobResult::files is wanted, without a cache too
  std::vector<std::string> side_outputs;  ///< other files that the command writes: none may be a file of a scene
};

/// What the caller may show. All may be empty.
struct BatchWatcher {
  std::function<void(std::size_t job)> on_start;
  /// The scene of the job started last is imported, and about to be built so.
  std::function<void(const scene::Scene& scene, std::span<const build::SettingLayer> layers,
                     const build::PipelineOptions& options)>
      on_scene;
  build::ProgressCallback on_progress;  ///< of the job started last
  std::function<void(std::size_t job, const JobResult& result, const Error* error)> on_end;
};

/// One result a job, in the order of jobs. `files` knows the outputs and what was read: what the scenes are made of is
/// kept from being written over. A job's failure is in its result, and does not stop the others but where asked to.
[[nodiscard]] std::vector<JobResult> run_batch(const std::vector<Job>& jobs, const BatchOptions& options,
                                               OutputFiles& files, const BatchWatcher& watcher);

/// The worst exit code, 0 for none.
[[nodiscard]] int worst_exit_code(const std::vector<JobResult>& results);

}  // namespace meshlode::batch
