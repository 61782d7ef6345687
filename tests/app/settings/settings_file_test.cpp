// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settings/settings_file.h"
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "base/glob.h"
#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"

namespace meshlode::app {
namespace {

namespace fs = std::filesystem;

std::string fault_of(std::string_view text) {
  const auto layer = parse_settings(text, "f");
  return layer ? "" : layer.error().message();
}

TEST(SettingsFile, HasTheNamesOfTheOptions) {
  const auto layer = parse_settings(R"({"$schema": "x", "preset": "fast", "grid": 0.5, "normal-error": 2,
    "uv-error": "0.25px", "repair": true, "keep-topology": true, "lock-borders": true, "aggregate": "auto", "keep": ["NORMAL", "COLOR_0"], "drop": "TEXCOORD_1"})",
                                    "f");
  ASSERT_TRUE(layer) << layer.error().message();
  const auto settled = settle({&*layer, 1});
  ASSERT_TRUE(settled) << settled.error().message();
  EXPECT_EQ(settled->options.preset, Preset::kFast);
  EXPECT_EQ(settled->options.grid_step, 0.5);
  EXPECT_EQ(settled->options.normal_error, 2.0);
  EXPECT_EQ(settled->options.uv_error, 0.25);
  EXPECT_TRUE(settled->options.repair);
  EXPECT_TRUE(settled->options.keep_topology);
  EXPECT_TRUE(settled->options.lock_borders);
  EXPECT_EQ(settled->options.aggregate, AggregateChoice::kAuto);
  EXPECT_EQ(settled->options.keep, kAttributeNormal | kAttributeColor);
  EXPECT_EQ(settled->options.drop, attribute_texcoord(1));
  EXPECT_EQ((*settled)[Setting::kGrid].from, "f");
}

TEST(SettingsFile, NumbersKeepTheirBits) {
  const auto layer = parse_settings(R"({"grid": 0.1000000000000000055511151231257827, "position-error": "auto"})", "f");
  ASSERT_TRUE(layer);
  EXPECT_EQ(settle({&*layer, 1})->options.grid_step, 0.1);
}

TEST(SettingsFile, UnknownKeysAreRefusedWithTheNearest) {
  EXPECT_EQ(fault_of(R"({"normal_eror": 1})"),
            "f: /normal_eror: no setting has this name; the nearest is normal-error");
  EXPECT_EQ(fault_of(R"({"mesh": {}})"), "f: /mesh: no setting has this name; the nearest is meshes");
  EXPECT_EQ(fault_of(R"({"jobs": 1})"), "f: /jobs: is given on the command line alone");
  EXPECT_EQ(fault_of(R"({"meshes": {"a*": {"gird": 1}}})"),
            "f: /meshes/a*/gird: no setting has this name; the nearest is grid");
  EXPECT_EQ(fault_of(R"({"meshes": {"a*": {"codec": "lz4"}}})"),
            "f: /meshes/a*/codec: is a setting of the whole scene");
}

TEST(SettingsFile, HostileTextsAreErrors) {
  std::string rules = R"({"meshes":{)";
  for (int i = 0; i < 1001; ++i) rules += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":{}";
  const std::string deep = std::string(100000, '[');
  for (const std::string& text : {std::string(),
                                  std::string("["),
                                  std::string("[]"),
                                  std::string("1"),
                                  std::string("{\"grid\":}"),
                                  std::string("{\"grid\":1,\"grid\":2}"),
                                  std::string("{\"grid\":true}"),
                                  std::string("{\"grid\":1e999}"),
                                  std::string("{\"grid\":-1}"),
                                  std::string("{\"codec\":4}"),
                                  std::string("{\"repair\":\"true\"}"),
                                  std::string("{\"keep-topology\":1}"),
                                  std::string("{\"lock-borders\":\"yes\"}"),
                                  std::string("{\"keep\":[1]}"),
                                  std::string("{\"keep\":[\"NORMAL,\"]}"),
                                  std::string("{\"keep\":\"TANGENT\"}"),
                                  std::string("{\"keep\":\"all\",\"drop\":\"NORMAL\"}"),
                                  std::string("{\"grid\":1,\"position-error\":1}"),
                                  std::string("{\"meshes\":[]}"),
                                  std::string("{\"meshes\":{\"a\":1}}"),
                                  std::string("{\"meshes\":{\"a\":{\"grid\":1,\"position-error\":1}}}"),
                                  std::string("{\"meshes\":{\"a\":{\"meshes\":{}}}}"),
                                  "{\"" + std::string(5000, 'x') + "\":1}",
                                  "{\"meshes\":{\"" + std::string(257, '*') + "\":{}}}",
                                  rules + "}}",
                                  deep,
                                  "{\"grid\":" + deep,
                                  std::string("{\"\xFF\":1}"),
                                  std::string(1U << 21U, ' ')}) {
    const auto layer = parse_settings(text, "f");
    ASSERT_FALSE(layer) << text.substr(0, 100);
    EXPECT_EQ(layer.error().code, ErrorCode::kInvalid);
    EXPECT_LT(layer.error().message().size(), 1000U);
  }
}

TEST(Globs, MatchWholeNames) {
  EXPECT_TRUE(is_match("*", ""));
  EXPECT_TRUE(is_match("", ""));
  EXPECT_TRUE(is_match("wall*", "wall"));
  EXPECT_TRUE(is_match("*wall*", "the wall is long"));
  EXPECT_TRUE(is_match("w?ll", "wall"));
  EXPECT_TRUE(is_match("*a*b*", "xxaxxabx"));
  EXPECT_TRUE(is_match("a*ab", "aab"));
  EXPECT_FALSE(is_match("", "a"));
  EXPECT_FALSE(is_match("wall", "walls"));
  EXPECT_TRUE(is_match_of_any("door,w*", "wall"));
  EXPECT_FALSE(is_match_of_any("door,,window", ""));
  EXPECT_FALSE(is_match_of_any("", "wall"));
  EXPECT_FALSE(is_match("?", ""));
  EXPECT_FALSE(is_match("*b", "abc"));
  EXPECT_FALSE(is_match("WALL", "wall"));
  EXPECT_FALSE(is_match(std::string(128, '*') + "b", std::string(100000, 'a'))) << "and soon";
}

TEST(MeshRules, ComeAfterTheirLayersWordsAndBeforeTheNextLayer) {
  const std::array layers{
      *parse_settings(R"({"normal-error": 1, "meshes": {"r*": {"normal-error": 2}, "rock": {"grid": 0.5}}})", "far"),
      *parse_settings(R"({"position-error": 0.1, "meshes": {"rust": {"error-tier": "certified"}}})", "near")};
  const std::vector<std::string> names{"rock", "rust", "tree"};
  const auto meshes = settle_meshes(layers, names);
  ASSERT_TRUE(meshes) << meshes.error().message();
  ASSERT_EQ(meshes->size(), 3U);
  EXPECT_EQ((*meshes)[0].options.normal_error, 2.0);
  EXPECT_EQ((*meshes)[0].options.grid_step, 0.0) << "the nearer file's position error excludes it";
  EXPECT_EQ((*meshes)[0].options.position_error, 0.1);
  EXPECT_EQ((*meshes)[1].options.error_tier, format::ErrorTier::kCertified);
  EXPECT_EQ((*meshes)[1].options.normal_error, 2.0);
  EXPECT_TRUE((*meshes)[2].own.empty());
  ASSERT_EQ((*meshes)[0].own.size(), 1U);
  EXPECT_EQ((*meshes)[0].own[0].first, Setting::kNormalError);
  EXPECT_EQ((*meshes)[0].own[0].second.from, "far: meshes/r*");

  const std::array with_call{layers[0], SettingLayer{"the command line", ErrorCode::kUsage, {}, {}}};
  auto call = with_call;
  call[1][Setting::kNormalError] = "3";
  const auto called = settle_meshes(call, names);
  ASSERT_TRUE(called);
  for (const SettledMesh& mesh : *called) EXPECT_EQ(mesh.options.normal_error, 3.0);
  EXPECT_TRUE(settle_meshes(layers, std::vector<std::string>{"tree"})->empty()) << "no rule matches any";
}

TEST(MeshRules, OptionsOfMeshesReachTheAsset) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_sphere(8), "fine"));
  scene.meshes.push_back(lab::as_mesh(lab::make_sphere(8), "coarse"));
  scene.instances.emplace_back().mesh = MeshId(1U);
  const std::array layers{
      *parse_settings(R"({"meshes": {"coarse": {"position-error": 0.01, "error-tier": "qem"}}})", "f")};
  builder::PipelineOptions options = settle(layers)->options;
  ASSERT_TRUE(set_mesh_options(layers, std::vector<std::string>{"fine", "coarse"}, options));
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  ASSERT_TRUE(bytes) << bytes.error().message();
  const auto asset = run::Asset::from_vector(std::move(*bytes));
  ASSERT_TRUE(asset);
  EXPECT_EQ(asset->meshes()[0].error_tier, format::ErrorTier::kMeasured);
  EXPECT_EQ(asset->meshes()[1].error_tier, format::ErrorTier::kQem);
  EXPECT_LT(asset->meshes()[0].level0_deviation, asset->meshes()[1].level0_deviation);
  EXPECT_NE(asset->meta_json().find(R"("mesh_settings":[{"meshes":[1],"error_tier":"qem")"), std::string::npos);

  // A mesh whose own are the whole's is as if it had none.
  builder::PipelineOptions same = settle({})->options;
  same.mesh_options.assign(2, same);
  const auto with = builder::build_lode(scene, same, {}, report);
  const auto without = builder::build_lode(scene, settle({})->options, {}, report);
  EXPECT_TRUE(*with == *without);
  same.mesh_options.pop_back();
  EXPECT_FALSE(builder::build_lode(scene, same, {}, report)) << "one for each mesh";
}

TEST(SettingsFile, APageSizeIsANumberOrItsText) {
  for (const char* text :
       {R"({"page-size": 32, "root-bytes": 65536})", R"({"page-size": "32", "root-bytes": "65536"})"}) {
    const auto layer = parse_settings(text, "f");
    ASSERT_TRUE(layer) << layer.error().message();
    EXPECT_EQ(settle({&*layer, 1})->options.page_kib, 32U);
    EXPECT_EQ(settle({&*layer, 1})->options.root_bytes, 65536U);
  }
  for (const char* text : {R"({"page-size": 48})", R"({"page-size": 32.5})", R"({"page-size": true})",
                           R"({"root-bytes": 16383})", R"({"page-order": 1})"}) {
    EXPECT_FALSE(parse_settings(text, "f")) << text;
  }
}

class SettingsFolders : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    fs::create_directories(root_ / "in/deep");
  }
  void TearDown() override { fs::remove_all(root_); }
  void write(const std::string& folder, const std::string& text) const {
    std::ofstream(root_ / folder / kSettingsFileName) << text;
  }

  fs::path root_ = fs::path(::testing::TempDir()) / ("settings_folders_" + std::to_string(::getpid()));
};

TEST_F(SettingsFolders, AreReadFromTheRootDown) {
  write("", R"({"preset": "fast"})");
  write("in", R"({"preset": "default"})");
  write("in/deep", R"({"preset": "best"})");
  const auto presets = [&](const fs::path& scene, const fs::path& root) {
    std::vector<FileId> read;
    const auto layers = read_settings_files(scene, root, read);
    EXPECT_TRUE(layers);
    std::string out;
    for (SettingLayer layer : *layers) out += *layer[Setting::kPreset] + " ";
    EXPECT_EQ(read.size(), layers->size());
    return out;
  };
  EXPECT_EQ(presets(root_ / "in/deep/a.glb", root_ / "in"), "default best ");
  EXPECT_EQ(presets(root_ / "in/deep/a.glb", root_ / "in/"), "default best ");
  EXPECT_EQ(presets(root_ / "in/deep/a.glb", root_), "fast default best ");
  EXPECT_EQ(presets(root_ / "in/deep/a.glb", ""), "best ");
  EXPECT_EQ(presets(root_ / "in/a.glb", root_ / "in"), "default ");
  EXPECT_EQ(presets(root_ / "in/a.glb", root_ / "in/deep"), "default ") << "no folder above the scene";
  fs::remove(root_ / "in" / kSettingsFileName);
  EXPECT_EQ(presets(root_ / "in/deep/a.glb", root_), "fast best ");
}

TEST_F(SettingsFolders, AFolderOfThatNameIsAnError) {
  fs::create_directories(root_ / "in" / kSettingsFileName);
  std::vector<FileId> read;
  const auto layers = read_settings_files(root_ / "in/a.glb", {}, read);
  ASSERT_FALSE(layers);
  EXPECT_EQ(layers.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace meshlode::app
