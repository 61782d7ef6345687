// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cstdint>
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

}  // namespace
}  // namespace meshlode
