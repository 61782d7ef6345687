// SPDX-License-Identifier: GPL-3.0-or-later
// A comparison against what each asset says of itself.
#include "app/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/export/build_scene.h"
#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "scene/scene.h"

namespace meshlode::app {
namespace {

using Json = nlohmann::json;

run::Asset asset_of(const scene::Scene& scene) {
  return run::Asset::from_vector(test::build_bytes(scene)).value();
}

Json compared(const run::Asset& before, const run::Asset& after) {
  return Json::parse(comparison_json(compare_assets(before, after)));
}

Json described(const run::Asset& asset) {
  return Json::parse(info_json(asset, describe_asset(asset), false));
}

/// Every change is that of the two figures; \returns how many there are.
std::size_t check_change(const Json& change, const Json& before, const Json& after) {
  EXPECT_EQ(change.at("old"), before);
  EXPECT_EQ(change.at("new"), after);
  if (before.is_null() && after.is_null()) return 1;  // equal, or not there
  if (before.is_null() || after.is_null()) {
    EXPECT_TRUE(change.at("change").is_null());
    EXPECT_TRUE(change.at("ratio").is_null());
    return 1;
  }
  const double a = before.get<double>(), b = after.get<double>();
  EXPECT_NEAR(change.at("change").get<double>(), b - a, 1e-6 * std::max(std::abs(a), std::abs(b)));
  if (a == b) {
    EXPECT_EQ(change.at("ratio"), 1.0);
  } else if (a == 0.0) {
    EXPECT_TRUE(change.at("ratio").is_null());
  } else {
    EXPECT_NEAR(change.at("ratio").get<double>(), b / a, 1e-6 * std::abs(b / a));
  }
  return 1;
}

TEST(Change, IsTheDifferenceAndTheRatioWhereThereAreSuch) {
  const auto change = [](std::optional<double> a, std::optional<double> b) { return Change{"x", a, b}; };
  EXPECT_EQ(change(4.0, 5.0).difference(), 1.0);
  EXPECT_EQ(change(4.0, 5.0).ratio(), 1.25);
  EXPECT_EQ(change(0.0, 0.0).ratio(), 1.0);
  EXPECT_EQ(change(0.0, 3.0).difference(), 3.0);
  EXPECT_EQ(change(0.0, 3.0).ratio(), std::nullopt);
  EXPECT_EQ(change(std::nullopt, 3.0).difference(), std::nullopt);
  EXPECT_EQ(change(std::nullopt, std::nullopt).ratio(), std::nullopt);
  const auto infinite = static_cast<double>(format::kInfiniteError);
  EXPECT_EQ(change(infinite, infinite).difference(), 0.0);
  EXPECT_EQ(change(infinite, infinite).ratio(), 1.0);
  EXPECT_EQ(change(1.0, infinite).ratio(), std::nullopt);
  EXPECT_EQ(change(infinite, 1.0).difference(), std::nullopt);
}

TEST(Change, OfWhatIsNotComparableThereIsNone) {
  Change same{"", 2.0, 2.0, Change::Kind::kDouble, false}, other{"", 2.0, 1.0, Change::Kind::kDouble, false};
  for (const Change& one : {same, other}) {
    EXPECT_EQ(one.difference(), std::nullopt);
    EXPECT_EQ(one.ratio(), std::nullopt);
  }
}

run::Asset asset_of_tier(const scene::Scene& scene, format::ErrorTier tier) {
  builder::PipelineOptions options;
  options.error_tier = tier;
  builder::PipelineReport report;
  return run::Asset::from_vector(builder::build_lode(scene, options, {}, report).value()).value();
}

TEST(Compare, ErrorsOfDifferentTiersAreNotComparable) {
  const scene::Scene scene = test::make_rock_scene(24);
  const run::Asset measured = asset_of_tier(scene, format::ErrorTier::kMeasured);
  const run::Asset qem = asset_of_tier(scene, format::ErrorTier::kQem);
  const AssetComparison comparison = compare_assets(measured, qem);
  const Json mesh = Json::parse(comparison_json(comparison)).at("meshes")[0];
  EXPECT_EQ(mesh.at("error_tier"), (Json{{"old", "measured"}, {"new", "qem"}, {"comparable", false}}));
  ASSERT_GT(mesh.at("by_level").size(), 1U);
  for (const Json& level : mesh.at("by_level")) {
    for (const char* error : {"error_min", "error_max"}) {
      EXPECT_TRUE(level.at(error).at("change").is_null());
      EXPECT_TRUE(level.at(error).at("ratio").is_null());
    }
    EXPECT_FALSE(level.at("triangles").at("ratio").is_null()) << "what is counted is comparable";
  }
  EXPECT_FALSE(mesh.at("level0_deviation").at("ratio").is_null()) << "how far the grid moves a vertex is no estimate";
  EXPECT_NE(comparison_text(comparison).find("not comparable in 1 of 1 meshes"), std::string::npos);
  EXPECT_TRUE(tiers_text(compare_assets(qem, qem)).empty());
  // What nobody knows breaks what bounds it from above.
  const auto breaks = [&](const char* condition) {
    const auto budget = read_budget(condition, compare_schema());
    EXPECT_TRUE(budget.ok()) << budget.error().detail;
    return !judge_budget(*budget, comparison_json(comparison))->empty();
  };
  EXPECT_TRUE(breaks("any(meshes).any(by_level).error_max.ratio>1.05"));
  EXPECT_FALSE(breaks("any(meshes).any(by_level).error_max.ratio<1"));
  EXPECT_TRUE(breaks("any(meshes).error_tier.comparable==false"));
}

TEST(Compare, AnAssetIsEqualToItself) {
  const run::Asset asset = asset_of(test::make_rock_scene(8));
  const AssetComparison comparison = compare_assets(asset, asset);
  const Json json = Json::parse(comparison_json(comparison));
  EXPECT_EQ(json.at("content_equal"), true);
  EXPECT_EQ(json.at("source_equal"), true);
  for (const char* list : {"settings", "meshes_added", "meshes_removed", "materials_changed", "materials_added",
                           "materials_removed", "images_changed", "images_added", "images_removed", "failed"}) {
    EXPECT_TRUE(json.at(list).empty()) << list;
  }
  EXPECT_EQ(json.at("meshes").size(), 1U);
  EXPECT_TRUE(json.at("picture").is_null());
  EXPECT_NE(comparison_text(comparison).find("no number differs"), std::string::npos);
  EXPECT_EQ(comparison_text(comparison).find("not in these tables"), std::string::npos);
  AssetComparison moved = comparison;  // one vertex, say
  moved.is_content_equal = false;
  EXPECT_NE(comparison_text(moved).find("not in these tables"), std::string::npos);
  const auto budget = read_budget(
      "file_bytes.ratio!=1, any(meshes).levels.change!=0, any(sections).bytes.ratio!=1, "
      "any(meshes).any(by_level).error_max.change!=0, content_equal==false",
      compare_schema());
  ASSERT_TRUE(budget.ok()) << budget.error().detail;
  EXPECT_TRUE(judge_budget(*budget, comparison_json(comparison))->empty());
}

TEST(Compare, SaysOfBothWhatInfoSaysOfEach) {
  const run::Asset small = asset_of(test::make_rock_scene(8)), large = asset_of(test::make_rock_scene(20));
  const Json json = compared(small, large), before = described(small), after = described(large);
  EXPECT_EQ(json.at("content_equal"), false);
  EXPECT_EQ(json.at("old").at("content_hash"), before.at("content_hash"));
  EXPECT_EQ(json.at("new").at("content_hash"), after.at("content_hash"));
  for (const char* key : {"file_bytes", "geometry_bytes", "image_bytes"}) {
    check_change(json.at(key), before.at(key), after.at(key));
  }
  std::size_t checked = 0;
  for (const auto& [key, value] : before.at("totals").items()) {
    checked += check_change(json.at("totals").at(key), value, after.at("totals").at(key));
  }
  EXPECT_EQ(checked + 2, json.at("totals").size());  // materials and images are lists of info
  for (const auto& [key, value] : before.at("dropped").items()) {
    check_change(json.at("dropped").at(key), value, after.at("dropped").at(key));
  }
  const Json& mesh = json.at("meshes").at(0);
  const Json &mesh_before = before.at("meshes").at(0), &mesh_after = after.at("meshes").at(0);
  for (const auto& [key, value] : mesh.items()) {
    if (!value.is_object() || key == "levels" || key == "error_tier") continue;
    check_change(value, mesh_before.at(key), mesh_after.at(key));
  }
  EXPECT_EQ(mesh.at("error_tier").at("old"), mesh_before.at("error_tier"));
  EXPECT_EQ(mesh.at("error_tier").at("new"), mesh_after.at("error_tier"));
  const Json &levels_before = mesh_before.at("levels"), &levels_after = mesh_after.at("levels");
  EXPECT_LT(levels_before.size(), levels_after.size());
  check_change(mesh.at("levels"), levels_before.size(), levels_after.size());
  ASSERT_EQ(mesh.at("by_level").size(), levels_after.size());
  for (std::size_t i = 0; i < levels_after.size(); ++i) {
    for (const auto& [key, value] : mesh.at("by_level").at(i).items()) {
      if (!value.is_object()) continue;
      const Json old_figure = i < levels_before.size() ? levels_before.at(i).at(key) : Json();
      check_change(value, old_figure, levels_after.at(i).at(key));
    }
  }
  for (const Json& section : json.at("sections")) {
    for (const Json& own : after.at("sections")) {
      if (own.at("name") != section.at("name")) continue;
      EXPECT_EQ(section.at("bytes").at("new"), own.at("bytes"));
    }
  }
}

TEST(Compare, MeshesMaterialsAndSettingsThatDifferAreNamed) {
  scene::Scene scene = test::make_rock_scene(8);
  const run::Asset before = asset_of(scene);
  scene::SourceMesh moss = scene.meshes[0];
  moss.name = "moss";
  scene.meshes.push_back(std::move(moss));
  scene.instances.push_back(scene.instances[0]);
  scene.instances.back().mesh = MeshId(1U);
  const std::string red = R"({"name": "red"})";
  const std::size_t at = scene.document.find(red);
  ASSERT_NE(at, std::string::npos);
  scene.document.replace(at, red.size(), R"({"name": "red", "emissiveFactor": [1, 0, 0]})");
  const run::Asset after = asset_of(scene);
  const Json json = compared(before, after);
  ASSERT_EQ(json.at("meshes_added").size(), 1U);
  EXPECT_EQ(json.at("meshes_added").at(0).at("name"), "moss");
  EXPECT_EQ(json.at("meshes_added").at(0).at("index"), 1);
  EXPECT_EQ(json.at("meshes").at(0).at("name"), "rock");
  ASSERT_EQ(json.at("materials_changed").size(), 1U);
  EXPECT_EQ(json.at("materials_changed").at(0).at("what"), Json::array({"emissiveFactor"}));
  const Json back = compared(after, before);
  ASSERT_EQ(back.at("meshes_removed").size(), 1U);
  EXPECT_EQ(back.at("meshes_removed").at(0).at("index"), 1);
  const std::string text = comparison_text(compare_assets(before, after));
  EXPECT_NE(text.find("added: 1  moss"), std::string::npos) << text;
  EXPECT_NE(text.find("emissiveFactor"), std::string::npos) << text;
}

TEST(Compare, AMeshWithAnotherNameAndTheSameNumbersIsTold) {
  scene::Scene scene = test::make_rock_scene(8);
  const run::Asset before = asset_of(scene);
  scene.meshes[0].name = "boulder";
  const AssetComparison comparison = compare_assets(before, asset_of(scene));
  EXPECT_NE(comparison_text(comparison).find("renamed: 0  boulder, formerly rock\n"), std::string::npos);
  EXPECT_EQ(Json::parse(comparison_json(comparison)).at("meshes").at(0).at("old_name"), "rock");
}

TEST(Compare, AFigureThatWasNotMeasuredIsCalledSo) {
  AssetComparison comparison;
  comparison.totals = {
      {"deviation", 0.5, static_cast<double>(format::kInfiniteError), Change::Kind::kFloat},
      {"clusters", std::nullopt, 7.0, Change::Kind::kCount},
  };
  const std::string text = comparison_text(comparison);
  EXPECT_NE(text.find("0.5  not measured            -       -\n"), std::string::npos) << text;
  EXPECT_NE(text.find("-             7            -       -\n"), std::string::npos) << text;
}

run::Asset tree_with_leaves(AggregateChoice choice) {
  scene::SourceMesh tree = lab::as_mesh(lab::make_rock(8));
  tree.name = "tree";
  tree.primitives.push_back(lab::make_foliage(300));
  for (std::uint32_t m = 0; m < 2; ++m) tree.primitives[m].material = MaterialId(m);
  scene::Scene scene = lab::as_scene(std::move(tree));
  scene.materials.resize(2, scene.materials[0]);
  builder::PipelineOptions options;
  options.aggregate = choice;
  options.error_tier = format::ErrorTier::kQem;
  builder::PipelineReport report;
  return run::Asset::from_vector(builder::build_lode(scene, options, {}, report).value()).value();
}

TEST(Compare, AMeshIsComparedWithWhatItAndItsPartAreTogether) {
  const run::Asset one = tree_with_leaves(AggregateChoice::kNever), two = tree_with_leaves(AggregateChoice::kAlways);
  ASSERT_EQ(one.meshes().size(), 1U);
  ASSERT_EQ(two.meshes().size(), 2U);
  const Json change = compared(one, two);
  ASSERT_EQ(change.at("meshes").size(), 1U);
  EXPECT_TRUE(change.at("meshes_added").empty());
  EXPECT_TRUE(change.at("meshes_removed").empty());
  const Json &mesh = change.at("meshes")[0], whole = described(one).at("meshes")[0],
             parts = described(two).at("meshes");
  EXPECT_EQ(mesh.at("source_triangles").at("ratio"), 1.0);
  std::size_t checked = 0;
  for (const char* key : {"clusters", "stored_triangles", "stored_vertices", "groups", "roots"}) {
    const auto sum = parts[0].at(key).get<std::uint64_t>() + parts[1].at(key).get<std::uint64_t>();
    checked += check_change(mesh.at(key), whole.at(key), sum);
  }
  EXPECT_EQ(checked, 5U);
  const auto level1 = [&](const char* key) {
    return parts[0].at("levels")[1].at(key).get<double>() + parts[1].at("levels")[1].at(key).get<double>();
  };
  EXPECT_EQ(mesh.at("by_level")[1].at("triangles").at("new"), level1("triangles"));
  EXPECT_EQ(compared(two, one).at("meshes").size(), 1U);
  EXPECT_EQ(compared(two, two).at("meshes").size(), 2U) << "each with its own";
}

TEST(Compare, AFailedConditionIsInTheDocument) {
  const run::Asset asset = asset_of(test::make_rock_scene(8));
  const AssetComparison comparison = compare_assets(asset, asset);
  const auto budget = read_budget("totals.meshes.new>0", compare_schema());
  ASSERT_TRUE(budget.ok());
  const auto broken = judge_budget(*budget, comparison_json(comparison));
  ASSERT_TRUE(broken.ok());
  const Json json = Json::parse(comparison_json(comparison, *broken));
  ASSERT_EQ(json.at("failed").size(), 1U);
  EXPECT_EQ(json.at("failed").at(0).at("where"), "totals.meshes.new");
  EXPECT_EQ(json.at("failed").at(0).at("value"), 1);
}

}  // namespace
}  // namespace meshlode::app
