// SPDX-License-Identifier: GPL-3.0-or-later
// The parallel rule of the project: count -> prefix sum -> write into a preassigned slot. Output never depends on which
// thread came first (I10), so only loops over indices are offered.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

namespace meshlode {

/// Of a loop whose turns take some nanoseconds each: so many are worth a task.
constexpr std::size_t kLoopGrain = 4096;

/// How many threads the caller's arena has: for the length of runs that are done at a time, never for an output.
std::size_t thread_limit();

/// What parallel.cpp does without knowing the loops: a body is an address, called from task to task and not from turn
/// to turn. oneTBB's headers take a second to compile, in every file that has a loop.
namespace threads {
using Call = void (*)(const void* body);
using CallOfRange = void (*)(const void* body, std::size_t begin, std::size_t end);
void run_ranges(std::size_t count, std::size_t grain, CallOfRange call, const void* body);
void run_in_arena(std::size_t thread_count, Call call, const void* body);
void run_isolated(Call call, const void* body);

template <class Body>
void call(const void* body) {
  (*static_cast<const Body*>(body))();
}
}  // namespace threads

/// Runs the body with so many threads at most, and returns what it does.
template <class Body>
auto with_threads_at_most(std::size_t count, const Body& body) {
  using Result = decltype(body());
  if (count >= thread_limit()) return body();
  if constexpr (std::is_void_v<Result>) {
    threads::run_in_arena(count, threads::call<Body>, std::addressof(body));
  } else {
    std::optional<Result> result;
    const auto fill = [&] { result.emplace(body()); };
    threads::run_in_arena(count, threads::call<decltype(fill)>, std::addressof(fill));
    return std::move(*result);
  }
}

/// How many chunks of `length` cover `count`.
constexpr std::size_t chunk_count(std::size_t count, std::size_t length) {
  return (count + length - 1) / length;
}

/// Calls body(i) for i in [0, count), in any order and thread; `body` may write only to what belongs to i.
template <class Body>
void parallel_for_each_index(std::size_t count, std::size_t grain, const Body& body) {
  const auto call = [](const void* address, std::size_t begin, std::size_t end) {
    const Body& turn = *static_cast<const Body*>(address);
    for (std::size_t i = begin; i != end; ++i) turn(i);
  };
  threads::run_ranges(count, grain, call, std::addressof(body));
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
  struct Turn {
    threads::Call call;
    const void* body;
  };
  const Turn all[] = {{threads::call<Turns>, std::addressof(turns)}...};
  parallel_for_each_index(sizeof...(turns), 1, [&](std::size_t i) { all[i].call(all[i].body); });
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
      const auto turn = [&body, i] { body(i); };
      threads::run_isolated(threads::call<decltype(turn)>, std::addressof(turn));
    }
  });
}

}  // namespace meshlode
