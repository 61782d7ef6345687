// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/batch.h"

#include <algorithm>

#include "app/batch/cache/cache.h"
#include "app/batch/work/run_job.h"

namespace meshlode::app {

std::vector<JobResult> run_batch(const std::vector<Job>& jobs, const BatchOptions& options, OutputFiles& files,
                                 const BatchWatcher& watcher) {
  std::vector<JobResult> results;
  bool is_over = false;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (is_over) {
      results.emplace_back().job = jobs[i];  // JobStatus::kSkipped
      continue;
    }
    if (watcher.on_start) watcher.on_start(i);
    Error error;
    results.push_back(run_job(jobs[i], options, files, watcher, error));
    const bool has_failed = results.back().exit_code != 0;
    if (watcher.on_end) watcher.on_end(i, results.back(), has_failed ? &error : nullptr);
    is_over = has_failed && options.fail_fast;
  }
  if (options.cache != nullptr) options.cache->store().trim();
  return results;
}

int worst_exit_code(const std::vector<JobResult>& results) {
  int worst = 0;
  for (const JobResult& result : results) worst = std::max(worst, result.exit_code);
  return worst;
}

}  // namespace meshlode::app
