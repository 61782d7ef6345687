// SPDX-License-Identifier: GPL-3.0-or-later
// Can a trial fail? Programs that find, crash, hang, refuse or lie are each told from one that is well.
#include "trial.h"

#include <fstream>

#include <gtest/gtest.h>

namespace meshlode::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWell = R"(#!/bin/sh
case $1 in
  build) echo asset > "$4" ;;
  validate) echo '{"files": [{"findings": []}]}' ;;
  verify) echo '{"findings": [], "checks": [], "deviations": [
            {"stored": 0.5, "lower": 0.46, "verdict": "within"}, {"stored": 2, "lower": 2.0625, "verdict": "above"},
            {"stored": 0, "lower": 0, "verdict": "undecided"}, {"stored": 4, "lower": 4.125, "verdict": "above"}]}' ;;
esac
)";

class Trial : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  TrialResult try_program(const std::string& script) {
    const fs::path program = folder_ / "program.sh";
    std::ofstream(program) << script;
    fs::permissions(program, fs::perms::owner_all);
    TrialOptions options{.program = program, .folder = folder_, .build_options = {"--codec", "none"}};
    options.cpu_seconds = 1.0;
    options.samples = samples_;
    options.other_jobs_too = true;
    return try_scene({1, 2, 3}, options);
  }
  /// The program that is well, but for one verb.
  TrialResult try_with(const std::string& verb, const std::string& does) {
    return try_program("#!/bin/sh\nif [ $1 = " + verb + " ]; then\n" + does + "\nfi\n" + kWell);
  }

  fs::path folder_;
  std::optional<std::uint64_t> samples_;
};

TEST_F(Trial, AProgramThatIsWellIsClean) {
  const TrialResult result = try_program(kWell);
  EXPECT_TRUE(result.is_clean()) << result.detail;
  EXPECT_EQ(result.cuts, 4U);
  EXPECT_EQ(result.cuts_above, 2U);
  EXPECT_EQ(result.cuts_undecided, 1U);
  EXPECT_EQ(result.largest_ratio, 1.03125);
}

TEST_F(Trial, VerifyIsToldTheSamples) {
  const char* told =
      R"(case "$*" in *"--samples 77"*) echo '{"checks": [], "findings": []}' ;; *) exit 3 ;; esac; exit 0)";
  EXPECT_TRUE(try_with("verify", told).rules.contains("verify:exit 3"));
  samples_ = 77;
  EXPECT_TRUE(try_with("verify", told).is_clean());
}

TEST_F(Trial, FindingsOfTheJudgesCountByRule) {
  const char* validate = R"(echo '{"files": [{"findings": [{"id": "L507", "where": "a", "detail": "b"}]}]}'; exit 6)";
  EXPECT_TRUE(try_with("validate", validate).rules.contains("L507"));
  const TrialResult result =
      try_with("verify", R"(echo '{"checks": [], "findings": [{"id": "V101"}, {"id": "V101"}]}'; exit 6)");
  EXPECT_EQ(result.rules.at("V101"), 2U);
}

TEST_F(Trial, CrashesHangsAndStrangeExitsAreFindings) {
  EXPECT_TRUE(try_with("build", "kill -SEGV $$").rules.contains("build:signal 11"));
  EXPECT_TRUE(try_with("validate", "exec sleep 60").rules.contains("validate:time"));
  EXPECT_TRUE(try_with("verify", "while :; do :; done").rules.contains("verify:time"));
  EXPECT_TRUE(try_with("extract", "exit 2").rules.contains("extract:exit 2"));
  EXPECT_TRUE(try_with("build", "exit 1").rules.contains("build:exit 1"));
}

TEST_F(Trial, ASilentJudgeIsAFinding) {
  EXPECT_TRUE(
      try_with("validate", R"(echo '{"files": [{"findings": []}]}'; exit 6)").rules.contains("validate:silent"));
  EXPECT_TRUE(try_with("verify", R"(echo '{"findings": [], "checks": []}'; exit 6)").rules.contains("verify:silent"));
  EXPECT_TRUE(try_with("verify", "echo nothing; exit 0").rules.contains("verify:output"));
}

TEST_F(Trial, OtherBytesFromOtherThreadsAreAFinding) {
  EXPECT_TRUE(try_with("build", "echo $7 > \"$4\"; exit 0").rules.contains("build:jobs"));
}

TEST_F(Trial, ARefusalHasItsReasonWithoutNumbers) {
  const TrialResult result = try_with("build", "echo \"meshlode: $2: /meshes/0: 25.5e6 bits for 3\" >&2; exit 5");
  ASSERT_TRUE(result.refusal.has_value());
  EXPECT_EQ(*result.refusal, "exit 5: /meshes/#: # bits for #");
  EXPECT_TRUE(result.rules.empty());
  EXPECT_FALSE(result.is_clean());
}

}  // namespace
}  // namespace meshlode::test
