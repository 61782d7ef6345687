// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settings/settings.h"

#include <gtest/gtest.h>

#include "builder/preset.h"

namespace meshlode::app {
namespace {

SettingLayer layer_of(std::initializer_list<std::pair<Setting, const char*>> words, std::string from = "a file",
                      ErrorCode code = ErrorCode::kInvalid) {
  SettingLayer layer{std::move(from), code, {}, {}};
  for (const auto& [setting, word] : words) layer[setting] = word;
  return layer;
}

TEST(Settings, WithoutLayersTheyAreTheDefaults) {
  const auto settled = settle({});
  ASSERT_TRUE(settled);
  const builder::PipelineOptions usual;
  EXPECT_EQ(settled->options.preset, usual.preset);
  EXPECT_EQ(settled->options.error_tier, usual.error_tier);
  EXPECT_EQ(settled->options.attributes, usual.attributes);
  EXPECT_EQ(settled->options.grid_step, usual.grid_step);
  EXPECT_EQ(settled->options.position_error, usual.position_error);
  EXPECT_EQ(settled->options.normal_error, usual.normal_error);
  EXPECT_EQ(settled->options.uv_error, usual.uv_error);
  EXPECT_EQ(settled->options.uv_error_is_texels, usual.uv_error_is_texels);
  EXPECT_EQ(settled->options.uv_error_is_default, usual.uv_error_is_default);
  EXPECT_EQ(settled->options.codec, usual.codec);
  EXPECT_EQ(settled->options.repair, usual.repair);
  EXPECT_EQ(settled->options.keep_topology, usual.keep_topology);
  EXPECT_EQ(settled->options.lock_borders, usual.lock_borders);
  EXPECT_EQ(settled->options.aggregate, usual.aggregate);
  EXPECT_EQ(settled->options.promise, usual.promise);
  for (const SettledWord& word : settled->words) EXPECT_EQ(word.from, "default");
}

TEST(Settings, ThePresetSetsTheTierUnlessOneIsSaid) {
  const SettingLayer fast = layer_of({{Setting::kPreset, "fast"}});
  EXPECT_EQ(settle({&fast, 1})->options.error_tier, format::ErrorTier::kQem);
  const SettingLayer both = layer_of({{Setting::kPreset, "fast"}, {Setting::kErrorTier, "certified"}});
  EXPECT_EQ(settle({&both, 1})->options.error_tier, format::ErrorTier::kCertified);
}

TEST(Settings, TheLaterLayerWinsAndIsNamed) {
  const std::array layers{layer_of({{Setting::kCodec, "strips"}, {Setting::kNormalError, "0.5"}}, "far"),
                          layer_of({{Setting::kCodec, "none"}}, "near")};
  const auto settled = settle(layers);
  ASSERT_TRUE(settled);
  EXPECT_EQ(settled->options.codec, format::Codec::kNone);
  EXPECT_EQ((*settled)[Setting::kCodec].from, "near");
  EXPECT_EQ(settled->options.normal_error, 0.5);
  EXPECT_EQ((*settled)[Setting::kNormalError].from, "far");
  EXPECT_EQ((*settled)[Setting::kPreset].from, "default");
}

TEST(Settings, AGridAndAPositionErrorExcludeEachOther) {
  const SettingLayer both = layer_of({{Setting::kGrid, "0.5"}, {Setting::kPositionError, "0.1"}});
  const auto refused = settle({&both, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalid);
  EXPECT_EQ(refused.error().where, "a file: /position-error");

  const std::array layers{layer_of({{Setting::kGrid, "0.5"}}), layer_of({{Setting::kPositionError, "0.1"}})};
  const auto later = settle(layers);
  ASSERT_TRUE(later);
  EXPECT_EQ(later->options.grid_step, 0.0);
  EXPECT_EQ(later->options.position_error, 0.1);
  const std::array turned{layers[1], layers[0]};
  const auto grid = settle(turned);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->options.grid_step, 0.5);
  EXPECT_EQ(grid->options.position_error, 0.0);
}

TEST(Settings, ANameIsKeptOrDroppedByTheLaterLayer) {
  const std::array layers{layer_of({{Setting::kKeep, "NORMAL,COLOR_0"}}),
                          layer_of({{Setting::kDrop, "NORMAL"}}, "near")};
  const auto settled = settle(layers);
  ASSERT_TRUE(settled);
  EXPECT_EQ(settled->options.keep, kAttributeColor);
  EXPECT_EQ(settled->options.drop, kAttributeNormal);
  EXPECT_EQ((*settled)[Setting::kKeep].from, "near");

  const std::array anew{layers[0], layer_of({{Setting::kAttributes, "none"}}, "near")};
  EXPECT_EQ(settle(anew)->options.keep, 0U) << "a rule of a later layer begins anew";

  const SettingLayer both = layer_of({{Setting::kKeep, "all"}, {Setting::kDrop, "COLOR_0"}});
  const auto refused = settle({&both, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "a file: /drop");
}

TEST(Settings, ClustersHaveASize) {
  EXPECT_EQ(settle({})->options.max_cluster_triangles, 128U);
  const SettingLayer layer = layer_of({{Setting::kClusterTriangles, "64"}});
  EXPECT_EQ(settle({&layer, 1})->options.max_cluster_triangles, 64U);
  const SettingLayer groups = layer_of({{Setting::kGroupClusters, "12"}});
  EXPECT_EQ(settle({&groups, 1})->options.group_clusters, 12U);
  EXPECT_EQ(settle({})->options.group_clusters, 20U);
  const SettingLayer effort = layer_of({{Setting::kStripEffort, "best"}});
  EXPECT_EQ(settle({&effort, 1})->options.strip_effort, StripEffort::kBest);
  EXPECT_EQ(settle({})->options.strip_effort, StripEffort::kOfPreset);
}

TEST(Settings, UvErrorsKnowTheirUnit) {
  const SettingLayer texels = layer_of({{Setting::kUvError, "0.25px"}});
  EXPECT_TRUE(settle({&texels, 1})->options.uv_error_is_texels);
  EXPECT_EQ(settle({&texels, 1})->options.uv_error, 0.25);
  const SettingLayer units = layer_of({{Setting::kUvError, "0.001"}});
  EXPECT_FALSE(settle({&units, 1})->options.uv_error_is_texels);
  EXPECT_FALSE(settle({&units, 1})->options.uv_error_is_default);
}

TEST(Settings, WordsThatAreNoneAreRefusedWithTheNearest) {
  for (const auto& [setting, word] :
       std::initializer_list<std::pair<Setting, const char*>>{{Setting::kErrorTier, "exact"},
                                                              {Setting::kPreset, ""},
                                                              {Setting::kGrid, "0"},
                                                              {Setting::kGrid, "1e999"},
                                                              {Setting::kPositionError, "nan"},
                                                              {Setting::kPositionError, "-1"},
                                                              {Setting::kNormalError, "auto"},
                                                              {Setting::kKeep, "NORMALS"},
                                                              {Setting::kDrop, ","},
                                                              {Setting::kUvError, "px"},
                                                              {Setting::kUvError, "1 px"},
                                                              {Setting::kCodec, "gzip"},
                                                              {Setting::kClusterTriangles, "0"},
                                                              {Setting::kClusterTriangles, "257"},
                                                              {Setting::kClusterTriangles, "64.5"},
                                                              {Setting::kClusterTriangles, "-1"},
                                                              {Setting::kGroupClusters, "3"},
                                                              {Setting::kGroupClusters, "33"},
                                                              {Setting::kRepair, "1"}}) {
    EXPECT_FALSE(find_fault(setting, word).empty()) << info_of(setting).name << " " << word;
    const SettingLayer layer = layer_of({{setting, word}});
    EXPECT_FALSE(settle({&layer, 1})) << info_of(setting).name << " " << word;
  }
  EXPECT_NE(find_fault(Setting::kCodec, "strip").find("the nearest is strips"), std::string::npos);
}

TEST(Settings, AggregatesAreAChoiceOrNames) {
  const auto settled = [](const char* word) {
    const SettingLayer layer = layer_of({{Setting::kAggregate, word}});
    return settle({&layer, 1});
  };
  EXPECT_EQ(settled("auto")->options.aggregate, AggregateChoice::kAuto);
  EXPECT_EQ(settled("auto")->options.aggregate_names, "");
  EXPECT_EQ(settled("oak,leaf*")->options.aggregate, AggregateChoice::kNamed);
  EXPECT_EQ(settled("oak,leaf*")->options.aggregate_names, "oak,leaf*");
  EXPECT_FALSE(settled(""));
}

TEST(Settings, AUseDecidesWhatIsNotGiven) {
  const SettingLayer engine = layer_of({{Setting::kFor, "engine"}});
  const auto settled = settle({&engine, 1});
  ASSERT_TRUE(settled);
  EXPECT_EQ(settled->options.codec, format::Codec::kNone);
  EXPECT_EQ((*settled)[Setting::kCodec].from, "for engine");
  EXPECT_EQ(settled->options.page_kib, 32U);
  EXPECT_EQ(settled->options.page_order, PageOrder::kCovisible);
  EXPECT_EQ(describe_use(*settled), "for engine: codec none, page-size 32, page-order covisible");
  EXPECT_EQ(describe_use(*settle({})), "");
}

TEST(Settings, WhatIsGivenAnywhereWinsOverAUse) {
  const std::array layers{
      layer_of({{Setting::kCodec, "strips"}, {Setting::kPageSize, "128"}, {Setting::kPageOrder, "level"}}, "a file"),
      layer_of({{Setting::kFor, "engine"}}, "the command line")};
  const auto settled = settle(layers);
  EXPECT_EQ(settled->options.codec, format::Codec::kStrips);
  EXPECT_EQ((*settled)[Setting::kCodec].from, "a file");
  EXPECT_EQ(describe_use(*settled), "for engine: every setting is given");
}

TEST(Settings, TheLastUseCountsAloneAndMeshesHaveItToo) {
  std::array layers{layer_of({{Setting::kFor, "archive"}}), layer_of({{Setting::kFor, "web"}})};
  EXPECT_EQ(settle(layers)->options.error_tier, format::ErrorTier::kMeasured);
  layers[1].mesh_rules.push_back({"proxy", layer_of({{Setting::kAttributes, "none"}}).words});
  const std::vector<std::string> names{"proxy", "tree"};
  const auto meshes = settle_meshes(layers, names);
  ASSERT_TRUE(meshes);
  for (const SettledMesh& mesh : *meshes) EXPECT_EQ(mesh.options.normal_error, 0.5);
  const SettingLayer any = layer_of({{Setting::kFor, "any"}});
  EXPECT_EQ(settle({&any, 1})->options.normal_error, builder::PipelineOptions().normal_error);
}

TEST(Settings, AnUnknownUseIsRefusedWithTheNearest) {
  const SettingLayer wrong = layer_of({{Setting::kFor, "engines"}});
  const auto settled = settle({&wrong, 1});
  ASSERT_FALSE(settled);
  EXPECT_NE(settled.error().detail.find("engine"), std::string::npos) << settled.error().detail;
}

TEST(Settings, EachHasItsRow) {
  for (std::size_t i = 0; i < kSettingCount; ++i) {
    const SettingInfo& info = all_settings()[i];
    EXPECT_EQ(static_cast<std::size_t>(info.setting), i);
    EXPECT_EQ(find_fault(info.setting, info.usual), "") << info.name;
    for (const std::string& choice : choices_of(info.setting)) EXPECT_EQ(find_fault(info.setting, choice), "");
  }
}

}  // namespace
}  // namespace meshlode::app
