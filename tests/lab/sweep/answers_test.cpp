// SPDX-License-Identifier: GPL-3.0-or-later
// Answers claim nothing inside the spread.
#include "lab/sweep/answers.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace meshlode::lab {
namespace {

Figures figures(double user_low, double user_high, double bytes, double deviation, double triangles) {
  Figures out;
  out["build_user_seconds"] = {0.5 * (user_low + user_high), user_low, user_high, 3};
  out["file_bytes"] = figure_of({bytes});
  out["deviation"] = figure_of({deviation});
  out["triangles_at_max"] = figure_of({triangles});
  return out;
}

std::vector<Candidate> candidates_of(const std::vector<Figures>& all) {
  std::vector<Candidate> out;
  for (const Figures& one : all) out.push_back({&one, out.size(), std::to_string(out.size()), false});
  return out;
}

TEST(SweepFigures, MedianAndRange) {
  const Figure odd = figure_of({3.0, 1.0, 2.0}), even = figure_of({4.0, 1.0, 2.0, 8.0});
  EXPECT_EQ(odd.value, 2.0);
  EXPECT_EQ(odd.min, 1.0);
  EXPECT_EQ(odd.max, 3.0);
  EXPECT_EQ(odd.count, 3U);
  EXPECT_EQ(even.value, 3.0);
}

TEST(SweepAnswers, DominatedIsWhoIsClearlyWorseInOneAndBetterInNone) {
  const std::vector<Figures> all{figures(1.0, 1.1, 100, 1e-4, 50), figures(2.0, 2.1, 100, 1e-4, 50),
                                 figures(1.05, 1.2, 100, 1e-4, 50), figures(2.0, 2.1, 90, 1e-4, 50)};
  const auto dominated = find_dominators(candidates_of(all));
  EXPECT_TRUE(dominated[0].empty());
  EXPECT_EQ(dominated[1], (std::vector<std::size_t>{0, 2, 3})) << "slower, or larger";
  EXPECT_TRUE(dominated[2].empty()) << "its range touches that of the first";
  EXPECT_TRUE(dominated[3].empty()) << "slower and smaller";
}

/// One round.
Figures figures_once(double user, double bytes = 100.0) {
  Figures out = figures(user, user, bytes, 1e-4, 50);
  out["build_user_seconds"].count = 1;
  out["build_wall_seconds"] = figure_of({user});
  return out;
}

TEST(SweepAnswers, OfProcessorTimeThatWasMeasuredOnceASpreadIsAssumed) {
  const std::vector<Figures> all{figures_once(1.0), figures_once(3.5), figures_once(1.3)};
  const auto dominated = find_dominators(candidates_of(all));
  EXPECT_EQ(dominated[1], (std::vector<std::size_t>{0, 2})) << "three times the time is no noise";
  EXPECT_TRUE(dominated[2].empty()) << "a third more may be";
  const Answer answer = answer_wish(candidates_of(all), *parse_wish("deviation<=1e-4, time min"));
  EXPECT_EQ(answer.point, 0U);
  EXPECT_EQ(answer.as_good, std::vector<std::size_t>{2});
  EXPECT_TRUE(answer.not_compared.empty());
  EXPECT_NE(answer.why.find("25%"), std::string::npos) << answer.why;
}

TEST(SweepAnswers, AFastBuildIsNeverAsGoodAsOneOfThreeAndAHalfTimesItsTime) {
  // The baseline changes fewest settings, which must not help it.
  for (const std::uint32_t count : {1U, 2U, 3U}) {
    for (const double seconds : {0.126, 0.679, 30.0}) {
      std::vector<Figures> all{figures_once(3.5 * seconds), figures_once(seconds)};
      for (Figures& one : all) one["build_user_seconds"].count = count;
      const Answer answer = answer_wish(candidates_of(all), *parse_wish("deviation<=1e-3, time min"));
      EXPECT_EQ(answer.point, 1U) << count << " " << seconds;
      EXPECT_TRUE(answer.as_good.empty()) << count << " " << seconds;
    }
  }
}

TEST(SweepAnswers, AnyOtherTimeThatWasMeasuredOnceIsNotCompared) {
  std::vector<Figures> all{figures_once(1.0), figures_once(9.0), figures_once(2.0)};
  const Wish wish = *parse_wish("build min");
  Answer answer = answer_wish(candidates_of(all), wish);
  EXPECT_FALSE(answer.point.has_value());
  EXPECT_TRUE(answer.as_good.empty());
  EXPECT_EQ(answer.not_compared, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_NE(answer.why.find("not compared: one round"), std::string::npos) << answer.why;
  EXPECT_TRUE(find_frontier(candidates_of(all), *find_metric("build"), *find_metric("bytes")).empty());
  // Of those measured more often one is chosen, and the rest is named.
  for (const std::size_t i : {1U, 2U}) all[i]["build_wall_seconds"].count = 2;
  answer = answer_wish(candidates_of(all), wish);
  EXPECT_EQ(answer.point, 2U);
  EXPECT_EQ(answer.not_compared, std::vector<std::size_t>{0});
  EXPECT_EQ(find_frontier(candidates_of(all), *find_metric("build"), *find_metric("bytes")),
            std::vector<std::size_t>{2});
}

TEST(SweepAnswers, WhoLacksAFigureIsLeftAlone) {
  std::vector<Figures> all{figures(1.0, 1.0, 100, 1e-4, 50), figures(2.0, 2.0, 200, 2e-4, 60)};
  all[1].erase("triangles_at_max");
  EXPECT_TRUE(find_dominators(candidates_of(all))[1].empty());
}

TEST(SweepAnswers, AFrontierRisesAndFalls) {
  const std::vector<Figures> all{figures(3, 3, 80, 1e-4, 50), figures(1, 1, 100, 1e-4, 50), figures(2, 2, 90, 1e-4, 50),
                                 figures(2.5, 2.5, 95, 1e-4, 50), figures(1.9, 2.2, 90, 1e-4, 50)};
  const auto frontier = find_frontier(candidates_of(all), *find_metric("time"), *find_metric("bytes"));
  EXPECT_EQ(frontier, (std::vector<std::size_t>{1, 2, 4, 0})) << "two that cannot be told apart are both there";
}

TEST(SweepAnswers, AWishIsReadAsItStands) {
  const auto wish = parse_wish(" deviation<=1e-4 ,normal < 0.5, bytes min ");
  ASSERT_TRUE(wish) << wish.error().message();
  ASSERT_EQ(wish->bounds.size(), 2U);
  EXPECT_STREQ(wish->bounds[0].metric->key, "deviation");
  EXPECT_EQ(wish->bounds[0].relation, app::Relation::kLessEqual);
  EXPECT_EQ(wish->bounds[0].value, 1e-4);
  EXPECT_STREQ(wish->bounds[1].metric->key, "normal_rms");
  EXPECT_EQ(wish->bounds[1].relation, app::Relation::kLess);
  EXPECT_STREQ(wish->goal->key, "file_bytes");
  EXPECT_TRUE(parse_wish("psnr max"));
}

TEST(SweepAnswers, OtherTextsAreRefusedInWords) {
  for (const char* text :
       {"", ",", "bytes", "bytes min, time min", "deviation<=x, bytes min", "deviation<=nan, bytes min", "bytes max",
        "psnr min", "devation<=1, bytes min", "deviation==1, bytes min", " min", "deviation<=1e-4",
        "deviation<=1e-4 1, bytes min", "bytes min,"}) {
    const auto wish = parse_wish(text);
    ASSERT_FALSE(wish) << text;
    EXPECT_EQ(wish.error().code, ErrorCode::kUsage) << text;
    EXPECT_FALSE(wish.error().detail.empty()) << text;
  }
  EXPECT_NE(parse_wish("devation<=1, bytes min").error().detail.find("the nearest is deviation"), std::string::npos);
}

TEST(SweepAnswers, OfThoseAsGoodTheOneThatChangesLeast) {
  const std::vector<Figures> all{figures(5, 5, 100, 5e-4, 50), figures(1.1, 1.3, 100, 1e-4, 50),
                                 figures(1.0, 1.2, 100, 1e-4, 50), figures(0.1, 0.1, 100, 2e-4, 50)};
  const Answer answer = answer_wish(candidates_of(all), *parse_wish("deviation<=1e-4, time min"));
  EXPECT_EQ(answer.point, 1U) << "not told from the third, which has the better median and changes more";
  EXPECT_EQ(answer.as_good, std::vector<std::size_t>{2});
  EXPECT_FALSE(answer_wish(candidates_of(all), *parse_wish("deviation<=1e-9, time min")).point.has_value());
}

TEST(SweepAnswers, AnAssetThatIsDrawnInAnotherWayIsNoOtherAnswer) {
  const std::vector<Figures> all{figures(1, 2, 100, 1e-4, 50), figures(1, 2, 100, 1e-4, 50),
                                 figures(1, 2, 100, 1e-4, 50)};
  std::vector<Candidate> candidates = candidates_of(all);
  candidates[1].asset = candidates[0].asset;
  EXPECT_EQ(answer_wish(candidates, *parse_wish("bytes min")).as_good, std::vector<std::size_t>{2});
}

TEST(SweepAnswers, ABoundHoldsForEveryMeasurementAndExperimentsAreNotRecommended) {
  const std::vector<Figures> all{figures(0.9, 1.3, 50, 1e-4, 50), figures(0.8, 1.0, 60, 1e-4, 50),
                                 figures(0.5, 0.6, 40, 1e-4, 50)};
  std::vector<Candidate> candidates = candidates_of(all);
  candidates[2].is_experimental = true;
  EXPECT_EQ(answer_wish(candidates, *parse_wish("time<=1, bytes min")).point, 1U);
}

}  // namespace
}  // namespace meshlode::lab
