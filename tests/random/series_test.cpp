// SPDX-License-Identifier: GPL-3.0-or-later
// Does a series end, and does it tell well from not? Programs that are well, find or refuse stand for the real one.
#include "series.h"

#include <chrono>
#include <fstream>

#include <gtest/gtest.h>

#include "tally.h"

namespace meshlode::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCleanProgram = R"(#!/bin/sh
case $1 in
  build) echo asset > "$4" ;;
  validate) echo '{"files": [{"findings": []}]}' ;;
  verify) echo '{"findings": [], "checks": []}' ;;
esac
)";

class SeriesOfTrials : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder_ / "kept");
    arguments_.program = folder_ / "program.sh";
    arguments_.jobs = 2;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void set_program(const std::string& script) {
    std::ofstream(arguments_.program) << script;
    fs::permissions(arguments_.program, fs::perms::owner_all);
  }

  fs::path folder_;
  Arguments arguments_;
};

TEST_F(SeriesOfTrials, ASoakEndsByTheClock) {
  set_program(kCleanProgram);
  const auto begin = std::chrono::steady_clock::now();
  testing::internal::CaptureStdout();
  const int code = soak(arguments_, 5, 0.02);
  const std::string said = testing::internal::GetCapturedStdout();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(code, 0) << said;
  EXPECT_GE(seconds, 1.2);
  EXPECT_NE(said.find("seeds 5 to "), std::string::npos) << said;
  EXPECT_EQ(said.find(": 0 clean"), std::string::npos) << said;
  EXPECT_NE(said.find(" 0 failed"), std::string::npos) << said;
}

TEST_F(SeriesOfTrials, WhatFailsIsShrunkAndKept) {
  set_program("#!/bin/sh\n[ $1 = build ] && kill -SEGV $$\n" + std::string(kCleanProgram));
  arguments_.shrink_into = folder_ / "kept";
  arguments_.shrink_seconds = 1.0;
  testing::internal::CaptureStdout();
  const int code = run_seeds(arguments_, {1});
  const std::string said = testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, 6) << said;
  EXPECT_TRUE(fs::exists(folder_ / "kept" / "seed-1-build-signal-11.glb")) << said;
  EXPECT_LT(fs::file_size(folder_ / "kept" / "seed-1-build-signal-11.glb"), write_glb(random_scene(1)).size());
}

TEST_F(SeriesOfTrials, SurgeryMakesOtherScenes) {
  set_program(kCleanProgram);
  arguments_.verbose = true;
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_seeds(arguments_, {1}), 0);
  const std::string damaged = testing::internal::GetCapturedStdout();
  arguments_.harm = Harm::kSurgery;
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_seeds(arguments_, {1}), 0);
  const std::string operated = testing::internal::GetCapturedStdout();
  EXPECT_NE(operated.find(random_scene(1, Harm::kSurgery).contents), std::string::npos) << operated;
  EXPECT_EQ(damaged.find(random_scene(1, Harm::kSurgery).contents), std::string::npos) << damaged;
}

Entry entry_of(const TrialResult& result) {
  Entry entry;
  entry.name = "seed 1";
  entry.triangles = 2000;
  entry.result = result;
  return entry;
}

TEST(Tally, OneFailureIsAVerdict) {
  Tally tally;
  for (int i = 0; i < 99; ++i) tally.add(entry_of({}));
  EXPECT_EQ(verdict(tally, 0), 0);
  TrialResult failed;
  failed.rules["L507"] = 2;
  tally.add(entry_of(failed));
  EXPECT_EQ(verdict(tally, 0), 6);
  EXPECT_EQ(tally.clean, 99U);
  EXPECT_EQ(tally.failed, 1U);
}

TEST(Tally, RefusalsHaveAShare) {
  Tally tally;
  for (int i = 0; i < 9; ++i) tally.add(entry_of({}));
  TrialResult refused;
  refused.refusal = "exit 5";
  tally.add(entry_of(refused));
  EXPECT_EQ(verdict(tally, 10), 0);
  EXPECT_EQ(verdict(tally, 9), 6);
}

TEST(Tally, OneCutInAHundredMayDeviateMore) {
  Tally tally;
  TrialResult measured;
  measured.cuts = 1000;
  measured.cuts_above = 10;
  measured.largest_ratio = 1.01;
  tally.add(entry_of(measured));
  EXPECT_EQ(verdict(tally, 0), 0);
  measured.cuts = 0;
  measured.cuts_above = 1;
  tally.add(entry_of(measured));
  EXPECT_EQ(verdict(tally, 0), 6);
}

TEST(Tally, TheSlowestIsOfThoseThatAreLarge) {
  Tally tally;
  Entry small = entry_of({});
  small.triangles = 999;
  small.result.build_seconds = 100.0;
  tally.add(small);
  Entry large = entry_of({});
  large.name = "seed 2";
  large.result.build_seconds = 1.0;
  tally.add(large);
  EXPECT_EQ(tally.slowest, "seed 2");
  EXPECT_DOUBLE_EQ(tally.slowest_rate, 5.0);
}

}  // namespace
}  // namespace meshlode::test
