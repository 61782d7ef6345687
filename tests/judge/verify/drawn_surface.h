// SPDX-License-Identifier: GPL-3.0-or-later
// Assets of one group, from triangles drawn by hand.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "builder/encode/encode.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/write/write.h"
#include "run/read/asset.h"

namespace meshlode::test {

using Corner = std::array<int, 3>;
using Triangle = std::array<Corner, 3>;
using Patch = std::vector<Triangle>;

inline void append_cluster(const Patch& patch, std::uint32_t level, GroupId own, GroupId coarser,
                           builder::LodDag& dag) {
  builder::DagCluster cluster;
  cluster.level = level;
  cluster.own_group = own;
  cluster.coarser_group = coarser;
  cluster.first_vertex = static_cast<std::uint32_t>(dag.vertex_position.size());
  cluster.first_triangle = static_cast<std::uint32_t>(dag.triangles.size());
  cluster.triangle_count = static_cast<std::uint32_t>(patch.size());
  std::vector<Corner> corners;
  for (const Triangle& triangle : patch) {
    std::array<std::uint8_t, 3> local{};
    for (std::size_t k = 0; k < 3; ++k) {
      auto found = std::find(corners.begin(), corners.end(), triangle[k]);
      if (found == corners.end()) found = corners.insert(corners.end(), triangle[k]);
      local[k] = static_cast<std::uint8_t>(found - corners.begin());
    }
    dag.triangles.push_back(local);
    dag.triangle_material.push_back(0);
  }
  for (const Corner& c : corners) dag.vertex_position.emplace_back(c[0], c[1], c[2]);
  cluster.vertex_count = static_cast<std::uint32_t>(corners.size());
  dag.clusters.push_back(cluster);
}

/// One group that replaces `finer` by `coarser`, beside `rest`, which stays as it is.
[[nodiscard]] inline run::Asset asset_of(const std::vector<Patch>& finer, const Patch& coarser,
                                         const std::vector<Patch>& rest = {}) {
  builder::LodDag dag;
  append_cluster(coarser, 1, GroupId(1U), GroupId(0U), dag);
  for (const Patch& patch : rest) append_cluster(patch, 0, GroupId(), GroupId(0U), dag);
  const auto terminal_count = static_cast<std::uint32_t>(dag.clusters.size());
  for (const Patch& patch : finer) append_cluster(patch, 0, GroupId(), GroupId(1U), dag);
  builder::DagGroup top;
  top.level = 1;
  top.cluster_count = terminal_count;
  top.is_terminal = true;
  top.error = top.quadric_error = top.deviation = std::numeric_limits<double>::infinity();
  builder::DagGroup group;
  group.first_cluster = terminal_count;
  group.cluster_count = static_cast<std::uint32_t>(finer.size());
  group.error = group.quadric_error = 1.0;
  group.deviation = std::numeric_limits<double>::infinity();
  dag.groups = {top, group};
  dag.level_count = 2;

  builder::PreparedMesh mesh;
  scene::Scene scene;
  scene.materials.resize(1);
  builder::WriteInput input;
  auto encoded = builder::encode_mesh(mesh, dag, builder::build_hierarchy(dag, mesh), {});
  EXPECT_TRUE(encoded.ok()) << encoded.error().message();
  input.meshes.push_back(std::move(*encoded));
  input.mesh_names = {"drawn"};
  input.scene = &scene;
  input.meta_json = "{}";
  auto bytes = builder::write_asset(std::move(input));
  EXPECT_TRUE(bytes.ok());
  auto asset = run::Asset::from_vector(std::move(*bytes));
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  return std::move(*asset);
}

}  // namespace meshlode::test
