// SPDX-License-Identifier: GPL-3.0-or-later
// Random soups after --repair: surfaces by OpenMesh's judgement, of the same triangles, and built and verified as any
// other source.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <vector>

#include "builder/builder.h"
#include "judge/validate/validate.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"
#include "scene/repair/halfedge_oracle.h"
#include "scene/repair/repair.h"
#include "scene/repair/soups.h"

namespace meshlode::scene {
namespace {

constexpr std::uint64_t kSoups = 400;
constexpr std::uint64_t kBuiltEach = 16;

/// The corners of a triangle as positions, in order: with its mirror image it has the same.
using Place = std::array<double, 3>;
using Places = std::array<Place, 3>;

std::map<Places, int> triangles_by_places(const Primitive& p) {
  std::map<Places, int> out;
  for (std::size_t i = 0; i < p.indices.size(); i += 3) {
    Places places;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d at = p.positions[p.indices[i + k]];
      places[k] = {at.x, at.y, at.z};
    }
    std::sort(places.begin(), places.end());
    if (places[0] != places[1] && places[1] != places[2]) ++out[places];
  }
  return out;
}

builder::PipelineOptions repairing(bool repair) {
  builder::PipelineOptions options;
  options.repair = repair;
  return options;
}

Result<run::Asset> build_asset(const Scene& scene, bool repair) {
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, repairing(repair), {}, report);
  if (!bytes) return bytes.error();
  EXPECT_EQ(judge::validate_asset(*bytes).finding_count, 0U);
  return run::Asset::from_vector(std::move(*bytes));
}

TEST(RepairedSoups, AreSurfacesOfTheSameTriangles) {
  MeshRepairs sum;
  for (std::uint64_t seed = 1; seed <= kSoups; ++seed) {
    const Scene soup = test::make_random_soup(seed);
    Scene scene = soup;
    repair_scene(scene);
    const SourceMesh& mesh = scene.meshes[0];
    const Primitive& p = mesh.primitives[0];
    const test::HalfedgeVerdict verdict = test::judge_by_halfedges(p.indices, p.positions.size());
    ASSERT_EQ(verdict.refused, 0U) << "seed " << seed;
    ASSERT_EQ(verdict.complex_vertices, 0U) << "seed " << seed;
    const Primitive& before = soup.meshes[0].primitives[0];
    const auto expected = triangles_by_places(before);
    const auto found = triangles_by_places(p);
    ASSERT_EQ(found.size(), expected.size()) << "seed " << seed;
    std::uint64_t twice = 0, whole = 0;
    for (const auto& [places, count] : expected) {
      ASSERT_TRUE(found.contains(places) && found.at(places) == 1) << "seed " << seed;
      twice += static_cast<std::uint64_t>(count) - 1;
      whole += static_cast<std::uint64_t>(count);
    }
    ASSERT_EQ(mesh.repairs.duplicate, twice) << "seed " << seed;
    ASSERT_EQ(mesh.repairs.degenerate, before.indices.size() / 3 - whole) << "seed " << seed;
    ASSERT_EQ(mesh.drops.repaired, mesh.repairs.duplicate + mesh.repairs.degenerate) << "seed " << seed;
    sum.turned += mesh.repairs.turned;
    sum.stitched += mesh.repairs.stitched;
    sum.cut_edges += mesh.repairs.cut_edges;
    sum.split += mesh.repairs.split;
    sum.duplicate += mesh.repairs.duplicate;
    sum.degenerate += mesh.repairs.degenerate;
  }
  // The soups have every fault, or the test says nothing.
  for (const std::uint64_t count :
       {sum.turned, sum.stitched, sum.cut_edges, sum.split, sum.duplicate, sum.degenerate}) {
    EXPECT_GT(count, kSoups);
  }
}

TEST(RepairedSoups, TheOracleTellsSoupsFromSurfaces) {
  const Scene soup = test::make_random_soup(3);
  Primitive whole = soup.meshes[0].primitives[0];
  std::vector<std::uint32_t> indices;  // it aborts on degenerate triangles
  for (std::size_t i = 0; i < whole.indices.size(); i += 3) {
    const std::uint32_t a = whole.indices[i], b = whole.indices[i + 1], c = whole.indices[i + 2];
    if (a != b && b != c && c != a) indices.insert(indices.end(), {a, b, c});
  }
  EXPECT_GT(test::judge_by_halfedges(indices, whole.positions.size()).refused, 0U);
}

TEST(RepairedSoups, AreBuiltAndVerified) {
  for (std::uint64_t seed = 1; seed <= kSoups; seed += kBuiltEach) {
    Scene scene = test::make_random_soup(seed);
    repair_scene(scene);
    const auto asset = build_asset(scene, true);
    ASSERT_TRUE(asset.ok()) << "seed " << seed << ": " << asset.error().message();
    EXPECT_EQ(asset->meshes()[0].dropped_repaired, scene.meshes[0].drops.repaired) << "seed " << seed;
    Scene source = test::make_random_soup(seed);
    repair_scene(source);
    const judge::VerifyReport report = judge::verify_asset(*asset, source, {});
    EXPECT_EQ(report.finding_count, 0U) << "seed " << seed << ": "
                                        << (report.findings.empty() ? "" : report.findings[0].detail);
    if (scene.meshes[0].repairs.turned == 0 && scene.meshes[0].drops.repaired == 0) continue;
    const judge::VerifyReport unrepaired = judge::verify_asset(*asset, test::make_random_soup(seed), {});
    EXPECT_GT(unrepaired.finding_count, 0U) << "seed " << seed << ": a source that was not repaired is another one";
  }
}

TEST(RepairedSoups, ASurfaceWithoutFaultsHasTheSameContent) {
  const Scene scene = lab::as_scene(lab::as_mesh(lab::make_torus(40, 24)));
  Scene same = scene;
  repair_scene(same);
  EXPECT_EQ(same.meshes[0].repairs.turned + same.meshes[0].repairs.split + same.meshes[0].drops.repaired, 0U);
  EXPECT_EQ(same.meshes[0].primitives[0].indices, scene.meshes[0].primitives[0].indices);
  const auto before = build_asset(scene, false);
  const auto after = build_asset(same, true);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_EQ(
      std::memcmp(&before->header().content_hash, &after->header().content_hash, sizeof(before->header().content_hash)),
      0);
}

}  // namespace
}  // namespace meshlode::scene
