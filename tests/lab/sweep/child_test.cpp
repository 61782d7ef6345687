// SPDX-License-Identifier: GPL-3.0-or-later
// What a child process took is its own.
#include "lab/child/child.h"

#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

namespace meshlode::lab {
namespace {

Result<ChildRun> shell(const std::string& command) {
  const std::vector<std::string> arguments{"-c", command};
  return run_child("/bin/sh", arguments);
}

TEST(SweepChild, TellsHowItEnded) {
  EXPECT_EQ(shell("exit 0")->exit_code, 0);
  EXPECT_EQ(shell("exit 6")->exit_code, 6);
  EXPECT_EQ(shell("kill -TERM $$")->exit_code, 128 + SIGTERM);
  EXPECT_EQ(shell("echo no > /dev/stderr; echo unseen; exit 3")->errors, "no\n");
  EXPECT_EQ(run_child("/nowhere/to/be/found", {})->exit_code, 127);
}

TEST(SweepChild, KeepsTheEndOfALongText) {
  const auto run = shell("i=0; while [ $i -lt 3000 ]; do echo line $i >&2; i=$((i+1)); done");
  ASSERT_TRUE(run);
  EXPECT_LE(run->errors.size(), 4096U);
  EXPECT_TRUE(run->errors.ends_with("line 2999\n"));
}

TEST(SweepChild, CountsItsOwnTime) {
  const auto idle = shell("sleep 0.2"), busy = shell("i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done");
  ASSERT_TRUE(idle && busy);
  EXPECT_GE(idle->wall_seconds, 0.2);
  EXPECT_LT(idle->user_seconds, 0.1);
  EXPECT_GT(busy->user_seconds, 0.0);
  EXPECT_LE(busy->user_seconds, busy->wall_seconds + 0.05);
}

/// What this process has in memory when it starts another is no part of the other's.
TEST(SweepChild, PeakMemoryIsNotThatOfWhoStartedIt) {
  const std::vector<char> ballast(std::size_t{256} << 20U, 'x');
  const auto run = run_child("/bin/sleep", std::vector<std::string>{"0.2"});
  ASSERT_TRUE(run);
  EXPECT_GT(run->peak_bytes, 0U);
  EXPECT_LT(run->peak_bytes, std::uint64_t{64} << 20U);
  EXPECT_EQ(ballast[ballast.size() / 2], 'x');
}

}  // namespace
}  // namespace meshlode::lab
