// SPDX-License-Identifier: GPL-3.0-or-later
// I7 on assets that were built: what is stored is true, and where it says less it is found (V206, L311).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "builder/measure/measure.h"
#include "judge/metrics/metrics.h"
#include "judge/validate/edit.h"
#include "judge/validate/validate.h"
#include "judge/verify/deviations.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "support/random.h"

namespace meshlode::judge {
namespace {

using test::AssetEdit;

struct Built {
  scene::Scene scene;
  std::vector<std::uint8_t> bytes;
};

Built build_rock(format::ErrorTier tier, std::uint32_t detail = 16) {
  Built built;
  built.scene = lab::as_scene(lab::as_mesh(lab::with_smooth_normals(lab::make_rock(detail))));
  builder::PipelineOptions options;
  options.error_tier = tier;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(built.scene, options, {}, report);
  EXPECT_TRUE(bytes.ok());
  built.bytes = std::move(*bytes);
  return built;
}

/// A thousand small sheets of 50 triangles in a cube of 3, each vertex of them up to a fiftieth of its size out of
/// plane.
scene::Primitive make_loose_sheets(std::uint64_t seed) {
  constexpr std::uint32_t kSide = 5, kRow = kSide + 1;
  test::RandomSource random(seed);
  scene::Primitive out;
  for (std::uint32_t piece = 0; piece < 1000; ++piece) {
    const Vec3d corner = Vec3d(1.5) + random.in_cube(1.5);
    const std::uint32_t first = piece * kRow * kRow;
    for (std::uint32_t v = 0; v < kRow * kRow; ++v) {
      const std::uint32_t column = v % kRow, row = v / kRow;
      out.positions.emplace_back(corner + 0.1 * Vec3d(column / 5.0, row / 5.0, 0.1 * random.unit()));
    }
    for (std::uint32_t q = 0; q < kSide * kSide; ++q) {
      const std::uint32_t a = first + q / kSide * kRow + q % kSide;
      for (const std::uint32_t v : {a, a + 1, a + kRow + 1, a, a + kRow + 1, a + kRow}) out.indices.push_back(v);
    }
  }
  return out;
}

/// The ids of what was found, each once, in the order of the findings.
template <class Report>
std::string ids_of(const Report& report) {
  std::string ids;
  for (const Finding& finding : report.findings) {
    if (ids.find(finding.id) == std::string::npos) ids += (ids.empty() ? "" : " ") + finding.id;
  }
  return ids;
}

VerifyReport verify_bytes(const std::vector<std::uint8_t>& bytes, const scene::Scene& scene, bool is_quick = false) {
  const Result<run::Asset> asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  return verify_asset(
      *asset, scene,
      {.is_quick = is_quick, .uniform_cuts = 20, .cameras = 10, .deviation_cuts = 6, .deviation_samples = 20000});
}

/// All errors and deviations times `factor`, where they are finite. With a power of two every other rule still holds.
void scale_errors(AssetEdit& edit, float factor) {
  const auto scale = [&](float& value) {
    if (value < format::kInfiniteError) value *= factor;
  };
  for (std::uint64_t g = 0; g < edit.count(format::SectionId::kGroups, sizeof(format::GroupRecord)); ++g) {
    edit.group(g, [&](auto& group) {
      scale(group.error);
      scale(group.deviation);
    });
  }
  for (std::uint64_t n = 0; n < edit.count(format::SectionId::kNodes, sizeof(format::NodeRecord)); ++n) {
    edit.node(n, [&](auto& node) { scale(node.error); });
  }
  edit.seal();
}

// A triangle between loose pieces is far from the source where none of a few points of it is.
TEST(Deviations, BetweenLoosePiecesAreTrue) {
  for (const std::uint64_t seed : {1, 2}) {
    const scene::Scene scene = lab::as_scene(lab::as_mesh(make_loose_sheets(seed)));
    builder::PipelineReport report;
    const auto bytes = builder::build_lode(scene, {}, {}, report);
    ASSERT_TRUE(bytes.ok());
    const Result<run::Asset> asset = run::Asset::from_vector(*bytes);
    ASSERT_TRUE(asset.ok());
    RuleLog log;
    const auto cuts = check_deviations(*asset, scene, kAllCuts, kDeviationBudget, log);
    EXPECT_GT(cuts.size(), 20U);
    for (const CutBracket& cut : cuts) {
      EXPECT_FALSE(cut.is_above(1.0)) << "seed " << seed << ": " << cut.lower << " of " << cut.stored;
    }
  }
}

class StoredErrors : public testing::TestWithParam<format::ErrorTier> {};
INSTANTIATE_TEST_SUITE_P(Tiers, StoredErrors,
                         testing::Values(format::ErrorTier::kMeasured, format::ErrorTier::kCertified));

TEST_P(StoredErrors, AreTrueAndAreFoundWhereTheySayHalf) {
  const Built built = build_rock(GetParam());
  EXPECT_EQ(ids_of(verify_bytes(built.bytes, built.scene)), "");
  AssetEdit half(built.bytes);
  scale_errors(half, 0.5F);
  EXPECT_EQ(ids_of(verify_bytes(half.bytes(), built.scene)), "V206") << "no other rule can know";
  EXPECT_EQ(ids_of(verify_bytes(half.bytes(), built.scene, true)), "V206") << "in one cut";
}

TEST_P(StoredErrors, AreFoundWhereTheySayNothingDeviates) {
  const Built built = build_rock(GetParam());
  AssetEdit none(built.bytes);
  scale_errors(none, 0.0F);
  EXPECT_EQ(ids_of(verify_bytes(none.bytes(), built.scene)), "V206 V211") << "and what pixels show of what is left";
  EXPECT_EQ(ids_of(verify_bytes(none.bytes(), built.scene, true)), "V206") << "where 0 is the only cut there is";
}

// A tenth less at one group is more than the margin. Every cut is looked at, so that of its own error too.
TEST_P(StoredErrors, AreFoundWhereOneGroupSaysATenthLess) {
  const Built built = build_rock(GetParam());
  const Result<run::Asset> asset = run::Asset::from_vector(built.bytes);
  ASSERT_TRUE(asset.ok());
  std::uint32_t lowered = 0, found = 0;
  for (std::uint32_t g = 0; g < asset->groups().size(); ++g) {
    const float error = asset->groups()[g].error;
    if (error >= format::kInfiniteError) continue;
    AssetEdit edit(built.bytes);
    edit.group(g, [](auto& group) {
      group.error *= 0.9F;
      group.deviation *= 0.9F;
    });
    edit.seal();
    const Result<run::Asset> broken = run::Asset::from_vector(edit.bytes());
    ASSERT_TRUE(broken.ok());
    RuleLog log;
    const auto cuts = check_deviations(*broken, built.scene, kAllCuts, kDeviationBudget, log);
    ++lowered;
    if (log.count_of(Rule::kV206) > 0) ++found;
    const auto own = std::find_if(cuts.begin(), cuts.end(),
                                  [&](const CutBracket& cut) { return cut.threshold == double{error * 0.9F}; });
    if (own == cuts.end()) continue;
    EXPECT_GT(own->upper, own->stored) << "group " << g;
    EXPECT_FALSE(own->is_undecided()) << "group " << g;
  }
  ASSERT_GT(lowered, 4U);
  // A bound may be more than a tenth above the truth.
  if (GetParam() == format::ErrorTier::kMeasured) {
    EXPECT_EQ(found, lowered);
  }
}

// What is proven in one cut and kept for the next is what is found of each cut alone.
TEST_P(StoredErrors, AreJudgedAlikeInAllCutsAndInEachAlone) {
  const Built built = build_rock(GetParam(), 40);
  AssetEdit edit(built.bytes);
  scale_errors(edit, 0.97F);  // about half of the cuts are above then
  const Result<run::Asset> asset = run::Asset::from_vector(edit.bytes());
  ASSERT_TRUE(asset.ok());
  const auto all = bracket_cuts(*asset, MeshId(0U), built.scene.meshes[0], kAllCuts, kDeviationBudget);
  ASSERT_TRUE(all.ok());
  ASSERT_GT(all->size(), 5U);
  const Surface source = surface_of_source(built.scene.meshes[0]);
  const DeviationFrom from_source(source, {.samples = 20000});
  for (const CutBracket& cut : *all) {
    const run::UniformCut selected = run::select_uniform(*asset, MeshId(0U), cut.threshold);
    const auto surface = surface_of_clusters(*asset, MeshId(0U), selected.clusters);
    ASSERT_TRUE(surface.ok());
    const double sampled = from_source.measure(*surface).max();
    EXPECT_EQ(cut.stored, selected.stored_error);
    EXPECT_GE(cut.upper, sampled * (1.0 - 1e-9)) << cut.threshold;
    EXPECT_FALSE(cut.is_undecided()) << cut.threshold;
    if (sampled > cut.stored * (1.0 + 1e-9)) {
      EXPECT_TRUE(cut.is_above(1.0)) << cut.threshold;
      EXPECT_GE(cut.lower, sampled / 1.003) << cut.threshold;
    }
  }
}

// Assets of before parts were meshes have a trunk and its leaves in one mesh: the trunk is judged all the same.
TEST_P(StoredErrors, OfOtherGroupsAreJudgedBesideAnAggregates) {
  const Built built = build_rock(GetParam(), 40);
  AssetEdit edit(built.bytes);
  scale_errors(edit, 0.25F);  // what is proven may be twice what is
  const auto groups = edit.groups();
  for (auto g = static_cast<std::uint32_t>(groups.size()); g-- > 0;) {
    if ((groups[g].flags & format::kGroupTerminal) != 0) continue;
    edit.group(g, [](auto& group) { group.flags |= format::kGroupAggregate; });  // the finest
    break;
  }
  edit.header([](auto& header) { header.version = format::kVersion; });
  edit.seal();
  const Result<run::Asset> asset = run::Asset::from_vector(edit.bytes());
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  RuleLog log;
  EXPECT_GT(check_deviations(*asset, built.scene, kAllCuts, kDeviationBudget, log).size(), 5U);
  EXPECT_GT(log.count_of(Rule::kV206), 5U);
}

TEST_P(StoredErrors, AreAtLeastTheDeviationTimesTheMarginOfTheSettings) {
  const Built built = build_rock(GetParam());
  const double margin = GetParam() == format::ErrorTier::kMeasured ? builder::kMeasuredMargin : 1.0;
  AssetEdit edit(built.bytes);
  const auto count = static_cast<std::uint32_t>(edit.count(format::SectionId::kGroups, sizeof(format::GroupRecord)));
  std::uint32_t finite = 0, inner = 0;
  for (std::uint32_t g = 0; g < count; ++g) {
    const auto group =
        edit.get<format::GroupRecord>(edit.offset_of<format::GroupRecord>(format::SectionId::kGroups, g));
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    ++finite;
    inner = g;
    EXPECT_GT(group.deviation, 0.0F);
    EXPECT_GE(double{group.error} * (1.0 + 1e-6), margin * double{group.deviation});
  }
  ASSERT_GT(finite, 3U);
  edit.group(inner, [&](auto& g) { g.deviation = static_cast<float>(double{g.error} / margin * (1.0 + 1e-5)); });
  edit.seal();
  EXPECT_EQ(ids_of(validate_asset(edit.bytes())), "L311");
}

// A cluster of level 0 that moves with all of its border is a matter of the source's triangles, which are not looked
// for.
TEST(QuickVerify, FindsNothingInWhatWasBuiltAndEachCoarserClusterThatWasMoved) {
  const Built built = build_rock(format::ErrorTier::kMeasured);
  const VerifyReport sound = verify_bytes(built.bytes, built.scene, true);
  EXPECT_EQ(ids_of(sound), "");
  const auto measured = std::find_if(sound.checks.begin(), sound.checks.end(),
                                     [](const auto& c) { return c.invariant == "I7" && c.items == 1 && !c.skipped; });
  EXPECT_NE(measured, sound.checks.end()) << "a cut is measured";
  AssetEdit original(built.bytes);
  const auto clusters = original.clusters();
  std::vector<std::uint32_t> made(clusters.size(), 0);  // per group: clusters made from it
  for (const auto& cluster : clusters) {
    if (cluster.own_group != format::kNone) ++made[cluster.own_group];
  }
  std::uint32_t moved = 0;
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    // One that is all of a closed surface has no border.
    if (clusters[c].own_group == format::kNone || made[clusters[c].own_group] < 2) continue;
    AssetEdit edit(built.bytes);
    const std::int32_t by = edit.minimum(c, 0) > 4 ? -1 : 1;
    edit.move_minimum(c, 0, by);
    edit.seal();
    const std::string ids = ids_of(verify_bytes(edit.bytes(), built.scene, true));
    EXPECT_NE(ids, "") << "cluster " << c << " was moved by a step";
    ++moved;
  }
  EXPECT_GT(moved, 10U);
}

}  // namespace
}  // namespace meshlode::judge
