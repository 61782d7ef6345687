// SPDX-License-Identifier: GPL-3.0-or-later
// I7 for what is painted, on assets that were built: what is promised of texels and appearance is true, and where an
// asset promises too much, or counts in other units than it should, it is found (V209, V210).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "judge/metrics/coverage.h"
#include "judge/painted_ball.h"
#include "judge/validate/edit.h"
#include "judge/verify/promises.h"
#include "judge/verify/verify.h"
#include "meshlode/material_looks.h"
#include "run/read/asset.h"
#include "scene/import/gltf_builder.h"

namespace meshlode::judge {
namespace {

using test::AssetEdit;
using test::build_promised;
using test::Built;
using test::painted_scene;

const Built& painted_ball() {
  static const Built ball = build_promised(painted_scene(), format::Promise::kAppearance);
  return ball;
}

VerifyReport verify_bytes(const std::vector<std::uint8_t>& bytes, const scene::Scene& scene, bool is_quick = false) {
  const Result<run::Asset> asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  return verify_asset(
      *asset, scene,
      {.is_quick = is_quick, .uniform_cuts = 4, .cameras = 2, .deviation_cuts = 5, .deviation_samples = 20000});
}

/// The ids of what was found, each once, in the order of the findings.
std::string ids_of(const VerifyReport& report) {
  std::string ids;
  for (const Finding& finding : report.findings) {
    if (ids.find(finding.id) == std::string::npos) ids += (ids.empty() ? "" : " ") + finding.id;
  }
  return ids;
}

std::string details_of(const VerifyReport& report) {
  std::string text;
  for (const Finding& finding : report.findings) text += finding.id + " " + finding.detail + "\n";
  return text;
}

template <class Change>
void change_groups(AssetEdit& edit, const Change& change) {
  const std::uint64_t count = edit.count(format::SectionId::kPromiseErrors, sizeof(format::PromiseGroupRecord));
  for (std::uint64_t g = 0; g < count; ++g) {
    const float position = edit.groups()[g].error;
    edit.change_at<format::PromiseGroupRecord>(
        edit.offset_of<format::PromiseGroupRecord>(format::SectionId::kPromiseErrors, g),
        [&](format::PromiseGroupRecord& record) { change(record, position); });
  }
  edit.seal();
}

TEST(PromisesOf, ABallAreTrueInEveryUnit) {
  const VerifyReport report = verify_bytes(painted_ball().bytes, painted_ball().scene);
  EXPECT_EQ(details_of(report), "");
  ASSERT_EQ(report.promises.size(), 2U);
  EXPECT_EQ(report.promises[0].promise, "texels");
  EXPECT_EQ(report.promises[1].promise, "appearance");
  for (const VerifyReport::PromisedCuts& promised : report.promises) {
    EXPECT_GE(promised.cuts, 4U) << promised.promise;
    EXPECT_LE(promised.largest, 1.05) << promised.promise;
    EXPECT_GT(promised.median, 0.5) << promised.promise << ": it promises about what it keeps";
  }
}

/// The masked cards are thinned out by what they cover, and the wood keeps its texels.
TEST(PromisesOf, ATreeAreOfItsWoodAndItsLeavesKeepWhatTheyCover) {
  const testing::TempFolder folder;
  const lab::SampleFile file = lab::make_painted_tree_file(12, 600);
  const auto scene =
      scene::import_scene(folder.write(file.name, std::string(file.bytes.begin(), file.bytes.end())), {});
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  builder::PipelineOptions options;
  options.promise = format::Promise::kTexels;
  options.aggregate = AggregateChoice::kAuto;
  options.looks = &cli::image_looks();
  builder::PipelineReport built;
  const auto bytes = builder::build_lode(*scene, options, {}, built);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const Result<run::Asset> asset = run::Asset::from_vector(*bytes);
  ASSERT_TRUE(asset.ok());
  ASSERT_EQ(asset->meshes().size(), 2U);
  EXPECT_FALSE(has_aggregates(*asset, MeshId(0U)));
  EXPECT_TRUE(has_aggregates(*asset, MeshId(1U)));
  bool is_any_more = false;
  for (std::uint32_t m = 0; m < 2; ++m) {
    const format::MeshRecord& mesh = asset->meshes()[m];
    for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
      const float texels = asset->promise_errors()[g].texel_error, error = asset->groups()[g].error;
      is_any_more = is_any_more || texels > error;
      EXPECT_TRUE(m == 0 || texels == error) << g;
    }
  }
  EXPECT_TRUE(is_any_more);
  const VerifyReport report = verify_bytes(*bytes, *scene);
  EXPECT_EQ(details_of(report), "");
  ASSERT_EQ(report.promises.size(), 1U);
  EXPECT_GE(report.promises[0].cuts, 4U);
  EXPECT_EQ(std::count_if(report.checks.begin(), report.checks.end(),
                          [](const auto& check) { return check.what.starts_with("aggregates cover"); }),
            1);
}

TEST(PromisesOf, TexelsSayNothingOfAppearance) {
  const Built built = build_promised(painted_scene(), format::Promise::kTexels);
  const VerifyReport report = verify_bytes(built.bytes, built.scene);
  EXPECT_EQ(details_of(report), "");
  ASSERT_EQ(report.promises.size(), 1U);
  EXPECT_EQ(report.promises[0].promise, "texels");
}

TEST(PromisesOf, PositionsAloneAreNotLookedFor) {
  const Built built = build_promised(lab::as_scene(lab::as_mesh(lab::make_rock(12))), format::Promise::kPosition);
  const VerifyReport report = verify_bytes(built.bytes, built.scene);
  EXPECT_EQ(details_of(report), "");
  EXPECT_TRUE(report.promises.empty());
  EXPECT_TRUE(std::none_of(report.checks.begin(), report.checks.end(),
                           [](const auto& check) { return check.what.find("promise") != std::string::npos; }));
}

// What a builder writes that measured positions and took them for all: nothing in the asset contradicts it.
TEST(PromisesOf, PositionsInThePlaceOfTexelsAndAppearanceAreFound) {
  AssetEdit edit(painted_ball().bytes);
  change_groups(edit, [](format::PromiseGroupRecord& record, float position) {
    record.texel_error = record.appearance_error = position;
  });
  EXPECT_EQ(ids_of(verify_bytes(edit.bytes(), painted_ball().scene)), "V209");
  EXPECT_EQ(ids_of(verify_bytes(edit.bytes(), painted_ball().scene, true)), "V209") << "in one cut";
}

TEST(PromisesOf, NormalsThatAreLeftOutAreFoundInAppearanceAlone) {
  // Of a rock whose normals turn faster than its surface: of the ball both errors are about the same.
  const Built rock = build_promised(lab::as_scene(lab::as_mesh(lab::with_smooth_normals(lab::make_rock(16)))),
                                    format::Promise::kAppearance);
  EXPECT_EQ(details_of(verify_bytes(rock.bytes, rock.scene)), "");
  AssetEdit edit(rock.bytes);
  change_groups(edit, [](format::PromiseGroupRecord& record, float) { record.appearance_error = record.texel_error; });
  const VerifyReport report = verify_bytes(edit.bytes(), rock.scene);
  EXPECT_EQ(ids_of(report), "V209");
  for (const Finding& finding : report.findings) EXPECT_EQ(finding.detail.rfind("appearance:", 0), 0U);
}

/// By two percent too small: what samples found may be, what is proven not.
TEST(PromisesOf, WhatIsProvenMayNotFallShortAtAll) {
  const Built proven = build_promised(painted_scene(), format::Promise::kAppearance, format::ErrorTier::kCertified);
  EXPECT_EQ(details_of(verify_bytes(proven.bytes, proven.scene)), "");
  const auto check = [&](const std::vector<std::uint8_t>& bytes, std::uint64_t& findings) {
    const Result<run::Asset> asset = run::Asset::from_vector(bytes);
    EXPECT_TRUE(asset.ok()) << asset.error().message();
    RuleLog log;
    const DeviationTotals totals = check_promise(*asset, proven.scene, format::Promise::kAppearance, 5, 20000, log);
    findings = log.count_of(Rule::kV209);
    return totals.worst;
  };
  std::uint64_t findings = 0;
  const double worst = check(proven.bytes, findings);
  EXPECT_GT(worst, 0.3);
  EXPECT_LE(worst, 1.0);
  EXPECT_EQ(findings, 0U);
  AssetEdit edit(proven.bytes);
  const auto less = [&](float error) { return static_cast<float>(worst / 1.02) * error; };
  edit.change_at<format::PromiseMeshRecord>(
      edit.offset_of<format::PromiseMeshRecord>(format::SectionId::kPromises, 0), [&](format::PromiseMeshRecord& mesh) {
        mesh.level0_appearance = std::max(mesh.level0_texels, less(mesh.level0_appearance));
      });
  change_groups(edit, [&](format::PromiseGroupRecord& record, float) {
    record.appearance_error = std::max(record.texel_error, less(record.appearance_error));
  });
  EXPECT_GT(check(edit.bytes(), findings), 1.0);
  EXPECT_GT(findings, 0U);
  edit.mesh(0, [](format::MeshRecord& mesh) { mesh.error_tier = format::ErrorTier::kMeasured; });
  edit.seal();
  check(edit.bytes(), findings);
  EXPECT_EQ(findings, 0U) << "within what samples miss";
}

TEST(PromisesOf, OtherUnitsAreFound) {
  const auto change_units = [](const auto& change) {
    AssetEdit edit(painted_ball().bytes);
    edit.change_at<format::PromiseMeshRecord>(
        edit.offset_of<format::PromiseMeshRecord>(format::SectionId::kPromises, 0), change);
    edit.seal();
    return ids_of(verify_bytes(edit.bytes(), painted_ball().scene))
        .substr(0, 4);  // the errors may be wrong in them too
  };
  EXPECT_EQ(change_units([](format::PromiseMeshRecord& units) { units.normal_object *= 0.99F; }), "V210");
  EXPECT_EQ(change_units([](format::PromiseMeshRecord& units) { units.uv_object[0][0] *= 0.99F; }), "V210");
  EXPECT_EQ(change_units([](format::PromiseMeshRecord& units) { units.uv_object[0][1] *= 0.5F; }), "V210");
}

TEST(PromisesOf, CountInTheUnitsThatTheAssetSays) {
  const Result<run::Asset> asset = run::Asset::from_vector(painted_ball().bytes);
  ASSERT_TRUE(asset.ok());
  const format::PromiseMeshRecord& units = asset->promises()[0];
  const ProductScales texels = scales_of(*asset, MeshId(0U), format::Promise::kTexels);
  const ProductScales appearance = scales_of(*asset, MeshId(0U), format::Promise::kAppearance);
  EXPECT_EQ(texels.normal, 0.0);
  EXPECT_EQ(appearance.normal, double{units.normal_object});
  EXPECT_EQ(appearance.uv[0], Vec2d(units.uv_object[0][0], units.uv_object[0][1]));
  EXPECT_EQ(texels.uv[0], appearance.uv[0]);
  EXPECT_NEAR(texels.uv[0].y, 2.0 * texels.uv[0].x, 1e-5 * texels.uv[0].y) << "a picture twice as high as wide";
}

}  // namespace
}  // namespace meshlode::judge
