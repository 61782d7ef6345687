// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/noise_limits.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace meshlode::build {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NoiseCurve, IsEvenBetweenWhatWasMeasured) {
  const NoiseCurve curve{{{8.0, 0.05}, {4.0, 0.10}, {2.0, 0.30}}};
  EXPECT_DOUBLE_EQ(curve.size_for(0.10), 4.0);
  EXPECT_DOUBLE_EQ(curve.size_for(0.20), 3.0);
  EXPECT_DOUBLE_EQ(curve.size_for(0.30), 2.0);
  EXPECT_DOUBLE_EQ(curve.size_for(0.50), 2.0) << "nobody looked further";
  EXPECT_EQ(curve.size_for(0.04), kInfinity);
  EXPECT_DOUBLE_EQ(curve.at(3.0), 0.20);
  EXPECT_DOUBLE_EQ(curve.at(16.0), 0.05);
  EXPECT_DOUBLE_EQ(curve.at(1.0), 0.30);
  EXPECT_EQ(NoiseCurve{}.size_for(1.0), kInfinity);
  // What rose again is as far as it goes.
  const NoiseCurve bumpy{{{8.0, 0.05}, {4.0, 0.25}, {2.0, 0.10}}};
  EXPECT_DOUBLE_EQ(bumpy.size_for(0.15), 6.0);
}

/// Noise as one over the pixel's size: `grain` is where it is 1.
NoiseCurve falling(double grain) {
  NoiseCurve curve;
  for (double size = 4096.0 * grain; size >= grain; size *= 0.5) curve.points.push_back({size, grain / size});
  return curve;
}

TEST(NoiseLimits, OneGroupHasWhatTheWholeHas) {
  const NoiseCurve way = falling(1.0);
  const std::vector<std::vector<NoisyGroup>> levels{{{0, 1, 1.0, {&way}}}};
  EXPECT_DOUBLE_EQ(choose_noise_limits(levels, 0.2, 0.19)[0], 0.2);
  EXPECT_DOUBLE_EQ(choose_noise_limits(levels, 0.2, 0.26)[0], 0.26);
  EXPECT_DOUBLE_EQ(choose_noise_limits(levels, 0.2, 0.4)[0], kLoosestNoise);
}

TEST(NoiseLimits, GroupsOutOfStepMayHaveMore) {
  std::vector<NoiseCurve> ways;
  ways.reserve(16);
  std::vector<NoisyGroup> groups;
  for (std::uint32_t g = 0; g < 16; ++g) {
    ways.push_back(falling(std::ldexp(1.0, static_cast<int>(g) / 2)));
    groups.push_back({g, g + 1, 1.0 / 16.0, {&ways.back()}});
  }
  const std::vector<std::vector<NoisyGroup>> levels{groups};
  const std::vector<double> limits = choose_noise_limits(levels, 0.2, 0.19);
  EXPECT_GT(limits[0], 0.25);
  // What it foretells is what a cut has, whichever groups are in it.
  for (double size = 1.0; size < 4000.0; size *= 1.1) {
    double squares = 0.0;
    for (const NoisyGroup& group : groups) {
      if (group.ways[0]->size_for(limits[0]) <= size)
        squares += group.share * group.ways[0]->at(size) * group.ways[0]->at(size);
    }
    EXPECT_LE(std::sqrt(squares), 0.19 * (1.0 + 1e-9)) << size;
  }
}

TEST(NoiseLimits, ALevelWaitsForTheOneBelow) {
  // The coarser way would be good before the finer ones are: then it is not what is seen.
  const NoiseCurve fine = falling(8.0), coarse = falling(1.0), never;
  const std::vector<std::vector<NoisyGroup>> levels{{{0, 1, 0.5, {&fine}}, {1, 2, 0.5, {&fine}}},
                                                    {{0, 2, 1.0, {&coarse, &never}}}};
  const std::vector<double> limits = choose_noise_limits(levels, 0.2, 0.19);
  EXPECT_DOUBLE_EQ(limits[1], kLoosestNoise);
  EXPECT_TRUE(choose_noise_limits({}, 0.2, 0.19).empty());
}

}  // namespace
}  // namespace meshlode::build
