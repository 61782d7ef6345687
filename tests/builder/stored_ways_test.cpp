// SPDX-License-Identifier: GPL-3.0-or-later
// How a mesh is stored does not matter: where nothing is lost the asset's pages and tables are the same bytes, and
// where something is, the DAG has the same shape, within what was lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "builder/builder.h"
#include "run/read/asset.h"
#include "scene/import/gltf_builder.h"
#include "scene/import/stored_ways.h"

namespace meshlode::testing {
namespace {

std::vector<std::uint8_t> build(const StoredWay& way) {
  const TempFolder folder;
  const auto scene = scene::import_scene(folder.write("scene.glb", way.glb), {});
  if (!scene) {
    ADD_FAILURE() << describe(scene);
    return {};
  }
  builder::PipelineReport report;
  auto bytes = builder::build_lode(*scene, {}, {}, report);
  if (!bytes) {
    ADD_FAILURE() << bytes.error().message();
    return {};
  }
  return std::move(*bytes);
}

template <class Record>
void expect_same_bytes(std::span<const Record> a, std::span<const Record> b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0) << what;
}

/// Triangles of each level.
std::vector<double> triangles_of_levels(const run::Asset& asset) {
  std::vector<double> out(asset.meshes()[0].level_count, 0.0);
  for (const format::GroupRecord& group : asset.groups()) {
    for (std::uint32_t c = 0; c < group.cluster_count; ++c) {
      const format::ClusterRecord& cluster = asset.clusters()[group.first_cluster + c];
      const std::size_t level = cluster.own_group == format::kNone ? 0U : asset.groups()[cluster.own_group].level + 1U;
      if (level < out.size()) out[level] += cluster.triangle_count();
    }
  }
  return out;
}

void expect_same_shape(const run::Asset& asset, const run::Asset& plain, double precision) {
  const format::MeshRecord& a = asset.meshes()[0];
  const format::MeshRecord& b = plain.meshes()[0];
  EXPECT_EQ(a.source_triangles, b.source_triangles);
  EXPECT_EQ(a.dropped_degenerate + a.dropped_duplicate, 0U);
  EXPECT_NEAR(a.diagonal, b.diagonal, 4.0 * precision);
  const std::vector<double> levels = triangles_of_levels(asset), expected = triangles_of_levels(plain);
  EXPECT_EQ(levels[0], expected[0]);
  // The last levels are one or two clusters: whether they become fewer once more is chance.
  const std::size_t common = std::min(levels.size(), expected.size());
  EXPECT_LE(std::max(levels.size(), expected.size()) - common, 1U);
  for (std::size_t l = 0; l < common; ++l) {
    if (expected[l] < 512.0) continue;
    EXPECT_NEAR(levels[l], expected[l], 0.1 * expected[l]) << "level " << l;
  }
}

TEST(StoredWays, GiveTheSamePagesOrTheSameShape) {
  const std::vector<StoredWay> ways = store_in_all_ways(48);
  const auto plain_bytes = build(ways[0]);
  const auto plain = run::Asset::from_bytes(plain_bytes);
  ASSERT_TRUE(plain);
  ASSERT_GE(plain->meshes()[0].level_count, 4U);  // there is a DAG to compare
  for (const StoredWay& way : ways) {
    SCOPED_TRACE(way.name);
    const auto bytes = build(way);
    const auto asset = run::Asset::from_bytes(bytes);
    ASSERT_TRUE(asset);
    if (way.precision > 0.0) {
      expect_same_shape(*asset, *plain, way.precision);
      continue;
    }
    expect_same_bytes(asset->meshes(), plain->meshes(), "meshes");
    expect_same_bytes(asset->groups(), plain->groups(), "groups");
    expect_same_bytes(asset->clusters(), plain->clusters(), "clusters");
    expect_same_bytes(asset->nodes(), plain->nodes(), "nodes");
    ASSERT_EQ(asset->pages().size(), plain->pages().size());
    for (std::size_t p = 0; p < plain->pages().size(); ++p) {
      expect_same_bytes(asset->stored_page(PageId(p)), plain->stored_page(PageId(p)), "page");
    }
  }
}

}  // namespace
}  // namespace meshlode::testing
