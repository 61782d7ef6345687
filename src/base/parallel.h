// SPDX-License-Identifier: GPL-3.0-or-later
// The parallel rule of the project: count -> prefix sum -> write into a preassigned slot. Output never depends on which
// thread came first (I10), so only loops over indices are offered.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace meshlode {

/// Of a loop whose turns take some nanoseconds each: so many are worth a task.
constexpr std::size_t kLoopGrain = 4096;

/// How many threads the caller's arena has: for the length of runs that are done at a time, never for an output.
inline std::size_t thread_limit() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

/// Runs the body with so many threads at most, and returns what it does.
template <class Body>
auto with_threads_at_most(std::size_t count, const Body& body) {
  if (count >= thread_limit()) return body();
  tbb::task_arena arena(static_cast<int>(std::max<std::size_t>(1, count)));
  return arena.execute(body);
}

/// How many chunks of `length` cover `count`.
constexpr std::size_t chunk_count(std::size_t count, std::size_t length) {
  return (count + length - 1) / length;
}

/// Out of a loop that oneTBB cut short because a turn of a loop around it has thrown: what it was to fill is not
/// filled. Outside comes what was thrown first.
struct LoopCutShort : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "a loop around this one has ended"; }
};
inline void check_is_whole(tbb::task_group_context& context) {
  if (context.is_group_execution_cancelled()) throw LoopCutShort();
}

/// Calls body(i) for i in [0, count), in any order and thread; `body` may write only to what belongs to i.
template <class Body>
void parallel_for_each_index(std::size_t count, std::size_t grain, const Body& body) {
  tbb::task_group_context context;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
      },
      context);
  check_is_whole(context);
}

/// Calls body(chunk, begin, end) for the chunks of `length` that [0, count) falls into, side by side. What each finds
/// is the caller's to put together, in the order of chunks: they are the same for any thread count.
template <class Body>
void parallel_for_each_chunk(std::size_t count, std::size_t length, const Body& body) {
  parallel_for_each_index(chunk_count(count, length), 1, [&](std::size_t chunk) {
    body(chunk, chunk * length, std::min(count, (chunk + 1) * length));
  });
}

/// Calls all of them, side by side; none may write to what another sees. For few long turns, which may use these loops
/// themselves.
template <class... Turns>
void parallel_all(const Turns&... turns) {
  tbb::task_group_context context;
  tbb::parallel_invoke(turns..., context);
  check_is_whole(context);
}

/// Gives each array its size, side by side: memory is cleared, and new to the process, by whoever touches it first.
template <class... Arrays>
void resize_all(std::size_t size, Arrays&... arrays) {
  parallel_all([size, &arrays] { arrays.resize(size); }...);
}

/// Calls body(i) once for each i in [0, count), begun in order, at most `at_once` of them at a time. For few and long
/// turns that use these loops themselves: a thread that waits within one does not begin another.
template <class Body>
void parallel_for_each_in_order(std::size_t count, std::size_t at_once, const Body& body) {
  std::atomic<std::size_t> next = 0;
  parallel_for_each_index(std::min(count, at_once), 1, [&](std::size_t) {
    for (std::size_t i = next++; i < count; i = next++) {
      tbb::this_task_arena::isolate([&] { body(i); });
    }
  });
}

}  // namespace meshlode
