// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <thread>
#include <vector>

namespace meshlode {
namespace {

TEST(Parallel, AllTurnsAreTakenByAnyNumberOfThreads) {
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena(threads).execute([&] {
      std::array<std::uint32_t, 3> sums{};
      const auto turn = [&](std::size_t which) {
        return [&sums, which] {
          std::vector<std::uint32_t> squares(20000);
          parallel_for_each_index(squares.size(), 64,
                                  [&](std::size_t i) { squares[i] = static_cast<std::uint32_t>((i + which) % 7); });
          for (const std::uint32_t square : squares) sums[which] += square;
        };
      };
      parallel_all(turn(0), turn(1), turn(2));
      for (std::size_t which = 0; which < 3; ++which) {
        std::uint32_t expected = 0;
        for (std::size_t i = 0; i < 20000; ++i) expected += static_cast<std::uint32_t>((i + which) % 7);
        EXPECT_EQ(sums[which], expected);
      }
    });
  }
}

TEST(Parallel, FewerThreadsAreAskedForAndNeverMore) {
  tbb::task_arena arena(4);
  arena.execute([] {
    EXPECT_EQ(with_threads_at_most(2, [] { return thread_limit(); }), 2U);
    EXPECT_EQ(with_threads_at_most(0, [] { return thread_limit(); }), 1U);
    EXPECT_EQ(with_threads_at_most(9, [] { return thread_limit(); }), 4U);
    EXPECT_EQ(thread_limit(), 4U);
  });
}

TEST(Parallel, ResizedArraysKeepWhatTheyHadAndAreClearedBehind) {
  std::vector<int> numbers{1, 2};
  std::vector<double> others;
  resize_all(100000, numbers, others);
  ASSERT_EQ(numbers.size(), 100000U);
  ASSERT_EQ(others.size(), 100000U);
  EXPECT_EQ(numbers[1], 2);
  EXPECT_EQ(numbers[2], 0);
  EXPECT_EQ(others.back(), 0.0);
  resize_all(1, numbers, others);
  EXPECT_EQ(numbers, std::vector<int>{1});
}

TEST(Parallel, ChunksCoverEverythingOnce) {
  for (const std::size_t count : {0U, 1U, 9U, 10U, 11U, 1000U}) {
    std::vector<std::uint8_t> seen(count, 0);
    std::vector<std::size_t> begin_of(chunk_count(count, 10), 0);
    parallel_for_each_chunk(count, 10, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      begin_of[chunk] = begin;
      for (std::size_t i = begin; i < end; ++i) ++seen[i];
    });
    EXPECT_EQ(seen, std::vector<std::uint8_t>(count, 1));
    for (std::size_t chunk = 0; chunk < begin_of.size(); ++chunk) EXPECT_EQ(begin_of[chunk], 10 * chunk);
  }
}

/// A turn that throws ends the loops within the other turns too. None of them may come back with its work half done.
TEST(Parallel, ALoopWithinOneThatEndedDoesNotReturnAsIfItWereWhole) {
  constexpr std::size_t kInner = 2000;
  tbb::task_arena(4).execute([&] {
    for (int round = 0; round < 20; ++round) {
      std::atomic<int> half_done = 0, is_begun = 0;
      const auto outer = [&](std::size_t turn) {
        if (turn == 0) {
          for (int i = 0; i < 1000 && is_begun == 0; ++i) std::this_thread::yield();
          throw std::bad_alloc();
        }
        std::vector<std::uint8_t> filled(kInner, 0);
        const auto fill = [&](std::size_t i) {
          is_begun = 1;
          for (int k = 0; k < 20; ++k) std::this_thread::yield();
          filled[i] = 1;
        };
        if (turn % 2 == 0) {
          parallel_for_each_index(kInner, 1, fill);
        } else {
          parallel_all([&] { parallel_for_each_index(kInner / 2, 1, fill); },
                       [&] { parallel_for_each_index(kInner / 2, 1, [&](std::size_t i) { fill(kInner / 2 + i); }); });
        }
        if (std::count(filled.begin(), filled.end(), 0) > 0) ++half_done;
      };
      EXPECT_THROW(parallel_for_each_index(8, 1, outer), std::bad_alloc);
      EXPECT_EQ(half_done, 0);
    }
  });
}

}  // namespace
}  // namespace meshlode
