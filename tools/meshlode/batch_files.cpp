// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch_files.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "app/batch/batch.h"
#include "app/batch/depend/depfile.h"
#include "app/batch/tell/tell.h"
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
  // A shard's manifest says that the shard is complete, and appears at its end (docs/cluster.md).
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

/// Before the end of a batch it is not known which files its scenes are made of. A file of another kind that is there
/// already is written over at once only if no scene names it; devices and pipes take one text.
bool BatchFiles::may_be_early(const std::string& path) const {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return true;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  const auto file = MappedFile::open(path);
  if (!file) return false;
  if (is_batch_file(file->bytes())) return true;
  return std::none_of(jobs_.begin(), jobs_.end(), [&](const app::Job& job) {
    const auto references = scene::list_references(job.input);
    return references && std::any_of(references->begin(), references->end(),
                                     [&](const scene::FileReference& one) { return is_same_place(one.path, path); });
  });
}

void BatchFiles::write_both(const Write& write) {
  const int worst = std::max(app::worst_exit_code(results_), static_cast<int>(ErrorCode::kIo));
  const app::ShardPlan* shard = names_.shard ? &*names_.shard : nullptr;
  if (is_manifest_early_) {
    is_manifest_early_ =
        write(names_.manifest, app::manifest_json(results_, names_.program, names_.settings, worst, shard, false));
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
  const std::vector<std::string>& refused = result.refused_outputs;
  const auto is_refused = [&](const std::string& path) {
    return std::find(refused.begin(), refused.end(), path) != refused.end();
  };
  if (is_refused(names_.manifest)) is_manifest_early_ = false;
  if (is_refused(names_.junit)) is_junit_early_ = false;
  write_early();
}

/// By the thread that waits for signals. What the others would write from here on is refused before they are told of,
/// so that no asset appears that the manifest calls skipped; and they wait here for the end of the process.
void BatchFiles::write_at_interrupt() {
  mutex_.lock();
  if (is_over_) return;
  output_files().abandon();
  OutputFiles files;
  write_both([&](const std::string& path, const std::string& text) {
    return static_cast<bool>(files.write(path, bytes_of(text)));
  });
}

int BatchFiles::finish(const std::vector<app::JobResult>& results, const std::string& report) {
  const std::lock_guard lock(mutex_);
  int worst = 0;
  const auto write = [&](const std::string& path, const Result<std::string>& text) {
    if (path.empty()) return;
    for (const app::JobResult& r : results) {
      if (std::find(r.refused_outputs.begin(), r.refused_outputs.end(), path) != r.refused_outputs.end()) return;
    }
    const Status written = text ? write_text(path, *text) : Status(text.error());
    if (!written) worst = std::max(worst, print_error(written.error()));
  };
  const app::ShardPlan* shard = names_.shard ? &*names_.shard : nullptr;
  write(names_.report, report);
  if (!names_.junit.empty()) write(names_.junit, app::junit_xml(results));
  if (!names_.depfile.empty()) write(names_.depfile, depfile_of(results));
  if (!names_.manifest.empty()) {
    write(names_.manifest,
          app::manifest_json(results, names_.program, names_.settings, app::worst_exit_code(results), shard));
  }
  is_over_ = true;
  return worst;
}

}  // namespace meshlode::cli
