// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with an asset that was built all the same: never silent, and refused where the batch is strict.
#pragma once

#include <vector>

#include "app/batch/jobs/job_result.h"

namespace meshlode::app {

/// Of a job that has come as far as to know its facts. The worst first.
[[nodiscard]] std::vector<JobWarning> list_warnings(const JobFacts& facts);

}  // namespace meshlode::app
