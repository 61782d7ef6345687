// SPDX-License-Identifier: GPL-3.0-or-later
// One scene of a batch: found unchanged, taken from the cache, or imported, built and written.
#pragma once

#include "app/batch/jobs/job_result.h"
#include "app/batch/jobs/jobs.h"
#include "app/batch/work/job_options.h"
#include "base/output_files.h"

namespace meshlode::app {

/// `error`: why the job failed, where its result says that it did.
[[nodiscard]] JobResult run_job(const Job& job, const BatchOptions& options, OutputFiles& files,
                                const BatchWatcher& watcher, Error& error);

}  // namespace meshlode::app
