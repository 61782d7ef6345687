// SPDX-License-Identifier: GPL-3.0-or-later
// What --repair does, by kind, on surfaces small enough to be counted by hand.
#include "scene/repair/repair.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/repair/halfedge_oracle.h"

namespace meshlode::scene {
namespace {

using Triangles = std::vector<std::uint32_t>;

Primitive primitive_of(std::vector<Vec3d> positions, Triangles indices) {
  Primitive primitive;
  primitive.positions = std::move(positions);
  primitive.indices = std::move(indices);
  primitive.material = MaterialId(0U);
  return primitive;
}

Scene scene_of(std::vector<Primitive> primitives) {
  Scene scene;
  scene.materials.resize(2);
  scene.meshes.push_back({"mesh", std::move(primitives), {}, {}});
  scene.instances.push_back({"mesh", 0, MeshId(0U), Mat4d(1.0)});
  return scene;
}

Scene repaired(std::vector<Vec3d> positions, Triangles indices) {
  Scene scene = scene_of({primitive_of(std::move(positions), std::move(indices))});
  repair_scene(scene);
  return scene;
}

const MeshRepairs& repairs(const Scene& scene) {
  return scene.meshes[0].repairs;
}
const Primitive& primitive(const Scene& scene) {
  return scene.meshes[0].primitives[0];
}

/// degenerate, duplicate, turned, stitched, cut edges, split.
using Counts = std::array<std::uint64_t, 6>;
Counts counts(const Scene& scene) {
  const MeshRepairs& r = repairs(scene);
  return {r.degenerate, r.duplicate, r.turned, r.stitched, r.cut_edges, r.split};
}

void expect_surface(const Scene& scene) {
  const Primitive& p = primitive(scene);
  const test::HalfedgeVerdict verdict = test::judge_by_halfedges(p.indices, p.positions.size());
  EXPECT_EQ(verdict.refused, 0U);
  EXPECT_EQ(verdict.complex_vertices, 0U);
}

/// The eight corners of a cube, and its twelve triangles, outward.
std::vector<Vec3d> cube_corners(const Vec3d& origin) {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(origin + Vec3d(i & 1, (i >> 1) & 1, i >> 2));
  return corners;
}
const Triangles kCube{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

Scene two_cubes(const Vec3d& second) {
  std::vector<Vec3d> positions = cube_corners(Vec3d(0.0));
  const std::vector<Vec3d> more = cube_corners(second);
  positions.insert(positions.end(), more.begin(), more.end());
  Triangles indices = kCube;
  for (const std::uint32_t corner : kCube) indices.push_back(corner + 8);
  return repaired(positions, indices);
}

/// Six times the volume that the triangles enclose.
double volume(const Primitive& p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.indices.size(); i += 3) {
    sum +=
        glm::dot(p.positions[p.indices[i]], glm::cross(p.positions[p.indices[i + 1]], p.positions[p.indices[i + 2]]));
  }
  return sum;
}

TEST(Repair, ATriangleThatFacesTheOtherWayIsTurned) {
  for (std::uint32_t wrong = 0; wrong < 12; ++wrong) {  // the first one too: the majority decides
    Triangles indices = kCube;
    std::swap(indices[3 * wrong + 1], indices[3 * wrong + 2]);
    const Scene scene = repaired(cube_corners(Vec3d(0.0)), indices);
    EXPECT_EQ(counts(scene), (Counts{0, 0, 1, 0, 0, 0})) << wrong;
    EXPECT_EQ(primitive(scene).indices, kCube) << wrong;
    expect_surface(scene);
  }
}

TEST(Repair, EachPieceDecidesForItself) {
  // Two cubes apart, one of them inside out: nothing contradicts itself.
  std::vector<Vec3d> positions = cube_corners(Vec3d(0.0));
  const std::vector<Vec3d> more = cube_corners(Vec3d(5.0));
  positions.insert(positions.end(), more.begin(), more.end());
  Triangles indices = kCube;
  for (std::size_t i = 0; i < kCube.size(); i += 3) {
    indices.insert(indices.end(), {kCube[i] + 8, kCube[i + 2] + 8, kCube[i + 1] + 8});
  }
  const Scene scene = repaired(positions, indices);
  EXPECT_EQ(counts(scene), (Counts{}));
  EXPECT_EQ(primitive(scene).indices, indices);
}

TEST(Repair, OfTwoEqualPartsTheFirstTriangleIsRight) {
  const Scene scene = repaired({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {0, 1, 2, 1, 2, 3});
  EXPECT_EQ(counts(scene), (Counts{0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(primitive(scene).indices, (Triangles{0, 1, 2, 1, 3, 2}));
}

TEST(Repair, DuplicatesAreRemovedInEitherDirection) {
  const Scene scene = repaired({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}},
                               {0, 1, 2, 1, 2, 0, 0, 2, 1, 3, 1, 2});  // turned round, mirrored, by an equal vertex
  EXPECT_EQ(counts(scene), (Counts{0, 3, 0, 0, 0, 0}));
  EXPECT_EQ(scene.meshes[0].drops.repaired, 3U);
  EXPECT_EQ(primitive(scene).indices, (Triangles{0, 1, 2}));
}

TEST(Repair, ATriangleOfAnotherMaterialIsALayerAndTurnsWithWhatItLiesOn) {
  Triangles wrong = kCube;
  std::swap(wrong[4], wrong[5]);
  Primitive layer = primitive_of(cube_corners(Vec3d(0.0)), {wrong[3], wrong[4], wrong[5]});
  layer.indices.insert(layer.indices.end(), {kCube[6], kCube[7], kCube[8], kCube[6], kCube[7], kCube[8]});
  layer.material = MaterialId(1U);
  Scene scene = scene_of({primitive_of(cube_corners(Vec3d(0.0)), wrong), layer});
  repair_scene(scene);
  EXPECT_EQ(counts(scene), (Counts{0, 1, 2, 0, 0, 0}));
  EXPECT_EQ(primitive(scene).indices, kCube);
  EXPECT_EQ(scene.meshes[0].primitives[1].indices, (Triangles(kCube.begin() + 3, kCube.begin() + 9)));
}

TEST(Repair, TwoCornersInOnePointAreNoTriangle) {
  const Scene scene =
      repaired({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}}, {0, 1, 1, 0, 1, 2, 1, 3, 2, 4, 4, 4});
  EXPECT_EQ(counts(scene), (Counts{3, 0, 0, 0, 0, 0}));
  EXPECT_EQ(scene.meshes[0].drops.repaired, 3U);
  EXPECT_EQ(primitive(scene).indices, (Triangles{0, 1, 2}));
}

TEST(Repair, ATriangleThatClosesATJunctionStays) {
  // 0 1 2 lie on a line; without the middle triangle the border would be open.
  const Scene scene =
      repaired({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}}, {0, 2, 3, 0, 1, 2, 0, 4, 1, 1, 4, 2});
  EXPECT_EQ(counts(scene), (Counts{}));
  EXPECT_EQ(primitive(scene).indices.size(), 12U);
  expect_surface(scene);
}

TEST(Repair, ABowTieIsSplitAtItsKnot) {
  const Scene scene = repaired({{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}}, {0, 2, 1, 0, 3, 4});
  EXPECT_EQ(counts(scene), (Counts{0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(primitive(scene).indices, (Triangles{0, 2, 1, 5, 3, 4}));
  ASSERT_EQ(primitive(scene).positions.size(), 6U);
  EXPECT_EQ(primitive(scene).positions[5], Vec3d(0.0));
  expect_surface(scene);
}

TEST(Repair, AnEdgeOfThreeTrianglesIsCut) {
  const Scene scene = repaired({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {0, 1, 2, 0, 1, 3, 0, 1, 4});
  EXPECT_EQ(counts(scene), (Counts{0, 0, 0, 0, 1, 4}));
  EXPECT_EQ(primitive(scene).positions.size(), 9U);
  expect_surface(scene);
}

TEST(Repair, AMoebiusStripIsCutWhereItMeetsItself) {
  std::vector<Vec3d> positions;
  Triangles indices;
  constexpr std::uint32_t kSteps = 8;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double turn = 2.0 * 3.14159265358979 * i / kSteps;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1.0 + side * std::cos(turn / 2.0);
      positions.emplace_back(r * std::cos(turn), r * std::sin(turn), side * std::sin(turn / 2.0));
    }
    const bool is_last = i + 1 == kSteps;
    const std::uint32_t a = 2 * i, b = a + 1, c = is_last ? 1 : a + 2, d = is_last ? 0 : a + 3;
    indices.insert(indices.end(), {a, c, b, b, c, d});
  }
  const Scene scene = repaired(positions, indices);
  EXPECT_EQ(repairs(scene).cut_edges, 0U);
  EXPECT_EQ(repairs(scene).split, 2U);  // both ends of the one seam
  EXPECT_EQ(primitive(scene).indices.size(), indices.size());
  expect_surface(scene);
}

TEST(Repair, TwoCubesThatShareAnEdgeBecomeTwoSurfaces) {
  const Scene scene = two_cubes(Vec3d(1, 1, 0));
  EXPECT_EQ(counts(scene), (Counts{0, 0, 0, 2, 1, 2}));
  EXPECT_EQ(volume(primitive(scene)), 12.0);
  expect_surface(scene);
}

TEST(Repair, TwoCubesThatShareACornerBecomeTwoSurfaces) {
  const Scene scene = two_cubes(Vec3d(1, 1, 1));
  EXPECT_EQ(counts(scene), (Counts{0, 0, 0, 1, 0, 1}));
  EXPECT_EQ(volume(primitive(scene)), 12.0);
  expect_surface(scene);
}

TEST(Repair, TwoCubesThatShareASideLoseOneOfIt) {
  // The shared side is there twice, in opposite directions; one pair of its triangles is left, on edges of three.
  const Scene scene = two_cubes(Vec3d(1, 0, 0));
  EXPECT_EQ(repairs(scene).duplicate, 2U);
  EXPECT_EQ(repairs(scene).cut_edges, 4U);
  expect_surface(scene);
}

TEST(Repair, TrianglesWithoutSharedVerticesAreStitched) {
  const std::vector<Vec3d> corners = cube_corners(Vec3d(0.0));
  std::vector<Vec3d> positions;
  Triangles indices;
  for (const std::uint32_t corner : kCube) {
    indices.push_back(static_cast<std::uint32_t>(positions.size()));
    positions.push_back(corners[corner]);
  }
  std::swap(indices[1], indices[2]);
  const Scene scene = repaired(positions, indices);
  EXPECT_EQ(counts(scene), (Counts{0, 0, 1, 28, 0, 0}));
  EXPECT_EQ(volume(primitive(scene)), 6.0);
  expect_surface(scene);
}

TEST(Repair, SeamsAreOneSurfaceAndKeepTheirAttributes) {
  Primitive seam = primitive_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {0, 1, 2, 3, 4, 5});
  seam.uvs[0] = {{0, 0}, {1, 0}, {0, 1}, {0.5F, 0}, {0, 0.5F}, {1, 1}};
  seam.normals.assign(6, Vec3f(0, 0, 1));
  seam.colors.assign(6, Vec4f(0.5F));
  Primitive other = seam;
  other.material = MaterialId(1U);
  for (Vec3d& p : other.positions) p.x = -p.x;  // down and up, where the first is up and down
  Scene scene = scene_of({seam, other});
  repair_scene(scene);
  EXPECT_EQ(counts(scene), (Counts{0, 0, 2, 0, 0, 0}));
  EXPECT_EQ(primitive(scene).indices, (Triangles{0, 1, 2, 3, 5, 4}));
  EXPECT_EQ(scene.meshes[0].primitives[1].indices, (Triangles{0, 2, 1, 3, 4, 5}));
  EXPECT_EQ(primitive(scene).uvs[0], seam.uvs[0]);
  EXPECT_EQ(primitive(scene).positions, seam.positions);
}

TEST(Repair, ASplitVertexTakesItsAttributesAlong) {
  Primitive tie = primitive_of({{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}}, {0, 2, 1, 0, 3, 4});
  tie.uvs[1] = {{0.25F, 0.75F}, {1, 1}, {1, 0}, {0, 1}, {0, 0}};
  tie.normals.assign(5, Vec3f(0, 0, 1));
  tie.colors = {Vec4f(0.125F), Vec4f(1), Vec4f(1), Vec4f(1), Vec4f(1)};
  Scene scene = scene_of({tie});
  repair_scene(scene);
  const Primitive& p = primitive(scene);
  ASSERT_EQ(p.indices[3], 5U);
  ASSERT_EQ(std::tuple(p.uvs[1].size(), p.normals.size(), p.colors.size()), std::tuple(6U, 6U, 6U));
  EXPECT_EQ(p.uvs[1][5], Vec2f(0.25F, 0.75F));
  EXPECT_EQ(p.colors[5], Vec4f(0.125F));
  EXPECT_TRUE(p.uvs[0].empty());
}

TEST(Repair, NothingIsRepairedWithoutTriangles) {
  EXPECT_EQ(counts(repaired({}, {})), (Counts{}));
  EXPECT_EQ(counts(repaired({{0, 0, 0}, {0, 0, 0}}, {})), (Counts{}));
  EXPECT_EQ(counts(repaired({{0, 0, 0}}, {0, 0, 0})), (Counts{1, 0, 0, 0, 0, 0}));
  Scene none;
  repair_scene(none);
  Scene empty = scene_of({});
  repair_scene(empty);
  EXPECT_TRUE(empty.left_out.empty());
}

TEST(Repair, TooManyTrianglesAroundAPointLeaveTheOrientationAloud) {
  for (const std::uint32_t count : {kMaxTrianglesAroundPoint, kMaxTrianglesAroundPoint + 1}) {
    std::vector<Vec3d> positions{{0, 0, 0}};
    Triangles indices;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto x = static_cast<double>(i);
      positions.emplace_back(x, 1 + x * x, 0);
      indices.insert(indices.end(), {0, i + 1, (i + 1) % count + 1});
    }
    std::swap(indices[4], indices[5]);
    indices.insert(indices.end(), {0, 1, 2});
    const auto start = std::chrono::steady_clock::now();
    const Scene scene = repaired(positions, indices);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    const bool is_left = count == kMaxTrianglesAroundPoint + 1;
    EXPECT_EQ(counts(scene), (Counts{0, 1, is_left ? 0U : 1U, 0, 0, 0}));
    ASSERT_EQ(scene.left_out.size(), is_left ? 1U : 0U);
    if (is_left) {
      EXPECT_EQ(scene.left_out[0].what, "mesh 0: repair of its orientation");
    }
  }
}

}  // namespace
}  // namespace meshlode::scene
