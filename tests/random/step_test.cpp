// SPDX-License-Identifier: GPL-3.0-or-later
// A step is told apart by how it ends, whether the program is started for it or has been started before.
#include "step.h"

#include <filesystem>
#include <functional>

#include <gtest/gtest.h>

namespace meshlode::test {
namespace {

namespace fs = std::filesystem;

class Step : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    for (char& c : name) c = c == '/' ? '-' : c;
    folder_ = fs::path(testing::TempDir()) / ("Step-" + name);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  StepResult run(const std::string& script) {
    const std::vector<std::string> arguments{"/bin/sh", "-c", script, "name", "one word", ""};
    const StepOutput output{folder_ / "stdout", folder_ / "stderr"};
    return GetParam() ? started_.run(arguments, output, 1.0) : run_process(arguments, output, 1.0);
  }

  fs::path folder_;
  StartedProgram started_{"/bin/sh", MESHLODE_STARTED};
};

TEST_P(Step, ItsWordsAndOutputsAreItsOwn) {
  for (int round = 0; round < 3; ++round) {
    const StepResult result = run("echo \"$# $1\"; echo err >&2; exit " + std::to_string(round));
    EXPECT_EQ(result.exit_code, round);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.out, "2 one word\n");
    EXPECT_EQ(result.err, "err\n");
    EXPECT_FALSE(result.timed_out);
  }
}

TEST_P(Step, WhatItChangesIsGoneWithIt) {
  EXPECT_EQ(run("cd /; x=1; export x; ulimit -n 20; exec 1>&-").exit_code, 0);
  EXPECT_EQ(run("echo \"[$x]$LD_PRELOAD\"").out, "[]\n");
}

TEST_P(Step, CrashesAndHangsEnd) {
  const StepResult crash = run("kill -SEGV $$");
  EXPECT_EQ(crash.exit_code, -1);
  EXPECT_EQ(crash.signal, 11);
  EXPECT_FALSE(crash.timed_out);
  EXPECT_TRUE(run("exec sleep 60").timed_out);
  const StepResult busy = run("while :; do :; done");
  EXPECT_TRUE(busy.timed_out);
  EXPECT_GE(busy.cpu_seconds, 0.9);
  EXPECT_EQ(run("echo well").out, "well\n") << "and the next is as before";
}

INSTANTIATE_TEST_SUITE_P(EachWay, Step, testing::Values(false, true),
                         [](const auto& kind) { return kind.param ? "Forked" : "Started"; });

TEST(StartedProgramTest, AProgramThatIsNotThereIsAnExit) {
  const fs::path folder = fs::path(testing::TempDir()) / "AProgramThatIsNotThere";
  fs::create_directories(folder);
  StartedProgram gone(folder / "nothing", MESHLODE_STARTED);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(gone.run({"nothing"}, {folder / "stdout", folder / "stderr"}, 1.0).exit_code, 127);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace meshlode::test
