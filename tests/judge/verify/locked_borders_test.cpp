// SPDX-License-Identifier: GPL-3.0-or-later
// V114 finds a border that an asset says it keeps and does not: the whole of it, or one vertex.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "builder/dag/build_dag.h"
#include "builder/encode/encode.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/prepare/prepare.h"
#include "builder/stage_options.h"
#include "builder/write/write.h"
#include "drawn_surface.h"
#include "judge/verify/locked_borders.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::judge {
namespace {

scene::Scene tile() {
  return lab::as_scene(lab::as_mesh(lab::make_plane(32)));
}

/// The tile with its border locked but for so many of its vertices, none of them a corner: nothing else holds them,
/// since it is flat. META says that all are.
run::Asset build_tile(std::size_t unlocked) {
  const scene::Scene scene = tile();
  builder::PipelineOptions options;
  options.error_tier = format::ErrorTier::kQem;
  options.lock_borders = true;
  auto mesh = builder::prepare_mesh(scene.meshes[0], {}, builder::prepare_options(options));
  EXPECT_TRUE(mesh) << mesh.error().message();
  for (std::size_t p = 0; p < mesh->positions.size() && unlocked > 0; ++p) {
    const Vec3i& place = mesh->positions[p];
    const bool is_corner = std::abs(place.x) == std::abs(place.z);
    if (mesh->is_border_locked[p] == 0 || is_corner) continue;
    mesh->is_border_locked[p] = 0;
    --unlocked;
  }
  const auto dag = builder::build_dag(*mesh, builder::dag_options(options, *mesh, {}));
  EXPECT_TRUE(dag) << dag.error().message();
  auto encoded = builder::encode_mesh(*mesh, *dag, builder::build_hierarchy(*dag, *mesh), {});
  EXPECT_TRUE(encoded) << encoded.error().message();
  encoded->record.error_tier = options.error_tier;
  builder::WriteInput input;
  input.meshes.push_back(std::move(*encoded));
  input.mesh_names = {scene.meshes[0].name};
  input.scene = &scene;
  input.meta_json = R"({"settings":{"attributes":"none","lock_borders":true}})";
  auto bytes = builder::write_asset(std::move(input));
  EXPECT_TRUE(bytes) << bytes.error().message();
  auto asset = run::Asset::from_vector(std::move(*bytes));
  EXPECT_TRUE(asset) << asset.error().message();
  return std::move(*asset);
}

std::set<std::string> rules_found(const run::Asset& asset) {
  std::set<std::string> rules;
  for (const Finding& finding : verify_asset(asset, tile(), {.uniform_cuts = 3, .cameras = 3}).findings) {
    rules.insert(finding.id);
  }
  return rules;
}

TEST(LockedBorder, OneVertexThatWasNotLockedIsFound) {
  EXPECT_FALSE(rules_found(build_tile(0)).contains("V114"));
  EXPECT_EQ(rules_found(build_tile(1)), std::set<std::string>({"V114"}));
  EXPECT_EQ(rules_found(build_tile(100)), std::set<std::string>({"V114"}));
}

/// A square of four triangles around its middle, and the same of two: the corners stay.
const test::Patch kFour{{{{0, 0, 0}, {8, 0, 0}, {4, 4, 0}}},
                        {{{8, 0, 0}, {8, 8, 0}, {4, 4, 0}}},
                        {{{8, 8, 0}, {0, 8, 0}, {4, 4, 0}}},
                        {{{0, 8, 0}, {0, 0, 0}, {4, 4, 0}}}};
const test::Patch kTwo{{{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}}}, {{{0, 0, 0}, {8, 8, 0}, {0, 8, 0}}}};
const test::Patch kOne{{{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}}}};

std::uint64_t count_findings(const test::Patch& coarser, const std::vector<GridPoint>& border) {
  const run::Asset asset = test::asset_of({kFour}, coarser);
  const auto clusters = run::decode_all(asset);
  EXPECT_TRUE(clusters);
  RuleLog log;
  LockedTotals totals;
  check_locked_border(asset, build_surface(asset, MeshId(0U), *clusters), border, totals, log);
  EXPECT_EQ(totals.groups, 1U);
  return log.count_of(Rule::kV114);
}

TEST(LockedBorder, IsLookedForGroupByGroup) {
  const std::vector<GridPoint> corners{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}};
  EXPECT_EQ(count_findings(kTwo, corners), 0U);
  EXPECT_GT(count_findings(kOne, corners), 1U) << "in the group, and in cuts";
  EXPECT_EQ(count_findings(kOne, {{0, 0, 0}, {8, 8, 0}}), 0U);
  EXPECT_GT(count_findings(kTwo, {{4, 4, 0}}), 1U);
  EXPECT_EQ(count_findings(kTwo, {{5, 5, 5}}), 0U) << "what level 0 has not V101 says";
}

std::vector<Vec3d> border_of(const std::vector<TriangleCorners::Corners>& triangles) {
  return find_open_border(triangles);
}

TEST(LockedBorder, IsOfEdgesOfOneTriangle) {
  const Vec3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(1, 1, 0), e(0, 0, 1);
  EXPECT_EQ(border_of({{a, b, c}}), std::vector<Vec3d>({a, c, b}));
  EXPECT_EQ(border_of({{a, b, c}, {b, c, a}}).size(), 3U) << "a copy counts once";
  EXPECT_TRUE(border_of({{a, b, c}, {a, c, b}}).empty()) << "its other side closes it";
  EXPECT_EQ(border_of({{a, b, c}, {b, d, c}}).size(), 4U);
  EXPECT_TRUE(border_of({{a, b, c}, {a, e, b}, {b, e, c}, {c, e, a}}).empty()) << "a tetrahedron";
  EXPECT_EQ(border_of({{a, b, c}, {a, b, d}, {a, b, e}}), std::vector<Vec3d>({a, e, c, b, d}))
      << "an edge of three triangles is none, but its ends are of others";
}

}  // namespace
}  // namespace meshlode::judge
