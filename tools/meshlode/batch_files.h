// SPDX-License-Identifier: GPL-3.0-or-later
// What `build` writes beside its assets. Manifest and JUnit file are there from the start on and told anew after every
// file, so that a batch that is interrupted or killed has them: what it did not come to is skipped, "interrupted", and
// an asset that was put in place before an interrupt is not.
//
// A manifest of N entries after each of N files is quadratic. So what was just written waits until ten times as long
// has passed as writing it took: at most about a tenth of the time goes there. An interrupt writes what waits.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/batch/jobs/job_result.h"
#include "app/batch/jobs/jobs.h"
#include "app/batch/shard/partition.h"
#include "app/batch/tell/tell.h"
#include "base/hash.h"

namespace meshlode::cli {

/// Paths, empty for none, and what the manifest says of the whole.
struct BatchFileNames {
  std::string manifest, junit, depfile, report;
  Hash128 program{};
  std::string settings;  ///< app::settings_text()
  std::optional<app::ShardPlan> shard;
  std::vector<std::filesystem::path> allow_outside = {};  ///< scene::ImportOptions'
  app::Versions versions = {};
};

class BatchFiles {
 public:
  /// While it lives an interrupt of the process writes manifest and JUnit file.
  BatchFiles(const std::vector<app::Job>& jobs, BatchFileNames names);
  ~BatchFiles();
  BatchFiles(const BatchFiles&) = delete;
  BatchFiles& operator=(const BatchFiles&) = delete;

  /// Before the first job. Errors are those of the end, and told there.
  void begin();
  /// The asset of this job is about to be written; `result` is the job's once it is in place.
  void expect(std::size_t job, const app::JobResult& result);
  void add(std::size_t job, const app::JobResult& result);
  /// All files, for good; but not one that turned out to be a file of a scene, which its job was refused for. \returns
  /// the worst exit code of writing them
  int finish(const std::vector<app::JobResult>& results, const std::string& report);

 private:
  using Write = std::function<bool(const std::string& path, const std::string& text)>;
  /// \pre mutex_ is held
  void write_both(const Write& write);
  void write_early();
  void write_at_interrupt();
  [[nodiscard]] bool may_be_early(const std::string& path) const;

  const BatchFileNames names_;
  std::vector<app::Job> jobs_;
  bool is_manifest_early_ = false, is_junit_early_ = false;
  std::mutex mutex_;  ///< of all below
  std::vector<app::JobResult> results_;
  std::optional<std::pair<std::size_t, app::JobResult>> written_;  ///< of expect(), until add()
  bool is_over_ = false;
  std::chrono::steady_clock::time_point next_{};  ///< nothing is written before
};

}  // namespace meshlode::cli
