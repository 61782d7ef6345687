// SPDX-License-Identifier: GPL-3.0-or-later
// Text, CSV and Markdown of one asset, whose numbers are set here.
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/report/fold_reasons.h"
#include "app/report/info.h"
#include "app/report/rows.h"
#include "format/names.h"
#include "support/sample_asset.h"

namespace meshlode::app {
namespace {

const run::Asset& sample() {
  static const run::Asset asset = *run::Asset::from_vector(test::sample_asset_bytes());
  return asset;
}

/// Three levels of the sample's first mesh.
AssetInfo three_levels() {
  AssetInfo info;
  MeshInfo mesh;
  mesh.levels.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    LevelInfo& level = mesh.levels[i];
    level.level = i;
    level.clusters = 4U >> i;
    level.triangles = 2048U >> i;
    level.vertices = 1100U >> i;
    level.fill = 1.0 - 0.25 * i;
    level.groups = 1;
  }
  mesh.levels[1].error_min = 0.001F;
  mesh.levels[1].error_max = 0.01F;
  mesh.levels[2].error_min = mesh.levels[2].error_max = 0.1F;
  mesh.levels[2].normal_deviation_max = format::kInfiniteError;
  mesh.levels[2].uv_deviation_max = format::kInfiniteError;
  mesh.stuck = {{0, 7, 2, format::StuckReason::kLocked, 3, 99}};
  info.stuck_groups = 1;
  info.meshes.push_back(mesh);
  return info;
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(part) != std::string::npos) found.push_back(line);
  }
  return found;
}

TEST(Formats, TextHasABarForTheErrorWhereThereIsRoom) {
  const std::string text = info_text(sample(), three_levels(), false);
  const auto rows = lines_with(text, "..");
  ASSERT_EQ(rows.size(), 2U) << text;
  EXPECT_EQ(rows[0], "    0        4      2,048      1,100 100%      1     0         0 ..........");
  EXPECT_EQ(rows[1], "    1        2      1,024        550  75%      1     0      0.01 ###.......");
  EXPECT_EQ(lines_with(text, "    2        1        512        275  50%      1     0       0.1 ##########").size(), 1U);
  const std::string blocks = info_text(sample(), three_levels(), false, BarStyle::kBlocks);
  EXPECT_EQ(lines_with(blocks, "███▏").size(), 1U) << blocks;
}

TEST(Formats, TextHasColumnsForOtherDeviationsInThePlaceOfBars) {
  AssetInfo info = describe_asset(sample());
  for (LevelInfo& level : info.meshes[0].levels) level.error_max = 0.25F;
  const format::MeshRecord& mesh = sample().meshes()[0];
  const DeviationColumns columns = deviation_columns(mesh, info.meshes[0]);
  const auto heads = lines_with(info_text(sample(), info, false), "level clusters");
  ASSERT_FALSE(heads.empty());
  EXPECT_EQ(heads[0].find("normals") != std::string::npos, columns.normals);
  EXPECT_EQ(heads[0].find("UVs") != std::string::npos, columns.uvs);
}

TEST(FoldReasons, SaysOnceWhatIsTheSameForSeveralMeshes) {
  const std::vector<Reason> reasons{{"mesh 0 'a: b': TANGENT", "none"}, {"scene: 1 light", "carried"},
                                    {"mesh 1: TANGENT", "none"},        {"mesh 1: NORMAL", "none"},
                                    {"mesh 2 'c': TANGENT", "other"},   {"scene: 1 light", "carried"}};
  const std::vector<Reason> folded = fold_reasons(reasons, 9);
  std::string text;
  for (const Reason& reason : folded) text += reason.what + "|" + reason.why + "\n";
  EXPECT_EQ(text,
            "TANGENT, 2 of 9 meshes|none\nscene: 1 light|carried\nmesh 1: NORMAL|none\nmesh 2 'c': TANGENT|other\n"
            "scene: 1 light|carried\n");
  EXPECT_TRUE(fold_reasons({}, 0).empty());
}

TEST(Formats, TextAndMarkdownNameAlphaModes) {
  const AssetInfo info = describe_asset(sample());
  const std::string text = info_text(sample(), info, false), markdown = info_markdown(sample(), info, false);
  EXPECT_EQ(lines_with(text, "stone: OPAQUE").size(), 1U) << text;
  EXPECT_EQ(lines_with(text, "leaf: MASK below").size(), 1U) << text;
  EXPECT_EQ(lines_with(markdown, "| stone | OPAQUE |").size(), 1U) << markdown;
  EXPECT_EQ(lines_with(markdown, "| leaf | MASK below").size(), 1U) << markdown;
}

TEST(Formats, CsvHasALineForEachLevelAndNothingForWhatWasNotMeasured) {
  EXPECT_EQ(info_csv(sample(), three_levels(), false),
            "mesh,name,level,clusters,triangles,vertices,full_clusters,fill,groups,stuck_groups,error_min,error_max,"
            "normal_deviation_max,uv_deviation_max\n"
            "0,\"patch\",0,4,2048,1100,0,1,1,0,0,0,0,0\n"
            "0,\"patch\",1,2,1024,550,0,0.75,1,0,0.001,0.01,0,0\n"
            "0,\"patch\",2,1,512,275,0,0.5,1,0,0.1,0.1,,\n");
  EXPECT_EQ(info_csv(sample(), three_levels(), true),
            "mesh,name,group,level,reason,clusters,triangles\n0,\"patch\",7,2,\"" +
                std::string(format::name_of(format::StuckReason::kLocked)) + "\",3,99\n");
}

}  // namespace
}  // namespace meshlode::app
