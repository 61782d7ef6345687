// SPDX-License-Identifier: GPL-3.0-or-later
// What a batch asks of each of its jobs, and whom a job tells what it does.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/batch/jobs/job_result.h"
#include "app/batch/jobs/jobs.h"
#include "app/settings/settings.h"
#include "builder/options.h"
#include "builder/progress.h"
#include "scene/import/import.h"

namespace meshlode::app {

class Cache;

/// The settings of one job: files beside its scene and above it, outermost first, then what was given.
using SettingsOf = std::function<Result<std::vector<app::SettingLayer>>(const Job& job)>;

/// Looks at an asset that a job has made, or found made. Errors: kCheckFailed, or why it could not be looked at.
using CheckAsset = std::function<Status(const std::filesystem::path& asset)>;

struct BatchOptions {
  builder::PipelineOptions pipeline;  ///< of all jobs
  SettingsOf settings_of;             ///< where there is one, a job's own settings go before `pipeline`
  scene::ImportOptions import;
  CheckAsset check_asset;        ///< where there is one, its error is the job's; the asset stays
  const Cache* cache = nullptr;  ///< may be none
  bool is_dry_run = false;       ///< nothing is written: what would be done, and why
  /// What list_warnings() says of a job is its error, and so is a name of --aggregate that nothing has.
  bool is_strict = false;
  bool fail_fast = false;                 ///< what comes after a failure is skipped
  bool make_folders = false;              ///< for the outputs
  bool lists_files = false;               ///< JobResult::files is wanted, without a cache too
  std::vector<std::string> side_outputs;  ///< other files that the command writes: none may be a file of a scene
};

/// What the caller may show. All may be empty.
struct BatchWatcher {
  std::function<void(std::size_t job)> on_start;
  /// The scene of the job started last is imported, and about to be built so.
  std::function<void(const scene::Scene& scene, std::span<const app::SettingLayer> layers,
                     const builder::PipelineOptions& options)>
      on_scene;
  builder::ProgressCallback on_progress;  ///< of the job started last
  /// The asset of the job started last is about to be written. `result`: the job's, as far as it is known then, if the
  /// asset gets its name and nothing comes after.
  std::function<void(const JobResult& result)> on_write;
  std::function<void(std::size_t job, const JobResult& result, const Error* error)> on_end;
};

}  // namespace meshlode::app
