// SPDX-License-Identifier: GPL-3.0-or-later
// Stored UV deviations of whole DAGs against an own count by chart (uv_count.h), both ways. MESHLODE_MODELS names the
// folder of models.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lab/samples/samples.h"
#include "scene/import/import.h"
#include "uv_count.h"

namespace meshlode::builder {
namespace {

namespace fs = std::filesystem;
using test::ChartedDag;
using test::CountedUvs;

/// Holds each group to its count, within a tenth. Returns the counts.
std::vector<CountedUvs> expect_counted(const ChartedDag& charted, const std::string& name) {
  std::vector<CountedUvs> counted = test::count_uvs(charted);
  std::size_t groups = 0, far = 0;
  for (std::size_t g = 0; g < counted.size(); ++g) {
    if (charted.dag.groups[g].is_terminal) continue;
    const double stored = charted.dag.groups[g].uv_deviation;
    const auto& [low, own, high] = counted[g].both;
    ++groups;
    if (std::abs(stored - own) > 0.1 * own) ++far;
    EXPECT_GE(stored, 0.9 * low) << name << ", group " << g << " of level " << charted.dag.groups[g].level;
    EXPECT_LE(stored, 1.1 * high) << name << ", group " << g << " of level " << charted.dag.groups[g].level;
  }
  testing::Test::RecordProperty(name, std::to_string(far) + " of " + std::to_string(groups));
  EXPECT_LE(10 * far, groups + 10) << name << ": a tenth at most is off by more than a tenth of 95% itself";
  return counted;
}

/// A wavy sheet of `cells` cells along each side, `height` up, at a place of its own in the atlas.
scene::Primitive make_wavy_sheet(std::uint32_t cells, double height, float u) {
  scene::Primitive sheet = lab::make_plane(cells);
  for (Vec3d& p : sheet.positions) {
    sheet.uvs[0].emplace_back(u + 0.2F * float(p.x + 1.0), 0.2F * float(p.z + 1.0));
    p.y = height + 0.04 * (p.x * p.x - 3.0 * p.z * p.z * p.x) * (1.0 + p.z) + 0.02 * std::fmod(7.0 * p.x + 9.0, 1.0);
  }
  return sheet;
}

void append(const scene::Primitive& from, scene::Primitive& to) {
  const auto base = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  to.uvs[0].insert(to.uvs[0].end(), from.uvs[0].begin(), from.uvs[0].end());
  for (const std::uint32_t i : from.indices) to.indices.push_back(base + i);
}

// Two layers nearer to each other than errors become: half of the points of either are nearest to the other one.
TEST(UvCount, OfTwoSheetsAboveEachOtherEachIsComparedWithItself) {
  scene::Primitive shape = make_wavy_sheet(48, 0.0, 0.0F);
  append(make_wavy_sheet(48, 0.002, 0.5F), shape);
  const ChartedDag charted = test::build_charted(lab::as_mesh(shape), {});
  EXPECT_EQ(charted.chart_count, 2U);
  const std::vector<CountedUvs> counted = expect_counted(charted, "two sheets");
  std::size_t misled = 0;  // groups that the nearest point would tell that they are half of the atlas away
  for (std::size_t g = 0; g < counted.size(); ++g) {
    if (!charted.dag.groups[g].is_terminal && counted[g].nearest > 0.4 && counted[g].both[1] < 0.05) ++misled;
  }
  EXPECT_GE(misled, 2U);
}

// Small pieces above a sheet, each at its own place in the atlas and a third of the area in all, vanish.
TEST(UvCount, AChartThatVanishesCounts) {
  scene::Primitive shape = make_wavy_sheet(56, 0.0, 0.0F);
  for (std::uint32_t i = 0; i < 24; ++i) {
    for (std::uint32_t j = 0; j < 24; ++j) {
      scene::Primitive piece = lab::make_plane(1, 0.03);
      for (Vec3d& p : piece.positions) {
        piece.uvs[0].emplace_back(0.5F + 0.02F * float(i) + 0.4F * float(p.x), 0.02F * float(j) + 0.4F * float(p.z));
        p += Vec3d(-0.92 + 0.08 * i, 0.3, -0.92 + 0.08 * j);
      }
      append(piece, shape);
    }
  }
  const ChartedDag charted = test::build_charted(lab::as_mesh(shape), {});
  EXPECT_EQ(charted.chart_count, 577U);
  const std::vector<CountedUvs> counted = expect_counted(charted, "vanished pieces");
  std::size_t one_sided = 0;  // groups that do not show it themselves
  for (std::size_t g = 0; g < counted.size(); ++g) {
    if (counted[g].vanished > 0 && counted[g].both[1] > 10.0 * counted[g].of_group) ++one_sided;
  }
  EXPECT_GE(one_sided, 2U);
}

class UvModels : public testing::TestWithParam<const char*> {};

TEST_P(UvModels, AsCounted) {
  const char* const folder = std::getenv("MESHLODE_MODELS");
  const fs::path path = fs::path(folder == nullptr ? "" : folder) / GetParam();
  if (!fs::exists(path)) GTEST_SKIP() << "set MESHLODE_MODELS to the folder of models: it has no " << GetParam();
  const Result<scene::Scene> scene = scene::import_scene(path, {});
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  for (const scene::SourceMesh& mesh : scene->meshes) {
    expect_counted(test::build_charted(mesh, scene->materials), std::string(GetParam()) + " " + mesh.name);
  }
}

INSTANTIATE_TEST_SUITE_P(All, UvModels, testing::Values("FlightHelmet/FlightHelmet.gltf", "bunny.glb", "spot.glb"));

}  // namespace
}  // namespace meshlode::builder
