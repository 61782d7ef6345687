// SPDX-License-Identifier: GPL-3.0-or-later
// The small files of a simulation: what they mean, and that whatever else they say is an error with its line.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "app/stream/camera_path.h"

namespace meshlode::app {
namespace {

TEST(CameraPath, MovesEvenlyFromRowToRowAndJumpsWhereARowCuts) {
  const auto rows = parse_path(
      "t,ex,ey,ez,tx,ty,tz\n0, 0,0,5, 0,0,0\n1, 2,0,5, 2,0,0, 90 # to the right\n\n2,9,0,5,9,0,0,cut\n", "p");
  ASSERT_TRUE(rows) << rows.error().message();
  ASSERT_EQ(rows->size(), 3U);
  EXPECT_TRUE((*rows)[2].is_cut);
  const auto frames = sample_path(*rows, 4, "p");
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 9U);
  EXPECT_TRUE((*frames)[0].is_jump);
  EXPECT_EQ((*frames)[2].eye.x, 1.0);
  EXPECT_NEAR((*frames)[2].fovy, 75.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_EQ((*frames)[3].time_us, 750000);
  EXPECT_EQ((*frames)[7].eye.x, 2.0) << "stays until the cut";
  EXPECT_FALSE((*frames)[7].is_jump);
  EXPECT_EQ((*frames)[8].eye.x, 9.0);
  EXPECT_TRUE((*frames)[8].is_jump);
}

TEST(CameraPath, OneRowIsOneFrame) {
  const auto rows = parse_path("5,0,0,1,0,0,0,cut", "p");
  ASSERT_TRUE(rows);
  const auto frames = sample_path(*rows, 60, "p");
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 1U);
  EXPECT_EQ((*frames)[0].eye.z, 1.0);
}

TEST(CameraPath, WhatIsNoPathIsAnErrorWithItsLine) {
  const auto expect_error = [](const std::string& text, const char* place) {
    const auto rows = parse_path(text, "p.csv");
    ASSERT_FALSE(rows) << text;
    EXPECT_EQ(rows.error().code, ErrorCode::kInvalid);
    EXPECT_EQ(rows.error().where, place) << text;
  };
  expect_error("", "p.csv");
  expect_error("# nothing\n\n", "p.csv");
  expect_error("t,ex,ey,ez,tx,ty,tz", "p.csv");
  expect_error("0,0,0,1,0,0,0\n0,0,0,1,0,0,0", "p.csv, line 2");
  expect_error("0,0,0,1,0,0", "p.csv, line 1");
  expect_error("0,0,0,1,0,0,0,60,1", "p.csv, line 1");
  expect_error("0,0,0,1,0,0,x", "p.csv, line 1");
  expect_error("0,0,0,1,0,0,", "p.csv, line 1");
  expect_error("\n\n0,0,0,nan,0,0,0", "p.csv, line 3");
  expect_error("0,0,0,inf,0,0,0", "p.csv, line 1");
  expect_error("0,0,0,1e16,0,0,0", "p.csv, line 1");
  expect_error("0,1,2,3,1,2,3", "p.csv, line 1");
  expect_error("0,0,0,1,0,0,0,180", "p.csv, line 1");
  expect_error("0,0,0,1,0,0,0,0", "p.csv, line 1");
  expect_error(std::string("0,0,0,1,0,0,\0", 13), "p.csv, line 1");
  expect_error("cut", "p.csv, line 1");
  std::string many;
  for (int i = 0; i <= 100000; ++i) many += std::to_string(i) + ",0,0,1,0,0,0\n";
  expect_error(many, "p.csv, line 100001");
}

TEST(CameraPath, APathOfTooManyFramesIsRefused) {
  const auto rows = parse_path("0,0,0,1,0,0,0\n1e15,0,0,1,0,0,0", "p.csv");
  ASSERT_TRUE(rows);
  const auto frames = sample_path(*rows, 60, "p.csv");
  ASSERT_FALSE(frames);
  EXPECT_EQ(frames.error().code, ErrorCode::kInvalid);
}

TEST(Placements, NameAnAssetByItsPathOrItsFileName) {
  const std::vector<std::string> names{"a/tree.lode", "b/rock.lode", "c/rock.lode", "my tree.lode"};
  const auto placed =
      parse_placements("tree.lode 1 2 3 90 2\n\tc/rock.lode\t0 0 0 0 1 # one\nmy tree.lode 0 0 0 5 1", "s", names);
  ASSERT_TRUE(placed) << placed.error().message();
  ASSERT_EQ(placed->size(), 3U);
  EXPECT_EQ((*placed)[0].asset, 0U);
  EXPECT_EQ((*placed)[0].position.z, 3.0);
  EXPECT_EQ((*placed)[0].yaw_degrees, 90.0);
  EXPECT_EQ((*placed)[1].asset, 2U);
  EXPECT_EQ((*placed)[2].asset, 3U);
  EXPECT_EQ((*placed)[2].yaw_degrees, 5.0);

  const auto expect_error = [&](const std::string& text, const char* place) {
    const auto bad = parse_placements(text, "s", names);
    ASSERT_FALSE(bad) << text;
    EXPECT_EQ(bad.error().code, ErrorCode::kInvalid);
    EXPECT_EQ(bad.error().where, place) << text;
  };
  expect_error("", "s");
  expect_error("rock.lode 0 0 0 0 1", "s, line 1");  // which of the two?
  expect_error("\n/etc/passwd 0 0 0 0 1", "s, line 2");
  expect_error("tree.lode 0 0 0 0", "s, line 1");
  expect_error("tree.lode 0 0 0 0 1 1", "s, line 1");
  expect_error("tree.lode 0 0 0 0 0", "s, line 1");
  expect_error("tree.lode 0 0 0 0 -1", "s, line 1");
  expect_error("tree.lode 0 0 1e300 0 1", "s, line 1");
  expect_error("tree.lode 0 0 z 0 1", "s, line 1");
  std::string many;
  for (int i = 0; i <= 65536; ++i) many += "tree.lode 0 0 0 0 1\n";
  expect_error(many, "s, line 65537");
}

}  // namespace
}  // namespace meshlode::app
