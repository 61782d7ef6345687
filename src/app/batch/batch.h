// SPDX-License-Identifier: GPL-3.0-or-later
// Many scenes become assets, one after another on all threads: the page to read first of this floor.
#pragma once

#include <vector>

#include "app/batch/jobs/job_result.h"
#include "app/batch/jobs/jobs.h"
#include "app/batch/work/job_options.h"
#include "base/output_files.h"

namespace meshlode::app {

/// One result a job, in the order of jobs. `files` knows the outputs and what was read: what the scenes are made of is
/// kept from being written over. A job's failure is in its result, and does not stop the others but where asked to.
[[nodiscard]] std::vector<JobResult> run_batch(const std::vector<Job>& jobs, const BatchOptions& options,
                                               OutputFiles& files, const BatchWatcher& watcher);

/// The worst exit code, 0 for none.
[[nodiscard]] int worst_exit_code(const std::vector<JobResult>& results);

}  // namespace meshlode::app
