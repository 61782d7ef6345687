// SPDX-License-Identifier: GPL-3.0-or-later
// oneTBB's thread limit, seen by this file alone.
#include <algorithm>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>

#include "options.h"

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kMaxJobs = 256;  ///< threads beyond that only cost memory

}  // namespace

struct JobLimit::State {
  explicit State(std::uint32_t jobs)
      : control(tbb::global_control::max_allowed_parallelism, jobs), arena(static_cast<int>(jobs)) {}
  tbb::global_control control;
  tbb::task_arena arena;
};

JobLimit::JobLimit(std::uint32_t jobs)
    : state_(jobs == 0 ? nullptr : std::make_unique<State>(std::min(jobs, kMaxJobs))) {}
JobLimit::~JobLimit() = default;

void JobLimit::run(const std::function<void()>& work) {
  if (!state_) return work();
  state_->arena.execute(work);
}

std::string onetbb_version() {
  return TBB_runtime_version();
}

}  // namespace meshlode::cli
