// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/cluster.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/cluster/adjacency.h"
#include "builder/cluster/satellites.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

PreparedMesh prepare(const scene::Primitive& shape, bool normals = false) {
  AttributeLayout layout;
  layout.has_normal = normals;
  return *prepare_mesh(lab::as_mesh(shape), layout, {});
}

Clustering cluster(const PreparedMesh& mesh, const ClusterCaps& caps = {}) {
  return cluster_triangles(mesh.triangles, mesh.wedge_position, mesh.positions, caps);
}

/// I2, and that labels are a numbering without gaps.
void expect_caps(const PreparedMesh& mesh, const Clustering& clustering, const ClusterCaps& caps) {
  ASSERT_EQ(clustering.label.size(), mesh.triangles.size());
  std::vector<std::uint32_t> triangles(clustering.count, 0);
  std::vector<std::set<std::uint32_t>> wedges(clustering.count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    ++triangles.at(clustering.label[t]);
    wedges[clustering.label[t]].insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  for (std::uint32_t c = 0; c < clustering.count; ++c) {
    EXPECT_GT(triangles[c], 0U);
    EXPECT_LE(triangles[c], caps.max_triangles);
    EXPECT_LE(wedges[c].size(), caps.max_vertices);
  }
}

TEST(Cluster, CapsHoldOnEveryShape) {
  scene::Primitive fan;  // one vertex of valence 10,000
  fan.positions.push_back({0, 0, 1});
  for (int i = 0; i < 10000; ++i) fan.positions.push_back({i * 1e-3, (i % 97) * 0.01, 0});
  for (std::uint32_t i = 1; i < 10000; ++i) fan.indices.insert(fan.indices.end(), {0, i, i + 1});
  const scene::Primitive shapes[] = {
      lab::make_sphere(30),       lab::make_box_soup(300),    lab::make_loose_pieces(500), lab::make_slivers(400),
      lab::make_three_sheets(20), lab::make_double_cone(200), lab::make_moebius(60, 6),    fan};
  for (const scene::Primitive& shape : shapes) {
    const PreparedMesh mesh = prepare(shape);
    expect_caps(mesh, cluster(mesh), {});
  }
}

TEST(Cluster, TheVertexCapHoldsWhereEveryCornerIsAVertex) {
  const PreparedMesh mesh = prepare(lab::with_split_normals(lab::make_sphere(20)), true);
  const Clustering clustering = cluster(mesh);
  expect_caps(mesh, clustering, {});
  const double per_cluster = static_cast<double>(mesh.triangles.size()) / clustering.count;
  EXPECT_GT(per_cluster, 70.0) << "256 vertices make 85 loose triangles: clusters should come near that";
}

TEST(Cluster, SmallCapsHoldToo) {
  const PreparedMesh mesh = prepare(lab::make_torus(30, 20));
  ClusterCaps caps;
  caps.max_triangles = 7;
  caps.max_vertices = 8;
  caps.target_triangles = 6;
  expect_caps(mesh, cluster(mesh, caps), caps);
}

TEST(Cluster, ClustersAreFull) {
  const PreparedMesh mesh = prepare(lab::make_sphere(60));  // 43,200 triangles: several chunks
  const Clustering clustering = cluster(mesh);
  expect_caps(mesh, clustering, {});
  EXPECT_GE(static_cast<double>(mesh.triangles.size()) / (128.0 * clustering.count), 0.97);
}

TEST(Cluster, WhatFitsOneClusterIsOne) {
  const PreparedMesh mesh = prepare(lab::make_plane(8));
  ASSERT_EQ(mesh.triangles.size(), 128U);
  EXPECT_EQ(cluster(mesh).count, 1U);
}

TEST(Cluster, LoosePiecesNearEachOtherStayTogether) {
  // Two boxes of space with 600 loose pieces each, far apart: no cluster may hold pieces of both but at most one.
  scene::Primitive shape = lab::make_loose_pieces(600, 3);
  const scene::Primitive other = lab::make_loose_pieces(600, 4);
  const auto base = static_cast<std::uint32_t>(shape.positions.size());
  for (const Vec3d& p : other.positions) shape.positions.push_back(p + Vec3d(1000.0, 0, 0));
  for (const std::uint32_t i : other.indices) shape.indices.push_back(base + i);
  const PreparedMesh mesh = prepare(shape);
  const Clustering clustering = cluster(mesh);
  std::vector<std::set<bool>> sides(clustering.count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    sides[clustering.label[t]].insert(mesh.positions[mesh.wedge_position[mesh.triangles[t][0]]].x > 0);
  }
  EXPECT_LE(std::count_if(sides.begin(), sides.end(), [](const auto& s) { return s.size() == 2; }), 1);
}

/// A sphere with debris beside it: triangles that the grid collapsed, and pieces of one to three triangles.
TEST(Cluster, WhatCoversLittleIsWhereItsSurfaceIs) {
  scene::Primitive shape = lab::make_sphere(40);
  const std::size_t surface = shape.indices.size() / 3;
  const std::size_t vertices = shape.positions.size();
  for (std::size_t i = 0; i < vertices; i += 21) {
    const Vec3d p = shape.positions[i];
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    const double size = i % 2 == 0 ? 1e-9 : 1e-3;  // far below a cell of the grid, and above
    const Vec3d at = i % 2 == 0 ? p : p * 1.01;
    shape.positions.push_back(at);
    shape.positions.push_back(at + Vec3d(size, 0, 0));
    shape.positions.push_back(at + Vec3d(0, size, size));
    for (std::uint32_t k = 0; k < 3; ++k) shape.indices.push_back(first + k);
  }
  ASSERT_GT(shape.indices.size() / 3, surface + 400);
  const PreparedMesh mesh = prepare(shape);
  const Clustering clustering = cluster(mesh);
  expect_caps(mesh, clustering, {});
  // The cluster of each collapsed triangle and of each floating one has a triangle of the sphere within an edge or so.
  const auto center = [&](std::size_t t) {
    Vec3d sum(0.0);
    for (const std::uint32_t w : mesh.triangles[t]) sum += mesh.grid.decode(mesh.positions[mesh.wedge_position[w]]);
    return sum / 3.0;
  };
  std::size_t debris = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto extent = [&](std::size_t s) {
      const auto& corners = mesh.triangles[s];
      const auto at = [&](std::size_t k) { return mesh.grid.decode(mesh.positions[mesh.wedge_position[corners[k]]]); };
      return std::max(glm::distance(at(0), at(1)), glm::distance(at(1), at(2)));
    };
    if (extent(t) > 5e-3) continue;
    ++debris;
    double nearest = 10.0;
    for (std::size_t s = 0; s < mesh.triangles.size(); ++s) {
      if (clustering.label[s] != clustering.label[t] || extent(s) <= 5e-3) continue;
      nearest = std::min(nearest, glm::distance(center(s), center(t)));
    }
    EXPECT_LT(nearest, 0.06) << "triangle " << t;
  }
  EXPECT_GT(debris, 400U);
}

/// Every needle of a fan shares the hub, so that looking through the hub's triangles for each would be quadratic.
TEST(Cluster, AFanOfNeedlesStaysLinear) {
  constexpr std::uint32_t kSpokes = 200000;
  std::vector<Vec3i> positions{{0, 0, 0}};
  std::vector<std::uint32_t> wedge_position{0};
  std::vector<WedgeTriangle> triangles;
  for (std::uint32_t i = 1; i <= kSpokes; ++i) {
    positions.push_back({static_cast<int>(i), 1000, static_cast<int>(i % 7)});
    wedge_position.push_back(i);
  }
  for (std::uint32_t i = 1; i < kSpokes; ++i) triangles.push_back({0, i, i + 1});
  for (std::uint32_t i = 1; i <= kSpokes; ++i) triangles.push_back({0, i, i});
  const Hosts hosts = host_collapsed(triangles, wedge_position, positions.size());
  for (std::uint32_t i = 1; i <= kSpokes; ++i) {
    const std::uint32_t host = hosts[kSpokes - 1 + i - 1];
    ASSERT_NE(host, kNoId);
    EXPECT_TRUE(triangles[host][1] == i || triangles[host][2] == i) << "the host has the whole segment";
  }
}

TEST(TriangleGraph, AnEdgeOfManyTrianglesStaysLinear) {
  std::vector<std::array<std::uint32_t, 3>> fan;
  for (std::uint32_t i = 0; i < 5000; ++i) fan.push_back({0, 1, i + 2});
  const Graph graph = TriangleLinks(fan).graph();
  EXPECT_EQ(graph.neighbor.size(), 2U * 4999U);
}

/// Whole pieces are taken out: what is left is the graph of the others.
TEST(TriangleGraph, WithoutSomePiecesIsTheGraphOfTheRest) {
  SplitMix64 random(5);
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(round);
    std::vector<std::array<std::uint32_t, 3>> triangles(1 + random.scaled_below(60));
    for (auto& triangle : triangles) {
      for (std::uint32_t& corner : triangle) corner = random.scaled_below(40);
    }
    TriangleLinks links(triangles);
    std::vector<std::uint32_t> piece;
    const std::uint32_t pieces = links.find_pieces(piece);
    EXPECT_EQ(piece[0], 0U);
    EXPECT_EQ(*std::max_element(piece.begin(), piece.end()), pieces - 1);
    std::vector<std::uint32_t> hosts(triangles.size(), kNoId);
    std::vector<std::array<std::uint32_t, 3>> rest;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (piece[t] % 3 == 1) hosts[t] = 0;
      if (hosts[t] == kNoId) rest.push_back(triangles[t]);
    }
    const Graph kept = links.without(hosts).graph(), made = TriangleLinks(rest).graph();
    EXPECT_EQ(kept.row_start, made.row_start);
    EXPECT_EQ(kept.neighbor, made.neighbor);
    EXPECT_EQ(kept.edge_weight, made.edge_weight);
  }
}

TEST(TriangleGraph, IsSymmetricWithoutLoopsOrRepeats) {
  std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 1, 2}, {2, 1, 0}, {0, 0, 1}, {1, 2, 3}, {7, 8, 9}};
  const Graph graph = TriangleLinks(triangles).graph();
  std::set<std::pair<std::int32_t, std::int32_t>> seen;
  for (std::int32_t i = 0; i < 5; ++i) {
    for (auto e = graph.row_start[static_cast<std::size_t>(i)]; e < graph.row_start[static_cast<std::size_t>(i) + 1];
         ++e) {
      const std::int32_t n = graph.neighbor[static_cast<std::size_t>(e)];
      EXPECT_NE(n, i);
      EXPECT_TRUE(seen.insert({i, n}).second);
    }
  }
  for (const auto& [a, b] : seen) EXPECT_TRUE(seen.count({b, a}) == 1);
}

}  // namespace
}  // namespace meshlode::builder
