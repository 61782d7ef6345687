// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <cstddef>
#include <exception>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace meshlode {
namespace {

/// Out of a loop that oneTBB cut short because a turn of a loop around it has thrown: what it was to fill is not
/// filled. Outside comes what was thrown first.
struct LoopCutShort : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "a loop around this one has ended"; }
};

}  // namespace

std::size_t thread_limit() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

namespace threads {

void run_ranges(std::size_t count, std::size_t grain, CallOfRange call, const void* body) {
  tbb::task_group_context context;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [=](const tbb::blocked_range<std::size_t>& range) { call(body, range.begin(), range.end()); }, context);
  if (context.is_group_execution_cancelled()) throw LoopCutShort();
}

void run_in_arena(std::size_t thread_count, Call call, const void* body) {
  tbb::task_arena arena(static_cast<int>(std::max<std::size_t>(1, thread_count)));
  arena.execute([=] { call(body); });
}

void run_isolated(Call call, const void* body) {
  tbb::this_task_arena::isolate([=] { call(body); });
}

}  // namespace threads
}  // namespace meshlode
