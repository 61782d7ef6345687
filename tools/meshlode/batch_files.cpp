// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch_files.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>

#include "app/batch/batch.h"
#include "app/batch/depend/depfile.h"
#include "app/batch/tell/tell.h"
#include "base/file.h"
#include "options.h"
#include "outputs.h"
#include "scene/import/import.h"

namespace meshlode::cli {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWaitFactor = 10;  ///< how much longer it waits than a write took

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Result<std::string> depfile_of(const std::vector<app::JobResult>& results) {
  std::vector<app::DepfileRule> rules;
  for (const app::JobResult& r : results) {
    app::DepfileRule rule{r.job.output, {}};
    for (const app::Dependency& file : r.files) {
      if (!file.path.empty()) rule.inputs.push_back(file.path);
    }
    if (rule.inputs.empty()) rule.inputs.push_back(r.job.input);
    rules.push_back(std::move(rule));
  }
  return app::depfile_text(rules);
}

/// Of an earlier batch, which nobody misses.
bool is_batch_file(std::span<const std::uint8_t> bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 200));
  return head.starts_with("{\n  \"generator\": \"meshlode") ||
         (head.starts_with("<?xml") && head.find("<testsuites name=\"meshlode\"") != std::string_view::npos);
}

}  // namespace

BatchFiles::BatchFiles(const std::vector<app::Job>& jobs, BatchFileNames names)
    : names_(std::move(names)), jobs_(jobs) {
  // A shard's manifest says that the shard is complete, and appears at its end (docs/guides/many-machines.md).
  is_manifest_early_ = !names_.shard && !names_.manifest.empty() && may_be_early(names_.manifest);
  is_junit_early_ = !names_.junit.empty() && may_be_early(names_.junit);
  for (const app::Job& job : jobs) {
    app::JobResult& result = results_.emplace_back();  // JobStatus::kSkipped
    result.job = job;
    result.error = "interrupted";
  }
  set_interrupt_action([this] { write_at_interrupt(); });
}

BatchFiles::~BatchFiles() {
  set_interrupt_action({});
}

/// Before the end of a batch it is not known which files its scenes are made of. A file that is not there yet, or is of
/// another kind, is written at once only if no scene names it; devices and pipes take one text.
bool BatchFiles::may_be_early(const std::string& path) const {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    if (!std::filesystem::is_regular_file(path, error)) return false;
    const auto file = MappedFile::open(path);
    if (!file) return false;
    if (is_batch_file(file->bytes())) return true;
  }
  return std::none_of(jobs_.begin(), jobs_.end(), [&](const app::Job& job) {
    const auto references = scene::list_references(job.input, names_.allow_outside);
    return references && std::any_of(references->begin(), references->end(),
                                     [&](const scene::FileReference& one) { return is_same_place(one.path, path); });
  });
}

void BatchFiles::write_both(const Write& write) {
  const int worst = std::max(app::worst_exit_code(results_), static_cast<int>(ErrorCode::kIo));
  const app::ShardPlan* shard = names_.shard ? &*names_.shard : nullptr;
  if (is_manifest_early_) {
    is_manifest_early_ = write(names_.manifest, app::manifest_json(results_, names_.program, names_.settings, worst,
                                                                   shard, false, names_.versions));
  }
  if (is_junit_early_) is_junit_early_ = write(names_.junit, app::junit_xml(results_));
}

void BatchFiles::write_early() {
  const Clock::time_point start = Clock::now();
  if (start < next_ || (!is_manifest_early_ && !is_junit_early_)) return;
  write_both([](const std::string& path, const std::string& text) {
    return static_cast<bool>(output_files().rewrite(path, bytes_of(text)));
  });
  const Clock::time_point end = Clock::now();
  next_ = end + kWaitFactor * (end - start);
}

void BatchFiles::begin() {
  const std::lock_guard lock(mutex_);
  write_early();
}

void BatchFiles::add(std::size_t job, const app::JobResult& result) {
  const std::lock_guard lock(mutex_);
  results_[job] = result;
  written_.reset();
  const std::vector<std::string>& refused = result.refused_outputs;
  const auto is_refused = [&](const std::string& path) {
    return std::find(refused.begin(), refused.end(), path) != refused.end();
  };
  if (is_refused(names_.manifest)) is_manifest_early_ = false;
  if (is_refused(names_.junit)) is_junit_early_ = false;
  write_early();
}

void BatchFiles::expect(std::size_t job, const app::JobResult& result) {
  const std::lock_guard lock(mutex_);
  written_.emplace(job, result);
}

/// By the thread that waits for signals. What the others would write from here on is refused before they are told of,
/// so that no asset appears that the manifest calls skipped; and they wait here for the end of the process. The asset
/// of the running job is either in place by then, or never will be.
void BatchFiles::write_at_interrupt() {
  mutex_.lock();
  if (is_over_) return;
  output_files().abandon();
  if (written_ && output_files().has_written(written_->second.job.output)) {
    results_[written_->first] = written_->second;
  }
  OutputFiles files;
  write_both([&](const std::string& path, const std::string& text) {
    return static_cast<bool>(files.write(path, bytes_of(text)));
  });
}

/// The lock is held only for files that cannot keep it: a pipe that nobody reads must not keep an interrupt waiting.
/// Until manifest and JUnit file are written here an interrupt writes them.
int BatchFiles::finish(const std::vector<app::JobResult>& results, const std::string& report) {
  int worst = 0;
  const auto is_wanted = [&](const std::string& path) {
    if (path.empty()) return false;
    return std::none_of(results.begin(), results.end(), [&](const app::JobResult& r) {
      return std::find(r.refused_outputs.begin(), r.refused_outputs.end(), path) != r.refused_outputs.end();
    });
  };
  const auto write = [&](const std::string& path, const Result<std::string>& text) {
    return text ? write_text(path, *text) : Status(text.error());
  };
  const auto take = [&](const Status& written) {
    if (!written) worst = std::max(worst, print_error(written.error()));
  };
  const auto write_unlocked = [&](const std::string& path, const Result<std::string>& text) {
    const Status written = write(path, text);
    const std::lock_guard lock(mutex_);  // what an interrupt refused is no error to tell of
    take(written);
  };
  const app::ShardPlan* shard = names_.shard ? &*names_.shard : nullptr;
  const auto junit = [&] { return app::junit_xml(results); };
  const auto manifest = [&] {
    return app::manifest_json(results, names_.program, names_.settings, app::worst_exit_code(results), shard, true,
                              names_.versions);
  };
  const bool has_junit = is_wanted(names_.junit), has_manifest = is_wanted(names_.manifest);
  bool is_junit_early = false, is_manifest_early = false;
  {
    const std::lock_guard lock(mutex_);
    is_junit_early = has_junit && is_junit_early_;
    is_manifest_early = has_manifest && is_manifest_early_;
  }
  if (is_wanted(names_.report)) write_unlocked(names_.report, report);
  if (has_junit && !is_junit_early) write_unlocked(names_.junit, junit());
  if (is_wanted(names_.depfile)) write_unlocked(names_.depfile, depfile_of(results));
  if (has_manifest && !is_manifest_early) write_unlocked(names_.manifest, manifest());
  const std::lock_guard lock(mutex_);
  if (is_junit_early) take(write(names_.junit, junit()));
  if (is_manifest_early) take(write(names_.manifest, manifest()));
  is_over_ = true;
  return worst;
}

}  // namespace meshlode::cli
