// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/box.h"

#include <gtest/gtest.h>

namespace meshlode {
namespace {

TEST(Box, IsAroundWhatIsAdded) {
  Box3d box;
  EXPECT_TRUE(box.is_empty());
  box.add({1.0, -2.0, 3.0});
  EXPECT_FALSE(box.is_empty());
  EXPECT_EQ(box.size(), Vec3d(0.0));
  box.add({-1.0, 5.0, 3.0});
  EXPECT_EQ(box.low, Vec3d(-1.0, -2.0, 3.0));
  EXPECT_EQ(box.high, Vec3d(1.0, 5.0, 3.0));
  Box3d both;
  both.add(Box3d{});
  EXPECT_TRUE(both.is_empty());
  both.add(box);
  EXPECT_EQ(both.low, box.low);
  EXPECT_EQ(both.high, box.high);
}

TEST(Box, TheFirstOfEqualSidesIsTheLongest) {
  EXPECT_EQ((Box3d{Vec3d(0.0), Vec3d(1.0, 1.0, 1.0)}).longest_axis(), 0);
  EXPECT_EQ((Box3d{Vec3d(0.0), Vec3d(1.0, 2.0, 2.0)}).longest_axis(), 1);
  EXPECT_EQ((Box3d{Vec3d(0.0), Vec3d(2.0, 1.0, 2.0)}).longest_axis(), 0);
  EXPECT_EQ((Box3d{Vec3d(0.0), Vec3d(1.0, 1.0, 2.0)}).longest_axis(), 2);
}

TEST(Box, CornersAreAllEight) {
  const Box3d box{Vec3d(0.0), Vec3d(1.0, 2.0, 4.0)};
  Vec3d sum(0.0);
  Box3d around;
  for (const Vec3d& corner : box.corners()) {
    sum += corner;
    around.add(corner);
  }
  EXPECT_EQ(sum, Vec3d(4.0, 8.0, 16.0));
  EXPECT_EQ(around.low, box.low);
  EXPECT_EQ(around.high, box.high);
}

TEST(Box, IsWithinADistanceAlongEachAxis) {
  const Box3d box{Vec3d(0.0), Vec3d(1.0)}, beside{Vec3d(2.0, 0.0, 0.0), Vec3d(3.0, 1.0, 1.0)};
  EXPECT_FALSE(box.is_within(beside, 0.5));
  EXPECT_TRUE(box.is_within(beside, 1.0));
  EXPECT_TRUE(beside.is_within(box, 1.0));
  EXPECT_TRUE(box.is_within(box, 0.0));
}

}  // namespace
}  // namespace meshlode
