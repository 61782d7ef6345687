// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/read_sweep.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "lab/page/page.h"
#include "lab/page/read_pictures.h"
#include "lab/page/sample_sweep.h"
#include "support/sanitized.h"

namespace meshlode::lab::page {
namespace {

TEST(ReadSweep, TakesWhatTheSchemaNames) {
  const auto data = read_sweep(made_up_sweep());
  ASSERT_TRUE(data) << data.error().message();
  EXPECT_EQ(data->scene_file, "made-up.glb");
  EXPECT_EQ(data->triangles, 69451U);
  EXPECT_EQ(data->machine, "a machine that was made up");
  EXPECT_EQ(data->budget_seconds, 300.0);
  EXPECT_EQ(data->knobs.size(), 8U);
  EXPECT_EQ(data->metrics.size(), 10U);
  EXPECT_FALSE(data->metrics[8].is_less_better) << "PSNR";
  ASSERT_EQ(data->points.size(), 22U) << "27 values, 8 of them usual, the baseline, two corners";
  const Point& base = data->points[0];
  EXPECT_EQ(base.id, data->baseline);
  EXPECT_EQ(base.settings.at("codec"), "zstd");
  EXPECT_EQ(base.figures.at("build_user_seconds").count, 3U);
  EXPECT_LT(base.figures.at("build_user_seconds").low, base.figures.at("build_user_seconds").value);
  EXPECT_EQ(base.figures.at("file_bytes").low, base.figures.at("file_bytes").value);
  EXPECT_EQ(base.cuts.size(), 9U);
  EXPECT_EQ(base.equal.size(), 7U);
  EXPECT_EQ(base.sections.size(), 9U);
  EXPECT_EQ(base.pictures.at(0).picture, "pictures/p0.png");
  EXPECT_EQ(data->frontiers.size(), 2U);
  EXPECT_EQ(data->recommendations.at(0).point, "p2");
  EXPECT_FALSE(data->recommendations.at(1).point.has_value());
  EXPECT_EQ(data->left_out.at(0).reason, "budget");
  ASSERT_TRUE(data->scene_faults);
  ASSERT_EQ(data->scene_faults->ranked.size(), 2U);
  const app::Diagnosis& fault = data->scene_faults->ranked[0];
  EXPECT_EQ(fault.id, "needles");
  EXPECT_EQ(fault.hard_case, "needles");
  EXPECT_EQ(fault.share, 0.34);
  EXPECT_EQ(fault.count, 6000U);
  ASSERT_EQ(fault.places.size(), 6U);
  EXPECT_EQ(fault.places[5].where, "mesh 5 'made up'");
  EXPECT_EQ(fault.places[5].costs.at(0).amount, 1234.0);
}

TEST(ReadSweep, RefusesWhatIsNone) {
  for (const char* text :
       {"", "{", "[]", "7", "{}", R"({"sweep_version": 2})", R"({"sweep_version": 1, "points": {}})",
        R"({"sweep_version": 1, "points": [{"id": 3}]})", R"({"sweep_version": 1, "command": []})",
        R"({"sweep_version": 1, "seed": -1})", R"({"sweep_version": 1, "spent_seconds": 1e301})",
        R"({"sweep_version": 1, "points": [{"settings": {"a": 1}}]})", R"({"sweep_version": 1, "complete": "yes"})",
        R"({"sweep_version": 1, "points": [{"figures": {"x": 3}}]})", R"({"sweep_version": 1, "doctor": []})",
        R"({"sweep_version": 1, "doctor": {"faults": [{"share": "all"}]}})",
        R"({"sweep_version": 1, "doctor": {"faults": [{"places": 1}]}})"}) {
    const auto data = read_sweep(text);
    ASSERT_FALSE(data) << text;
    EXPECT_EQ(data.error().code, ErrorCode::kInvalid);
  }
}

TEST(ReadSweep, WhatIsMissingIsEmptyAndStillAPage) {
  const auto data = read_sweep(R"({"sweep_version": 1, "points": [{}, {"figures": {"x": {"value": 1}}}]})");
  ASSERT_TRUE(data);
  EXPECT_FALSE(write_page(*data).empty());
}

/// A byte changed anywhere is an error or a page, never more.
TEST(ReadSweep, TakesAnyBytes) {
  const std::string sound = made_up_sweep();
  for (std::size_t at = 0; at < sound.size(); at += test::kIsSanitized ? 3 * 3989 : 3989) {
    for (const char byte : {'"', '}', '9', '\0', '-'}) {
      std::string text = sound;
      text[at] = byte;
      const auto data = read_sweep(text);
      if (data && at % 3 == 0) {
        EXPECT_FALSE(write_page(*data).empty());
      }
    }
  }
}

class Pictures : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("meshlode-read-sweep-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "pictures");
    data_.views.push_back({"front", ""});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void put(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  Status read(const std::string& path) {
    data_.views[0].picture = path;
    return read_pictures(data_, folder_);
  }
  std::filesystem::path folder_;
  ReportData data_;
};

TEST_F(Pictures, AreReadFromBelowTheFolder) {
  const auto png = made_up_pictures().at("pictures/full.png");
  put("pictures/full.png", {png.begin(), png.end()});
  ASSERT_TRUE(read("pictures/full.png"));
  EXPECT_EQ(data_.pictures.at("pictures/full.png"), png);
}

TEST_F(Pictures, AreNotTakenFromElsewhere) {
  const auto png = made_up_pictures().at("pictures/full.png");
  put("full.png", {png.begin(), png.end()});
  for (const std::string& path :
       {std::string("pictures/../full.png"), (folder_ / "full.png").string(), std::string("../x")}) {
    const Status status = read(path);
    ASSERT_FALSE(status) << path;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalid) << path;
  }
}

TEST_F(Pictures, ArePng) {
  put("pictures/text.png", "<svg onload='alert(1)'/>");
  ASSERT_FALSE(read("pictures/text.png"));
  put("pictures/text.png", "");
  ASSERT_FALSE(read("pictures/text.png"));
  const Status missing = read("pictures/missing.png");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace meshlode::lab::page
