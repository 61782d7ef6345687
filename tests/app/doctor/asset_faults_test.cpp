// SPDX-License-Identifier: GPL-3.0-or-later
// What the tables of an asset say of its source.
#include "app/doctor/asset_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/builder.h"
#include "builder/odd_shapes.h"
#include "judge/validate/edit.h"
#include "lab/samples/samples.h"
#include "scene/detect/precision_faults.h"

namespace meshlode::app {
namespace {

std::vector<std::uint8_t> bytes_of(const scene::Scene& scene, format::ErrorTier tier = format::ErrorTier::kMeasured) {
  builder::PipelineOptions options;
  options.error_tier = tier;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes.ok());
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>{};
}

std::vector<Diagnosis> diagnose(std::vector<std::uint8_t> bytes) {
  const auto asset = run::Asset::from_vector(std::move(bytes));
  EXPECT_TRUE(asset.ok());
  if (!asset) return {};
  std::vector<Diagnosis> diagnoses = diagnose_asset(*asset);
  rank(diagnoses);
  const std::vector<std::string> known = asset_fault_ids();
  for (const Diagnosis& one : diagnoses) {
    EXPECT_NE(std::find(known.begin(), known.end(), one.id), known.end()) << one.id;
  }
  return diagnoses;
}

TEST(AssetFaults, NothingIsWrongWithASphere) {
  EXPECT_TRUE(diagnose(bytes_of(lab::as_scene(lab::as_mesh(lab::make_sphere(16))))).empty());
}

TEST(AssetFaults, StuckGroupsAreCountedByReason) {
  const scene::Scene chaos = lab::as_scene(lab::as_mesh(test::make_lattice_chaos(20000, 8, 7), "chaos"));
  test::AssetEdit edit(bytes_of(chaos));
  std::uint64_t stuck = 0, of_borders = 0;
  for (std::size_t g = 0; g < edit.groups().size(); ++g) {
    if ((edit.groups()[g].flags & format::kGroupStuck) == 0) continue;
    edit.group(g, [&](auto& r) { r.stuck_reason = static_cast<format::StuckReason>(1 + stuck % 7); });
    of_borders += edit.groups()[g].stuck_reason == format::StuckReason::kBorder ? 1 : 0;
    ++stuck;
  }
  edit.seal();
  std::uint64_t told = 0, kinds = 0;
  for (const Diagnosis& one : diagnose(edit.bytes())) {
    if (!one.id.starts_with("stuck-")) continue;
    ++kinds;
    told += one.count;
    EXPECT_FALSE(one.places.at(0).groups.empty());
    EXPECT_GT(one.share, 0.0);
  }
  EXPECT_EQ(kinds, 6U);
  EXPECT_GT(of_borders, 0U);
  EXPECT_EQ(told, stuck - of_borders) << "what a locked border holds was asked for";
}

TEST(AssetFaults, OneGroupOfManyThatHoldsTheError) {
  test::AssetEdit edit(bytes_of(lab::as_scene(lab::as_mesh(lab::make_sphere(64)))));
  std::vector<std::size_t> first_level;
  for (std::size_t g = 0; g < edit.groups().size(); ++g) {
    if (edit.groups()[g].level == 0) first_level.push_back(g);
  }
  ASSERT_GE(first_level.size(), 20U);
  const auto is_named = [](const std::vector<Diagnosis>& diagnoses) {
    return std::any_of(diagnoses.begin(), diagnoses.end(),
                       [](const Diagnosis& one) { return one.id == "error-in-few-groups"; });
  };
  EXPECT_FALSE(is_named(diagnose(edit.bytes())));
  edit.group(first_level[3], [](auto& r) { r.error = 0.5F; });
  edit.seal();
  const std::vector<Diagnosis> diagnoses = diagnose(edit.bytes());
  ASSERT_TRUE(is_named(diagnoses));
  EXPECT_EQ(diagnoses[0].id, "error-in-few-groups");
  EXPECT_EQ(diagnoses[0].places.at(0).groups.at(0), first_level[3]);
  EXPECT_DOUBLE_EQ(diagnoses[0].places[0].costs.at(0).amount, 0.5);
}

TEST(AssetFaults, DroppedTrianglesEstimatesAndWhatWasLeftOut) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_zero_areas(12)));
  scene.left_out.push_back({"skin 0", "no joints"});
  const std::vector<Diagnosis> diagnoses = diagnose(bytes_of(scene, format::ErrorTier::kQem));
  ASSERT_EQ(diagnoses.size(), 3U);
  EXPECT_EQ(diagnoses[0].id, "dropped-faces");
  EXPECT_GT(diagnoses[0].count, 0U);
  EXPECT_EQ(diagnoses[1].id, "unmeasured-errors");
  EXPECT_EQ(diagnoses[2].id, "left-out");
  EXPECT_EQ(diagnoses[2].places.at(0).where, "skin 0");
  EXPECT_EQ(diagnoses[2].count, 1U) << "what the plan left out is no loss";
}

/// What the source says before a build is what the build then counts: the grid is the same.
TEST(AssetFaults, CollapsesWhatTheSourceWarnsOf) {
  scene::Primitive shape = lab::make_plane(30, 1000.0);
  const scene::Primitive ball = lab::make_sphere(5, 0.001);
  const auto first = static_cast<std::uint32_t>(shape.positions.size());
  for (const Vec3d& p : ball.positions) shape.positions.push_back(p + Vec3d(0.5, 1.0, 0.5));
  for (const std::uint32_t v : ball.indices) shape.indices.push_back(first + v);
  const scene::SourceMesh mesh = lab::as_mesh(shape);
  const scene::Fault warned = scene::find_finer_than_grid(scene::make_topology(mesh));
  EXPECT_EQ(warned.count, 300U);
  const auto asset = run::Asset::from_vector(bytes_of(lab::as_scene(mesh)));
  ASSERT_TRUE(asset.ok());
  const format::Grid& grid = asset->meshes()[0].grid;
  EXPECT_EQ(warned.measure, std::ldexp(grid.mantissa, grid.log2));
  EXPECT_EQ(warned.count, asset->meshes()[0].grid_collapsed);
}

TEST(AssetFaults, ManySmallMeshes) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_cube(1)));
  EXPECT_TRUE(diagnose(bytes_of(scene)).empty());
  for (std::uint32_t i = 1; i < 16; ++i) {
    scene.instances.push_back(scene.instances[0]);
    scene.instances.back().node = i;
  }
  const std::vector<Diagnosis> diagnoses = diagnose(bytes_of(scene));
  ASSERT_EQ(diagnoses.size(), 1U);
  EXPECT_EQ(diagnoses[0].id, "small-meshes");
  EXPECT_DOUBLE_EQ(diagnoses[0].share, 1.0);
}

/// Whatever a record says, as long as the asset opens.
TEST(AssetFaultsHostile, AnyBytesInTheTables) {
  test::AssetEdit sound(bytes_of(lab::as_scene(lab::as_mesh(lab::make_sphere(12)))));
  SplitMix64 random(3);
  std::uint64_t opened = 0;
  for (int i = 0; i < 400; ++i) {
    test::AssetEdit edit = sound;
    constexpr std::array kTables{format::SectionId::kMeshes, format::SectionId::kGroups, format::SectionId::kInstances,
                                 format::SectionId::kMeta, format::SectionId::kStrings};
    const format::SectionEntry section = edit.section(kTables[random.below(kTables.size())]);
    if (section.bytes == 0) continue;
    const std::size_t first = section.offset + random.below(section.bytes);
    const std::size_t end = std::min<std::size_t>(first + 1 + random.below(8), section.offset + section.bytes);
    for (std::size_t b = first; b < end; ++b) {
      edit.bytes()[b] = random.chance(0.5) ? 0xFF : static_cast<std::uint8_t>(random.next());
    }
    edit.seal();
    const auto asset = run::Asset::from_vector(edit.bytes());
    if (!asset) continue;
    ++opened;
    DoctorReport report;
    report.diagnoses = diagnose_asset(*asset);
    rank(report.diagnoses);
    for (const Diagnosis& one : report.diagnoses) {
      EXPECT_TRUE(one.share >= 0.0 && one.share <= 1.0) << one.id << " in trial " << i;
    }
    EXPECT_FALSE(doctor_text(report).empty());
    EXPECT_FALSE(doctor_json(report).empty());
  }
  EXPECT_GT(opened, 50U);
}

}  // namespace
}  // namespace meshlode::app
