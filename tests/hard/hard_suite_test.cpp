// SPDX-License-Identifier: GPL-3.0-or-later
// The suite's own parts: laws that find what is broken, a sweep that finds where a verdict changes, processes that
// fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lab/samples/samples.h"
#include "laws/law.h"
#include "laws/same_mesh.h"
#include "run/child.h"
#include "run/sweep.h"
#include "support/reseal.h"
#include "table/table.h"

namespace meshlode::test::hard {
namespace {

Built built(scene::Primitive shape) {
  Sample sample = sample_of(std::move(shape));
  sample.options.codec = format::Codec::kNone;  // tests change tables where they lie
  Result<Built> result = build_sample(sample);
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
  const Built a = built(lab::make_rock(10)), again = built(lab::make_rock(10)), other = built(lab::make_rock(10, 8));
  EXPECT_EQ(compare_meshes(*a.asset, MeshId(0U), *again.asset, MeshId(0U)).difference, "");
  EXPECT_NE(compare_meshes(*a.asset, MeshId(0U), *other.asset, MeshId(0U)).difference, "");
  Change change;
  change.log2 = 1;
  EXPECT_NE(compare_meshes(*a.asset, MeshId(0U), *again.asset, MeshId(0U), change).difference, "");
}

TEST(HardSuite, ALawFindsAnAssetOfAnotherSource) {
  Built wrong = built(lab::make_rock(10));
  scene::Primitive& shape = wrong.sample.scene.meshes[0].primitives[0];
  for (Vec3d& p : shape.positions) p.x *= 1.01;  // the sample says another source than was built
  EXPECT_EQ(check_invariants(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_renumbered(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_reordered(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_unused_vertex(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_doubled(wrong).verdict, Verdict::kFails);
  EXPECT_EQ(check_company(wrong).verdict, Verdict::kFails);
}

/// A mesh of levels, closed, with coordinates that are 0.
Built closed_with_zeros() {
  scene::Primitive shape = lab::make_rock(10);
  for (Vec3d& p : shape.positions) {
    if (p.x == shape.positions[0].x && p.y == shape.positions[0].y) p.z = 0.0;
  }
  return built(std::move(shape));
}

/// The asset after a change of one section's records, with its checksums made true again.
template <class Record>
void change_records(Built& base, format::SectionId section, std::size_t count, const auto& change) {
  for (std::size_t i = 0; i < count; ++i) {
    Record record;
    std::uint8_t* at = base.bytes.data() + test::section_offset(base.bytes, section) + i * sizeof(Record);
    std::memcpy(&record, at, sizeof(Record));
    change(record);
    std::memcpy(at, &record, sizeof(Record));
  }
  test::reseal(base.bytes);
  Result<run::Asset> asset = run::Asset::from_bytes(base.bytes);
  ASSERT_TRUE(asset) << asset.error().message();
  base.asset = std::move(*asset);
}

/// The asset has a triangle that the source lacks: what must be the same bytes, floats or triangles is not.
TEST(HardSuite, EveryLawOfEqualityFindsATriangleTooMany) {
  Built wrong = closed_with_zeros();
  auto& indices = wrong.sample.scene.meshes[0].primitives[0].indices;
  indices.resize(indices.size() - 3);
  for (const auto check :
       {check_invariants, check_renumbered, check_reordered, check_turned_corners, check_unused_vertex,
        check_negative_zeros, check_doubled, check_quarter_turn, check_mirrored, check_company}) {
    const LawResult result = check(wrong);
    const auto law = std::find_if(laws().begin(), laws().end(), [&](const Law& one) { return one.check == check; });
    EXPECT_EQ(result.verdict, Verdict::kFails) << law->name << ": " << result.detail;
  }
}

/// Translation and the factor 3 compare two builds: what they compare with finds a shift and a factor that were not.
TEST(HardSuite, ShiftsAndFactorsAreCompared) {
  const Built a = built(lab::make_rock(10));
  const auto difference = [&](const Change& change) {
    return compare_meshes(*a.asset, MeshId(0U), *a.asset, MeshId(0U), change).difference;
  };
  EXPECT_EQ(difference({}), "");
  const format::Grid grid = a.asset->meshes()[0].grid;
  Change change;
  change.shift = Vec3d(0.0, std::ldexp(grid.mantissa, grid.log2), 0.0);
  EXPECT_NE(difference(change), "");
  change = {};
  change.factor = 3.0;
  EXPECT_NE(difference(change), "");
  change.factor = 1.0;
  EXPECT_EQ(difference(change), "");
}

TEST(HardSuite, ACutThatIsOpenIsFound) {
  Built wrong = built(lab::make_rock(20));
  ASSERT_EQ(check_closed_cuts(wrong).verdict, Verdict::kHolds);
  const auto is_fine = [](const format::GroupRecord& group) {
    return group.level == 0 && group.error < format::kInfiniteError;
  };
  const auto groups = wrong.asset->groups();
  ASSERT_GE(std::count_if(groups.begin(), groups.end(), is_fine), 2);
  // A group of level 0 stays when all around it has been replaced.
  bool is_done = false;
  change_records<format::GroupRecord>(wrong, format::SectionId::kGroups, groups.size(), [&](auto& group) {
    if (!is_done && is_fine(group)) group.error = 1e20F;
    is_done |= is_fine(group);
  });
  EXPECT_EQ(check_closed_cuts(wrong).verdict, Verdict::kFails);
}

TEST(HardSuite, AHierarchyThatHidesAGroupIsFound) {
  Sample sample = sample_of(lab::make_rock(10));
  sample.options.codec = format::Codec::kNone;
  HardView view;
  view.camera.eye = Vec3d(0.0, 0.0, 3.0);
  view.camera.target = Vec3d(0.0);
  sample.views.push_back(view);
  Result<Built> result = build_sample(std::move(sample));
  ASSERT_TRUE(result.ok());
  Built wrong = std::move(*result);
  ASSERT_EQ(check_views(wrong).verdict, Verdict::kHolds);
  change_records<format::NodeRecord>(wrong, format::SectionId::kNodes, wrong.asset->nodes().size(),
                                     [](format::NodeRecord& node) { node.error = 0.0F; });
  EXPECT_EQ(check_views(wrong).verdict, Verdict::kFails);
}

/// Squares of its distances vanish from doubles; the judge's own may not.
TEST(HardSuite, ATinyInstanceIsJudgedByItsDistances) {
  Sample sample = sample_of(lab::make_rock(10));
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

TEST(HardSuite, ACaseThatHoldsLessThanThePageSaysIsFound) {
  const HardCase fake{.room = "-", .name = "fake", .parameter = "-", .sweep = {1.0, 100.0}};
  Verdict at_easy = Verdict::kHolds, beyond = Verdict::kHolds;
  const Ask ask = [&](double parameter, bool all_laws) {
    Trial trial = with_verdict(parameter == 1.0 ? at_easy : beyond);
    if (all_laws && at_easy == Verdict::kHolds) trial.laws[0].verdict = trial.laws[1].verdict = Verdict::kHolds;
    return trial;
  };
  const auto sweep = [&] { return sweep_case(fake, ask, {.steps = 1}, false); };
  const Swept sound = sweep();
  const std::string page = table_of({&sound, 1});
  EXPECT_EQ(difference_from_page(sound, page, true), "");
  beyond = Verdict::kRefused;
  EXPECT_FALSE(has_failed(sweep()));
  EXPECT_EQ(difference_from_page(sweep(), page, true), "holds to 1, the page says to the end");
  EXPECT_EQ(difference_from_page(sweep(), page, false), "");
  at_easy = Verdict::kRefused;
  EXPECT_FALSE(has_failed(sweep()));
  EXPECT_EQ(difference_from_page(sweep(), page, false), "0 of 0 laws hold, the page says 2 of 2");
  EXPECT_NE(difference_from_page(sound, "", false), "");
}

/// doctor links to its rows.
TEST(HardSuite, ThePageHasARowForEveryCaseAndNoOther) {
  std::ifstream in(MESHLODE_SOURCE_DIR "/docs/reference/hard-cases.md", std::ios::binary);
  const std::string page(std::istreambuf_iterator<char>(in), {});
  std::vector<std::string> rows, names;
  constexpr std::string_view kAnchor = "<a id=\"";
  for (std::size_t at = page.find(kAnchor); at != std::string::npos; at = page.find(kAnchor, at + 1)) {
    const std::size_t begin = at + kAnchor.size();
    rows.push_back(page.substr(begin, page.find('"', begin) - begin));
  }
  for (const HardCase& one : hard_cases()) names.emplace_back(one.name);
  EXPECT_EQ(rows, names);
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
