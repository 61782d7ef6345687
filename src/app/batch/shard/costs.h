// SPDX-License-Identifier: GPL-3.0-or-later
// Weights of jobs by what they cost the last time, so that shards take about equally long.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "app/batch/jobs/job_result.h"
#include "app/batch/jobs/jobs.h"

namespace meshlode::app {

/// The results of a whole batch that is done. Errors: those of read_manifest; kInvalid it is one shard's, or the batch
/// is still at work: either may change before the last shard has read it, and shards that differ in it overlap.
[[nodiscard]] Result<std::vector<JobResult>> read_costs(const std::filesystem::path& manifest);

/// Whether `last` has one of these inputs, by its path: without any it is most likely another batch's.
[[nodiscard]] bool knows_any(const std::vector<JobResult>& last, const std::vector<Job>& jobs);

/// Processor time, in microseconds, of the jobs that `last` built, by their inputs. The others, which are new, came
/// from a cache or failed, weigh what their bytes take at the rate of those. Bytes themselves where `last` built none.
/// \pre as many bytes as jobs
[[nodiscard]] std::vector<std::uint64_t> weigh_by_costs(const std::vector<Job>& jobs,
                                                        std::span<const std::uint64_t> bytes,
                                                        const std::vector<JobResult>& last);

}  // namespace meshlode::app
