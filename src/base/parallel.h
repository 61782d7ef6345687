// SPDX-License-Identifier: GPL-3.0-or-later
// The parallel rule of the project: count -> prefix sum -> write into a preassigned slot. Output never depends on which
// thread came first (I10), so only loops over indices are offered.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace meshlode {

/// Of a loop whose turns take some nanoseconds each: so many are worth a task.
constexpr std::size_t kLoopGrain = 4096;

/// How many threads the caller's arena has: for the length of runs that are done at a time, never for an output.
inline std::size_t thread_limit() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

/// Calls body(i) for i in [0, count), in any order and thread; `body` may write only to what belongs to i.
template <class Body>
void parallel_for_each_index(std::size_t count, std::size_t grain, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

}  // namespace meshlode
