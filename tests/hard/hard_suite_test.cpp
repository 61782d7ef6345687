// SPDX-License-Identifier: GPL-3.0-or-later
// The suite's own parts: laws that find what is broken, a sweep that finds where a verdict changes, processes that
// fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "laws/law.h"
#include "laws/same_mesh.h"
#include "run/child.h"
#include "run/sweep.h"
#include "scene/samples/samples.h"
#include "table/table.h"

namespace meshlode::test::hard {
namespace {

Built built(scene::Primitive shape) {
  Result<Built> result = build_sample(sample_of(std::move(shape)));
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message());
  return std::move(*result);
}

Trial with_verdict(Verdict verdict) {
  Trial trial;
  trial.verdict = verdict;
  trial.laws.resize(laws().size());
  return trial;
}

TEST(HardSuite, EqualMeshesCompareEqualAndOthersDoNot) {
  const Built a = built(scene::make_rock(10)), again = built(scene::make_rock(10)),
              other = built(scene::make_rock(10, 8));
  EXPECT_EQ(compare_meshes(*a.asset, MeshId(0U), *again.asset, MeshId(0U)).difference, "");
  EXPECT_NE(compare_meshes(*a.asset, MeshId(0U), *other.asset, MeshId(0U)).difference, "");
  Change change;
  change.log2 = 1;
  EXPECT_NE(compare_meshes(*a.asset, MeshId(0U), *again.asset, MeshId(0U), change).difference, "");
}

TEST(HardSuite, ALawFindsAnAssetOfAnotherSource) {
  Built wrong = built(scene::make_rock(10));
  scene::Primitive& shape = wrong.sample.scene.meshes[0].primitives[0];
  for (Vec3d& p : shape.positions) p.x *= 1.01;  // the sample says another source than was built
  EXPECT_EQ(check_invariants(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_renumbered(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_reordered(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_unused_vertex(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_doubled(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_company(wrong).verdict, Verdict::kFails);
}

/// Squares of its distances vanish from doubles; the judge's own may not.
TEST(HardSuite, ATinyInstanceIsJudgedByItsDistances) {
  Sample sample = sample_of(scene::make_rock(10));
  for (int axis = 0; axis < 3; ++axis) sample.scene.instances[0].transform[axis] *= 1e-200;
  const Result<Built> tiny = build_sample(std::move(sample));
  ASSERT_TRUE(tiny.ok());
  const LawResult result = check_invariants(*tiny);
  EXPECT_EQ(result.verdict, Verdict::kHolds) << result.detail;
}

TEST(HardSuite, ASweepEndsWhereTheVerdictChanges) {
  HardCase fake{.room = "-", .name = "fake", .parameter = "-", .sweep = {1.0, 100.0, 1e6}};
  const Ask ask = [](double parameter, bool) {
    return with_verdict(parameter < 321.0 ? Verdict::kHolds : parameter < 4000.0 ? Verdict::kBound : Verdict::kRefused);
  };
  const Swept swept = sweep_case(fake, ask, {.steps = 20}, false);
  ASSERT_EQ(swept.stretches.size(), 3U);
  EXPECT_NEAR(swept.stretches[0].to, 321.0, 1.0);
  EXPECT_EQ(swept.stretches[1].verdict, Verdict::kBound);
  EXPECT_NEAR(swept.stretches[2].from, 4000.0, 10.0);
  EXPECT_FALSE(has_failed(swept));
  EXPECT_NE(table_of({&swept, 1}).find("`fake` | - | to 321 |"), std::string::npos) << table_of({&swept, 1});
}

TEST(HardSuite, CountsAreBisectedToTheCount) {
  HardCase fake{.room = "-", .name = "fake", .parameter = "-", .sweep = {1, 1000}, .is_whole = true};
  const Ask ask = [](double n, bool) { return with_verdict(n <= 127.0 ? Verdict::kHolds : Verdict::kFails); };
  const Swept swept = sweep_case(fake, ask, {.steps = 30}, false);
  ASSERT_EQ(swept.stretches.size(), 2U);
  EXPECT_EQ(swept.stretches[0].to, 127.0);
  EXPECT_EQ(swept.stretches[1].from, 128.0);
  EXPECT_TRUE(has_failed(swept));
}

TEST(HardSuite, BetweenIsBetween) {
  EXPECT_DOUBLE_EQ(between(1.0, 100.0, false), 10.0);
  EXPECT_DOUBLE_EQ(between(1e-300, 1e300, false), 1.0);
  EXPECT_DOUBLE_EQ(between(1.0, 0.0, false), 0.5);
  EXPECT_EQ(between(5.0, 6.0, true), 6.0);  // nothing lies between
  EXPECT_EQ(between(127.0, 129.0, true), 128.0);
  EXPECT_EQ(between(129.0, 127.0, true), 128.0);
  EXPECT_EQ(between(1.0, HUGE_VAL, false), 1.0);
}

TEST(HardSuite, ATrialIsReadAsItWasPrinted) {
  Trial trial = with_verdict(Verdict::kBound);
  trial.detail = "a\tb\nc";
  trial.laws[3] = {Verdict::kFails, "why", 0.75};
  Trial read;
  ASSERT_TRUE(parse_trial(text_of(trial), read));
  EXPECT_EQ(read.verdict, Verdict::kBound);
  EXPECT_EQ(read.detail, "a b c");
  EXPECT_EQ(read.laws[3].verdict, Verdict::kFails);
  EXPECT_EQ(read.laws[3].share, 0.75);
  const std::string text = text_of(trial);
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '\n') {
      EXPECT_FALSE(parse_trial(text.substr(0, i + 1), read)) << i;
    }
  }
  EXPECT_FALSE(parse_trial("9\t14\t\n", read));
}

TEST(HardSuite, AChildThatFailsIsSeenToFail) {
  ChildLimits limits;
  limits.memory_bytes = 0;
  EXPECT_EQ(run_child("/bin/sh", {"-c", "echo said; exit 7"}, limits).exit_code, 7);
  EXPECT_EQ(run_child("/bin/sh", {"-c", "echo said; exit 7"}, limits).out, "said\n");
  EXPECT_EQ(run_child("/bin/sh", {"-c", "kill -SEGV $$"}, limits).signal, 11);
  limits.wall_seconds = 0.2;
  const ChildResult slow = run_child("/bin/sh", {"-c", "exec sleep 20"}, limits);
  EXPECT_TRUE(slow.timed_out);
  EXPECT_EQ(slow.exit_code, -1);
}

TEST(HardSuite, CasesHaveNamesOfTheirOwnAndSomethingToSweep) {
  std::vector<std::string> names;
  for (const HardCase& one : hard_cases()) {
    EXPECT_FALSE(one.sweep.empty()) << one.name;
    EXPECT_EQ(std::count(names.begin(), names.end(), one.name), 0) << one.name;
    names.emplace_back(one.name);
  }
  EXPECT_GT(names.size(), 40U);
}

}  // namespace
}  // namespace meshlode::test::hard
