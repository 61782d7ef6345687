// SPDX-License-Identifier: GPL-3.0-or-later
// Stuck groups: told with their reason, and shown as they are, in a colour for each reason.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "app/export/colored_sets.h"
#include "app/report/info.h"
#include "build_scene.h"
#include "builder/odd_shapes.h"
#include "format/names.h"
#include "judge/validate/edit.h"
#include "lab/samples/samples.h"
#include "meshlode/extract_stuck.h"

namespace meshlode::app {
namespace {

/// Triangles between random points of a lattice: non-manifold everywhere, so that nothing can be simplified.
const std::vector<std::uint8_t>& stuck_bytes() {
  static const auto bytes =
      test::build_bytes(lab::as_scene(lab::as_mesh(test::make_lattice_chaos(20000, 8, 7), "chaos")));
  return bytes;
}

run::Asset open(std::vector<std::uint8_t> bytes) {
  auto asset = run::Asset::from_vector(std::move(bytes));
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  return std::move(*asset);
}

/// Every group that is stuck gets another reason, in turn.
std::vector<std::uint8_t> with_all_reasons() {
  test::AssetEdit edit(stuck_bytes());
  std::uint32_t next = 0;
  for (std::size_t g = 0; g < edit.groups().size(); ++g) {
    if ((edit.groups()[g].flags & format::kGroupStuck) == 0) continue;
    edit.group(g, [&](auto& r) { r.stuck_reason = static_cast<format::StuckReason>(1 + next++ % 7); });
  }
  edit.seal();
  return edit.bytes();
}

struct TempFile {
  std::string path =
      (std::filesystem::temp_directory_path() / ("meshlode-stuck-" + std::to_string(::getpid()))).string();
  ~TempFile() { std::filesystem::remove(path); }
  [[nodiscard]] test::Glb read() const {
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
    return test::Glb::parse({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }
};

TEST(Stuck, ASceneThatCannotBeSimplifiedHasAReasonForEachGroup) {
  const run::Asset asset = open(stuck_bytes());
  const AssetInfo info = describe_asset(asset);
  ASSERT_GT(info.stuck_groups, 1U);
  std::uint64_t listed = 0;
  for (const StuckGroupInfo& stuck : info.meshes[0].stuck) {
    EXPECT_NE(stuck.reason, format::StuckReason::kNotStuck);
    ++listed;
  }
  EXPECT_EQ(listed, info.stuck_groups);
  const std::string text = info_text(asset, info, true);
  const auto json = nlohmann::json::parse(info_json(asset, info, true));
  EXPECT_EQ(json.at("stuck").size(), info.stuck_groups);
  std::uint64_t by_reason = 0;
  for (const auto& [reason, count] : json.at("meshes")[0].at("stuck_reasons").items()) {
    by_reason += count.get<std::uint64_t>();
    EXPECT_NE(text.find(reason), std::string::npos);
  }
  EXPECT_EQ(by_reason, info.stuck_groups);
}

/// What a locked border holds was asked for: it is listed, and counts against nobody's budget.
TEST(Stuck, GroupsOfLockedBordersAreListedAndNotCounted) {
  const run::Asset asset = open(with_all_reasons());
  const AssetInfo info = describe_asset(asset);
  const auto json = nlohmann::json::parse(info_json(asset, info, true));
  const auto& mesh = json.at("meshes")[0];
  std::uint64_t by_reason = 0, by_level = 0;
  for (const auto& [reason, count] : mesh.at("stuck_reasons").items()) by_reason += count.get<std::uint64_t>();
  for (const auto& level : mesh.at("levels")) by_level += level.at("stuck_groups").get<std::uint64_t>();
  const auto of_borders = mesh.at("stuck_reasons").at("border").get<std::uint64_t>();
  EXPECT_GT(of_borders, 0U);
  EXPECT_EQ(info.border_groups, of_borders);
  EXPECT_EQ(info.stuck_groups, by_reason - of_borders);
  EXPECT_EQ(json.at("totals").at("stuck_groups"), info.stuck_groups);
  EXPECT_EQ(mesh.at("stuck_groups"), info.stuck_groups);
  EXPECT_EQ(by_level, info.stuck_groups);
  EXPECT_EQ(json.at("stuck").size(), by_reason);
}

TEST(Stuck, TheGlbHasTheStuckTrianglesAndAColourForEachReason) {
  const run::Asset asset = open(with_all_reasons());
  const AssetInfo info = describe_asset(asset);
  std::map<std::string, std::uint64_t> expected;
  std::uint64_t total = 0;
  for (const StuckGroupInfo& stuck : info.meshes[0].stuck) {
    expected[format::name_of(stuck.reason)] += stuck.triangles;
    total += stuck.triangles;
  }
  ASSERT_EQ(expected.size(), 7U) << "enough groups for every reason";
  const TempFile file;
  const cli::FileOutcome outcome = cli::extract_stuck(asset, file.path, {.format = "json"});
  EXPECT_EQ(outcome.exit_code, 0);
  const auto told = nlohmann::json::parse(outcome.text);
  EXPECT_EQ(told.at("triangles"), total);
  const test::Glb glb = file.read();
  glb.expect_sound();
  std::map<std::string, std::uint64_t> found;
  std::vector<nlohmann::json> colors;
  for (const auto& material : glb.json.at("materials")) {
    colors.push_back(material.at("pbrMetallicRoughness").at("baseColorFactor"));
  }
  for (const auto& primitive : glb.json.at("meshes")[0].at("primitives")) {
    const auto& material = glb.json.at("materials").at(primitive.at("material").get<std::size_t>());
    found[material.at("name")] += glb.rows(primitive.at("indices").get<std::size_t>()).size() / 3;
  }
  EXPECT_EQ(found, expected);
  for (const auto& [reason, triangles] : expected) EXPECT_EQ(told.at("stuck").at(reason).at("triangles"), triangles);
  std::sort(colors.begin(), colors.end());
  EXPECT_EQ(std::unique(colors.begin(), colors.end()), colors.end());

  // The triangles themselves: those of the stuck groups' clusters, where the asset has them.
  std::vector<ClusterId> clusters;
  for (const StuckGroupInfo& stuck : info.meshes[0].stuck) {
    const format::GroupRecord& group = asset.groups()[stuck.group];
    for (std::uint32_t c = 0; c < group.cluster_count; ++c) clusters.emplace_back(group.first_cluster + c);
  }
  auto placed = test::triangles_of(glb, 0), stored = test::expected_triangles(asset, MeshId(0U), clusters);
  for (auto& t : placed) t.material = -1;
  for (auto& t : stored) t.material = -1;
  std::sort(placed.begin(), placed.end());
  std::sort(stored.begin(), stored.end());
  EXPECT_EQ(placed, stored);
}

TEST(Stuck, AnAssetWithoutStuckGroupsGivesAGltfWithoutMeshes) {
  const run::Asset asset = open(test::build_bytes(test::make_rock_scene()));
  ASSERT_EQ(describe_asset(asset).stuck_groups, 0U);
  const TempFile file;
  const cli::FileOutcome outcome = cli::extract_stuck(asset, file.path, {});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.text.find("no stuck group"), std::string::npos);
  const test::Glb glb = file.read();
  EXPECT_TRUE(glb.json.contains("asset"));
  EXPECT_FALSE(glb.json.contains("meshes"));
}

TEST(Stuck, SetsOfOtherMeshesClustersAreRefused) {
  const run::Asset asset = open(stuck_bytes());
  const auto count = asset.meshes()[0].cluster_count;
  const ColoredSet wrong{MeshId(0U), "x", {1.0F, 0.0F, 0.0F}, {ClusterId(count)}};
  const auto refused = export_colored_sets(asset, std::span(&wrong, 1));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace meshlode::app
