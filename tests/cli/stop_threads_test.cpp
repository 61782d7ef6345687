// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshlode/stop_threads.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

namespace meshlode::cli {
namespace {

using namespace std::chrono_literals;

/// Threads that count, each for itself, until this ends.
class Counters {
 public:
  Counters() {
    for (std::atomic<std::uint64_t>& count : counts_) {
      threads_.emplace_back([this, &count] {
        while (!is_over_.load()) count.fetch_add(1);
      });
    }
  }
  ~Counters() {
    is_over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  [[nodiscard]] std::array<std::uint64_t, 3> read() const {
    return {counts_[0].load(), counts_[1].load(), counts_[2].load()};
  }
  /// Until each has counted on.
  void wait_for_all() const {
    const auto before = read();
    for (bool all = false; !all; std::this_thread::sleep_for(1ms)) {
      const auto now = read();
      all = now[0] != before[0] && now[1] != before[1] && now[2] != before[2];
    }
  }

 private:
  std::array<std::atomic<std::uint64_t>, 3> counts_{};
  std::atomic<bool> is_over_ = false;
  std::vector<std::thread> threads_;
};

TEST(StoppedThreads, StandUntilTheStopIsOver) {
  const Counters counters;
  for (int round = 0; round < 20; ++round) {
    counters.wait_for_all();
    const StoppedThreads stopped;
    EXPECT_GE(stopped.count(), 3U);
    // Those that were not running have not come to the signal yet: they do so before anything else.
    std::array<std::uint64_t, 3> before{}, after{};
    for (int look = 0; look < 200; ++look) {
      before = counters.read();
      std::this_thread::sleep_for(1ms);
      after = counters.read();
      if (before == after) break;
    }
    EXPECT_EQ(before, after);
  }
  counters.wait_for_all();
}

TEST(StoppedThreads, WhatASystemCallWaitsForComesAfterwards) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::pipe(ends), 0);
  ssize_t length = -1;
  char letter = ' ';
  std::thread reader([&] { length = ::read(ends[0], &letter, 1); });
  for (int round = 0; round < 20; ++round) {
    const StoppedThreads stopped;
    std::this_thread::sleep_for(1ms);
  }
  ASSERT_EQ(::write(ends[1], "x", 1), 1);
  reader.join();
  EXPECT_EQ(length, 1) << "nothing was interrupted";
  EXPECT_EQ(letter, 'x');
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace meshlode::cli
