// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/noise_budget.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStep = 1.011;  // pixel sizes that are looked at lie no farther apart

TEST(NoiseCurve, IsEvenBetweenWhatWasMeasured) {
  const NoiseCurve curve{{{8.0, 0.05}, {4.0, 0.10}, {2.0, 0.30}}};
  EXPECT_DOUBLE_EQ(curve.most_from(3.0), 0.20);
  EXPECT_DOUBLE_EQ(curve.most_from(4.0), 0.10);
  EXPECT_DOUBLE_EQ(curve.most_from(2.0), 0.30);
  EXPECT_DOUBLE_EQ(curve.most_from(16.0), 0.05);
  EXPECT_EQ(curve.most_from(1.9), kInfinity) << "nobody looked further";
  EXPECT_EQ(NoiseCurve{}.most_from(1.0), kInfinity);
  const NoiseCurve of_large_cards{{{8.0, 0.05}, {4.0, 0.10}, {2.0, 0.30}}, 3.0};
  EXPECT_DOUBLE_EQ(of_large_cards.most_from(3.0), 0.20);
  EXPECT_EQ(of_large_cards.most_from(2.9), kInfinity) << "not drawn";
}

TEST(NoiseCurve, WhatRoseAgainCountsBelow) {
  const NoiseCurve bumpy{{{8.0, 0.05}, {4.0, 0.25}, {2.0, 0.10}}};
  EXPECT_DOUBLE_EQ(bumpy.most_from(2.0), 0.25);
  EXPECT_DOUBLE_EQ(bumpy.most_from(6.0), 0.15);
}

/// Noise as one over the pixel's size: `grain` is where it is 1.
NoiseCurve falling(double grain) {
  NoiseCurve curve;
  for (double size = 4096.0 * grain; size >= grain; size *= 0.5) curve.points.push_back({size, grain / size});
  return curve;
}

using Levels = std::vector<std::vector<NoisyGroup>>;
using Uses = std::vector<std::vector<NoiseUse>>;

/// What a cut has, by the groups that it shows, and how many triangles.
struct Cut {
  double noise = 0.0;
  std::size_t triangles = 0;
};

Cut cut_at(const Levels& levels, const Uses& uses, double size) {
  Cut cut;
  const auto look = [&](auto& self, std::size_t level, std::size_t group) -> void {
    const NoisyGroup& from = levels[level][group];
    const NoiseUse& use = uses[level][group];
    if (use.pixel_size <= size) {
      const NoisyWay& way = from.ways[use.way];
      cut.noise += from.share * way.noise->most_from(size) * way.noise->most_from(size);
      cut.triangles += way.triangles;
    } else if (level == 0) {
      cut.triangles += from.source_triangles;
    } else {
      const std::size_t children = levels[level - 1].size() / levels[level].size();
      for (std::size_t child = 0; child < children; ++child) self(self, level - 1, group * children + child);
    }
  };
  for (std::size_t g = 0; g < levels.back().size(); ++g) look(look, levels.size() - 1, g);
  cut.noise = std::sqrt(cut.noise);
  return cut;
}

TEST(NoiseBudget, OneGroupHasWhatTheWholeHas) {
  const NoiseCurve way = falling(1.0);
  const Levels levels{{{1.0, 100, {{&way, {}, 0.0, 50}}}}};
  for (const double most : {0.1, 0.19, 0.25}) {
    const double size = share_out_noise(levels, {.noise = most})[0][0].pixel_size;
    EXPECT_LE(way.most_from(size), most);
    EXPECT_GT(way.most_from(size / kStep), most) << "and no later than it may come";
  }
  const double loosest = share_out_noise(levels, {.noise = 0.9})[0][0].pixel_size;
  EXPECT_LE(way.most_from(loosest), kLoosestNoise);
  EXPECT_GT(way.most_from(loosest / kStep), kLoosestNoise);
  EXPECT_EQ(share_out_noise(levels, {.noise = 1e-5})[0][0].pixel_size, kInfinity);
  EXPECT_TRUE(share_out_noise({}, {.noise = 0.19}).empty());
}

TEST(NoiseBudget, OfTheSameLeavesALevelMayBeLeftOut) {
  const NoiseCurve bad = falling(4.0), good = falling(1.0), never{{{4096.0, 0.4}}};
  for (const NoiseCurve* middle : {&bad, &never}) {
    const Levels levels{{{1.0, 100, {{&good, {}, 0.0, 50}}}},
                        {{1.0, 100, {{middle, {}, 0.0, 35}}}},
                        {{1.0, 100, {{&good, {}, 0.0, 25}}}}};
    const Uses uses = share_out_noise(levels, {.noise = 0.19});
    EXPECT_EQ(uses[1][0].pixel_size, kInfinity) << "when it may come there is fewer already";
    EXPECT_LT(uses[2][0].pixel_size, 6.0);
  }
  // But not where groups merge: what they replace has to be in one page.
  const Levels merged{{{0.5, 100, {{&never, {}, 0.0, 50}}}, {0.5, 100, {{&good, {}, 0.0, 50}}}},
                      {{1.0, 200, {{&good, {}, 0.0, 50}}}}};
  EXPECT_EQ(share_out_noise(merged, {.noise = 0.19})[1][0].pixel_size, kInfinity);
}

/// Two levels of groups out of step.
struct OutOfStep {
  OutOfStep() : levels(2) {
    fine.reserve(16);
    coarse.reserve(8);
    for (std::size_t g = 0; g < 16; ++g) {
      fine.push_back(falling(1.0 + 0.2 * static_cast<double>(g)));
      levels[0].push_back({1.0 / 16.0, 100, {{&fine.back(), {}, 0.0, 50}}});
    }
    for (std::size_t g = 0; g < 8; ++g) {
      coarse.push_back(falling(3.0 + 0.5 * static_cast<double>(g)));
      levels[1].push_back({1.0 / 8.0, 200, {{&coarse.back(), {}, 0.0, 50}}});
    }
  }
  std::vector<NoiseCurve> fine, coarse;
  Levels levels;
};

TEST(NoiseBudget, NoCutHasMoreThanTheWholeMay) {
  const OutOfStep out;
  const Uses uses = share_out_noise(out.levels, {.noise = 0.19});
  double most = 0.0;
  std::size_t loose = 0;
  std::size_t before = 1600;
  for (double size = 1.0; size < 20000.0; size *= 1.003) {
    const Cut cut = cut_at(out.levels, uses, size);
    most = std::max(most, cut.noise);
    EXPECT_LE(cut.triangles, before);
    before = cut.triangles;
  }
  EXPECT_EQ(before, 400U);
  EXPECT_LE(most, 0.19 * (1.0 + 1e-9));
  EXPECT_GT(most, 0.18) << "and it is spent";
  for (std::size_t l = 0; l < 2; ++l) {
    for (std::size_t g = 0; g < out.levels[l].size(); ++g) {
      const NoiseUse& use = uses[l][g];
      ASSERT_LT(use.pixel_size, kInfinity);
      const double noise = out.levels[l][g].ways[0].noise->most_from(use.pixel_size);
      EXPECT_LE(noise, kLoosestNoise);
      loose += noise > 0.2 ? 1 : 0;
      if (l == 1) continue;
      EXPECT_LE(use.pixel_size, uses[1][g / 2].pixel_size) << "a group waits for those that it replaces";
    }
  }
  EXPECT_GT(loose, 4U) << "groups out of step have more than the whole";
}

TEST(NoiseBudget, WhatSparesMostComesFirst) {
  const NoiseCurve way = falling(1.0);
  // The same noise, but one of them spares nine times as many triangles.
  const Levels levels{{{0.5, 100, {{&way, {}, 0.0, 90}}}, {0.5, 100, {{&way, {}, 0.0, 10}}}}};
  const Uses uses = share_out_noise(levels, {.noise = 0.19});
  EXPECT_LT(uses[0][1].pixel_size, uses[0][0].pixel_size);
}

TEST(NoiseBudget, TheWayWithLeastNoiseThereIsTaken) {
  const NoiseCurve worse = falling(2.0), better = falling(1.0);
  const Levels levels{{{1.0, 100, {{&worse, {}, 0.0, 50}, {&better, {}, 0.0, 50}}}}};
  EXPECT_EQ(share_out_noise(levels, {.noise = 0.19})[0][0].way, 1U);
}

TEST(NoiseBudget, InSmallPixelsNoViewShowsMuchElse) {
  const NoiseCurve way = falling(1.0);
  const std::vector<double> more{0.06, 0.0}, less{-0.06, 0.0};
  // Two that show more of a view are too much, and a third that shows less of it makes room.
  const auto group = [&](const std::vector<double>& shifts, double share) {
    return NoisyGroup{share, 100, {{&way, shifts, 0.0, 50}}};
  };
  const NoiseBudget budget{.noise = 0.25, .sum_shift = 1.0, .shift = 0.1, .shift_below = 1000.0};
  const Levels two{{group(more, 0.4), group(more, 0.6)}};
  const Uses held = share_out_noise(two, budget);
  EXPECT_LT(held[0][0].pixel_size, 10.0);
  EXPECT_GE(held[0][1].pixel_size, 1000.0) << "until pixels are large";
  EXPECT_LT(held[0][1].pixel_size, 1000.0 * kStep);
  const Levels three{{group(more, 0.4), group(more, 0.3), group(less, 0.3)}};
  const Uses all = share_out_noise(three, budget);
  for (const NoiseUse& use : all[0]) EXPECT_LT(use.pixel_size, 10.0);
  // What replaces them counts instead of them, not with them.
  Levels replaced = three;
  replaced.push_back({group(more, 1.0)});
  EXPECT_LT(share_out_noise(replaced, budget)[1][0].pixel_size, 10.0);
}

TEST(NoiseBudget, TogetherViewsShowNoMoreThanTheyMay) {
  const NoiseCurve way = falling(1.0);
  const Levels levels{{{0.5, 100, {{&way, {}, 0.01, 50}}}, {0.5, 100, {{&way, {}, 0.01, 50}}}}};
  const Uses uses = share_out_noise(levels, {.noise = 0.25, .sum_shift = 0.015});
  EXPECT_LT(uses[0][0].pixel_size, 10.0);
  EXPECT_EQ(uses[0][1].pixel_size, kInfinity) << "in pixels of any size";
}

}  // namespace
}  // namespace meshlode::builder
