// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/kept_samples.h"

#include <vector>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

TEST(KeptSamples, ComeBackInOrderWithTheirPoints) {
  const std::vector<Vec3d> positions{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  const std::vector<CarriedSample> samples{{positions[2], 11, 0.5F, TreeSlot(21U), 2},
                                           {{0.25, 0, 0}, 12, 0.5F, TreeSlot(22U), kNoId},
                                           {positions[0], 13, 0.5F, TreeSlot(23U), 0},
                                           {{0, 0.75, 0}, 14, 0.5F, TreeSlot(24U)}};
  KeptSamples kept;
  kept.reserve(4, 2);
  for (const CarriedSample& sample : samples) kept.add(sample);
  std::vector<CarriedSample> back(1);
  kept.append_to(back, positions);
  ASSERT_EQ(back.size(), 5U);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(back[i + 1].point, samples[i].point);
    EXPECT_EQ(back[i + 1].place, samples[i].place);
    EXPECT_EQ(back[i + 1].vertex, samples[i].vertex);
  }
  kept.free();
  EXPECT_EQ(kept.size(), 0U);
  kept.append_to(back, positions);
  EXPECT_EQ(back.size(), 5U) << "nothing is left";
}

}  // namespace
}  // namespace meshlode::builder
