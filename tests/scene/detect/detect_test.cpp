// SPDX-License-Identifier: GPL-3.0-or-later
// Each detector on a shape that has its fault, counted by hand, and on one that is sound.
#include "scene/detect/detect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lab/samples/samples.h"
#include "scene/detect/attribute_faults.h"
#include "scene/detect/edge_faults.h"
#include "scene/detect/face_faults.h"
#include "scene/detect/precision_faults.h"
#include "scene/detect/topology.h"

namespace meshlode::scene {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A unit square in the plane z = 0: two triangles that share the diagonal from vertex 0 to 2.
Primitive make_square() {
  Primitive square;
  square.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 1.0, 0.0}};
  square.indices = {0, 1, 2, 0, 2, 3};
  return square;
}

SceneMaterial sampling(std::uint32_t uv_sets) {
  SceneMaterial material;
  material.uv_sets_used = uv_sets;
  return material;
}

/// A vertex of its own for every corner, attributes copied.
Primitive unshared(const Primitive& shape) {
  Primitive out;
  out.material = shape.material;
  for (const std::uint32_t v : shape.indices) {
    out.indices.push_back(static_cast<std::uint32_t>(out.positions.size()));
    out.positions.push_back(shape.positions[v]);
    if (!shape.normals.empty()) out.normals.push_back(shape.normals[v]);
  }
  return out;
}

Topology topology_of(const Primitive& shape) {
  return make_topology(lab::as_mesh(shape));
}

TEST(Topology, PointsAreWhereVerticesAre) {
  const Topology topology = topology_of(unshared(make_square()));
  EXPECT_EQ(topology.points.size(), 4U);
  EXPECT_EQ(topology.edges.size(), 6U);
  std::size_t runs = 0, inner = 0;
  topology.for_each_edge([&](std::span<const TopologyEdge> edge) {
    ++runs;
    inner += edge.size() == 2 ? 1U : 0U;
  });
  EXPECT_EQ(runs, 5U);
  EXPECT_EQ(inner, 1U);
  EXPECT_DOUBLE_EQ(topology.diagonal * topology.unit, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(topology.median_edge * topology.unit, 1.0);
}

TEST(Topology, PassesOverVerticesWithoutATriangle) {
  Primitive square = make_square();
  square.positions.emplace_back(1e6, 0.0, 0.0);
  const Topology topology = topology_of(square);
  EXPECT_EQ(topology.points.size(), 4U);
  EXPECT_DOUBLE_EQ(topology.diagonal * topology.unit, std::sqrt(2.0));
}

TEST(Topology, NamesTrianglesByTheirPrimitive) {
  SourceMesh mesh = lab::as_mesh(make_square());
  mesh.primitives.emplace_back();  // without triangles
  mesh.primitives.push_back(make_square());
  const Topology topology = make_topology(mesh);
  EXPECT_EQ(topology.name_of_triangle(1), (FaultTriangle{0, 1}));
  EXPECT_EQ(topology.name_of_triangle(2), (FaultTriangle{2, 0}));
}

TEST(Detect, NothingIsWrongWithSoundShapes) {
  for (const Primitive& shape :
       {lab::with_smooth_normals(lab::make_sphere(16)), lab::make_cube(8), lab::make_torus(48, 24), lab::make_plane(20),
        lab::make_rock(24), lab::make_terrain(24, 24), lab::make_crystal(5, 6),
        lab::with_split_normals(lab::make_sphere(8))}) {
    const SourceMesh mesh = lab::as_mesh(shape);
    const std::vector<SceneMaterial> materials{sampling(shape.uvs[0].empty() ? 0U : 1U)};
    for (const Fault& fault : examine_mesh(mesh, materials)) {
      ADD_FAILURE() << name_of(fault.kind) << " in a shape of " << shape.indices.size() / 3 << " triangles";
    }
  }
}

TEST(Detect, CountsWhatIsNotFinite) {
  Primitive square = make_square();
  square.normals.assign(4, Vec3f(0.0F, 0.0F, 1.0F));
  EXPECT_EQ(find_not_finite(lab::as_mesh(square), topology_of(square)).count, 0U);
  square.normals[3].y = kNan;
  square.positions[1].x = std::numeric_limits<double>::infinity();
  const Fault fault = find_not_finite(lab::as_mesh(square), topology_of(square));
  EXPECT_EQ(fault.count, 2U);
  EXPECT_EQ(fault.triangle_count, 2U);
  square.indices[5] = 99;
  EXPECT_EQ(find_not_finite(lab::as_mesh(square), topology_of(square)).count, 3U);
}

TEST(Detect, CountsDegenerateFacesByPositionAndOnALine) {
  Primitive square = make_square();
  EXPECT_EQ(find_degenerate_faces(topology_of(square)).count, 0U);
  square.positions.push_back(square.positions[0]);  // 4: where 0 is
  square.positions.emplace_back(0.5, 0.5, 0.0);     // 5: on the diagonal
  square.indices.insert(square.indices.end(), {0, 0, 1, 0, 4, 2, 0, 5, 2});
  const Fault fault = find_degenerate_faces(topology_of(square));
  EXPECT_EQ(fault.count, 3U);
  EXPECT_EQ(fault.triangles, (std::vector<FaultTriangle>{{0, 2}, {0, 3}, {0, 4}}));
  ASSERT_EQ(fault.costs.size(), 1U);
  EXPECT_DOUBLE_EQ(fault.costs[0].share, 0.6);
  // Small is not degenerate, and far away is not either.
  EXPECT_EQ(find_degenerate_faces(topology_of(lab::scaled(make_square(), 1e-150))).count, 0U);
  Primitive far = make_square();
  for (Vec3d& p : far.positions) p = p * 1e-6 + Vec3d(1.0);
  EXPECT_EQ(find_degenerate_faces(topology_of(far)).count, 0U);
}

TEST(Detect, CountsDuplicatesInEitherDirectionOfOneMaterial) {
  Primitive square = make_square();
  square.indices.insert(square.indices.end(), {1, 2, 0, 0, 3, 2});
  const Fault fault = find_duplicate_faces(topology_of(square));
  EXPECT_EQ(fault.count, 2U);
  EXPECT_EQ(fault.measure, 1.0);
  EXPECT_EQ(fault.triangles, (std::vector<FaultTriangle>{{0, 2}, {0, 3}}));
  SourceMesh layers = lab::as_mesh(make_square());
  layers.primitives.push_back(make_square());
  layers.primitives[1].material = MaterialId(1U);
  EXPECT_EQ(find_duplicate_faces(make_topology(layers)).count, 0U);
}

TEST(Detect, CountsEdgesOfMoreThanTwoTriangles) {
  const Fault fault = find_non_manifold_edges(topology_of(lab::make_three_sheets(5)));
  EXPECT_EQ(fault.count, 5U);
  EXPECT_EQ(fault.measure, 3.0);
  EXPECT_EQ(fault.triangle_count, 15U);
  EXPECT_EQ(find_non_manifold_edges(topology_of(lab::make_double_cone(8))).count, 0U);
}

TEST(Detect, NamesTheFewerOfThoseThatFaceOppositeSides) {
  Primitive torus = lab::make_torus(24, 12);
  EXPECT_EQ(find_misoriented(topology_of(torus)).count, 0U);
  std::swap(torus.indices[3 * 7], torus.indices[3 * 7 + 1]);
  const Fault fault = find_misoriented(topology_of(torus));
  EXPECT_EQ(fault.count, 3U);
  EXPECT_EQ(fault.triangles, (std::vector<FaultTriangle>{{0, 7}}));
  // All turned is as good as none.
  for (std::size_t t = 0; t < torus.indices.size(); t += 3) std::swap(torus.indices[t], torus.indices[t + 1]);
  EXPECT_EQ(find_misoriented(topology_of(torus)).triangles, (std::vector<FaultTriangle>{{0, 7}}));
  EXPECT_GT(find_misoriented(topology_of(lab::make_moebius(24, 3))).count, 0U);
}

TEST(Detect, FindsGapsAlongBordersAndTheirWidth) {
  Primitive plane = lab::make_plane(8);
  const Primitive other = lab::make_plane(8);
  // A second plane that continues the first at x = 1, a millionth away: 9 points on each side.
  for (const Vec3d& p : other.positions) plane.positions.push_back(p + Vec3d(2.0 + 1e-6, 0.0, 0.0));
  const auto first = static_cast<std::uint32_t>(other.positions.size());
  for (const std::uint32_t i : other.indices) plane.indices.push_back(i + first);
  const Fault fault = find_unwelded_seams(topology_of(plane));
  EXPECT_EQ(fault.count, 18U);
  EXPECT_NEAR(fault.measure, 1e-6, 1e-12);
  for (std::size_t i = first; i < plane.positions.size(); ++i)
    plane.positions[i].x = other.positions[i - first].x + 2.0;
  EXPECT_EQ(find_unwelded_seams(topology_of(plane)).count, 0U) << "equal positions are welded";
  for (std::size_t i = first; i < plane.positions.size(); ++i) plane.positions[i].x += 0.1;
  EXPECT_EQ(find_unwelded_seams(topology_of(plane)).count, 0U) << "a gap that can be seen is meant";
}

/// Leaf cards, and one more that nearly touches the first in one corner.
Primitive touching_cards(std::uint32_t count) {
  Primitive cards = lab::make_foliage(count);
  const Vec3d move = cards.positions[0] - cards.positions[2] + Vec3d(1e-5, 0.0, 0.0);
  const auto first = static_cast<std::uint32_t>(cards.positions.size());
  for (std::size_t k = 0; k < 4; ++k) cards.positions.push_back(cards.positions[k] + move);
  for (std::size_t k = 0; k < 6; ++k) cards.indices.push_back(cards.indices[k] + first);
  return cards;
}

TEST(Detect, AFewPointsOfManyAreNearByChance) {
  EXPECT_EQ(find_unwelded_seams(topology_of(touching_cards(20))).count, 2U);
  EXPECT_EQ(find_unwelded_seams(topology_of(touching_cards(200))).count, 0U);
}

TEST(Detect, DetailThatVanishesOnTheGrid) {
  Primitive shape = lab::make_plane(20, 1000.0);  // a grid of 1/16 or finer: 2.5e-5 of 2828 and more, a power of two
  const auto add = [&](double radius, const Vec3d& at) {
    const Primitive ball = lab::make_sphere(4, radius);
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    for (const Vec3d& p : ball.positions) shape.positions.push_back(p + at);
    for (const std::uint32_t v : ball.indices) shape.indices.push_back(first + v);
  };
  add(10.0, Vec3d(0.0, 50.0, 0.0));
  EXPECT_EQ(find_finer_than_grid(topology_of(shape)).count, 0U) << "small beside the plane, large beside the grid";
  add(0.001, Vec3d(0.5, 1.0, 0.5));
  const Fault fault = find_finer_than_grid(topology_of(shape));
  EXPECT_EQ(fault.measure, 1.0 / 16.0);
  EXPECT_EQ(fault.count, 192U) << "all of the second ball";
  ASSERT_FALSE(fault.triangles.empty());
  EXPECT_EQ(fault.triangles[0].triangle, 800U + 192U);
  EXPECT_EQ(find_finer_than_grid(topology_of(lab::scaled(shape, 1e-150))).count, 192U) << "no unit is meant";
  EXPECT_EQ(find_finer_than_grid(topology_of(lab::make_slivers(200, 1e5))).count, 0U) << "needles are another fault";
}

TEST(Detect, NeedlesAreLongerThanHigh) {
  const Fault fault = find_needles(topology_of(lab::make_slivers(50, 1e4)));
  EXPECT_EQ(fault.count, 50U);
  EXPECT_NEAR(fault.measure, 5e3, 1.0) << "two widths high";
  EXPECT_EQ(find_needles(topology_of(lab::make_slivers(50, 20.0))).count, 0U);
}

TEST(Detect, ASpikeHoldsTheError) {
  Primitive sphere = lab::make_sphere(40);
  EXPECT_EQ(find_error_in_few(topology_of(sphere)).count, 0U);
  const std::uint32_t tip = sphere.indices[3 * 1000];
  sphere.positions[tip] *= 3.0;
  const Fault fault = find_error_in_few(topology_of(sphere));
  EXPECT_EQ(fault.count, 19U);
  EXPECT_GT(fault.measure, 0.5);
  ASSERT_FALSE(fault.triangles.empty());
  const std::size_t worst = 3 * std::size_t{fault.triangles[0].triangle};
  EXPECT_TRUE(std::find(sphere.indices.begin() + worst, sphere.indices.begin() + worst + 3, tip) !=
              sphere.indices.begin() + worst + 3)
      << "the worst triangle has the tip";
}

TEST(Detect, FarAwayFloatsAreCoarserThanEdges) {
  Primitive sphere = lab::make_sphere(20);
  EXPECT_EQ(find_far_from_origin(topology_of(sphere)).count, 0U);
  for (Vec3d& p : sphere.positions) p += Vec3d(100'000.0, 0.0, 0.0);
  const Fault fault = find_far_from_origin(topology_of(sphere));
  EXPECT_EQ(fault.count, sphere.positions.size());
  EXPECT_EQ(fault.measure, 0x1p-7) << "the step of floats at 100,000";
  // Large, but not far: as fine as it can be.
  EXPECT_EQ(find_far_from_origin(topology_of(lab::scaled(lab::make_sphere(20), 1e6))).count, 0U);
}

TEST(Detect, NormalsThatNoAngleSplits) {
  const Primitive smooth = lab::with_smooth_normals(lab::make_sphere(8));
  Primitive split = unshared(smooth);
  const Primitive flat = lab::with_split_normals(smooth);
  EXPECT_EQ(find_split_normals(lab::as_mesh(split), topology_of(split)).count, 0U) << "equal normals are one";
  EXPECT_EQ(find_split_normals(lab::as_mesh(flat), topology_of(flat)).count, 0U) << "flat is meant";
  for (std::size_t i = 0; i < split.normals.size(); ++i) split.normals[i] = 0.5F * (split.normals[i] + flat.normals[i]);
  const Fault fault = find_split_normals(lab::as_mesh(split), topology_of(split));
  EXPECT_EQ(fault.measure, 6.0 * 8 * 8 + 2);
  EXPECT_GT(fault.count, split.positions.size() / 4) << "each quad around a point has a wedge of its own";
  // A cube's edges are sharp: three normals at a corner are what they have to be.
  Primitive cube = lab::with_split_normals(lab::make_cube(6));
  cube.normals[0] = Vec3f(glm::normalize(Vec3d(cube.normals[0]) + Vec3d(0.1)));  // not flat any more
  EXPECT_EQ(find_split_normals(lab::as_mesh(cube), topology_of(cube)).count, 0U);
}

TEST(Detect, IslandsBeyondThePiecesOfTheSurface) {
  const std::vector<SceneMaterial> materials{sampling(1)};
  Primitive plane = lab::make_plane(16);
  for (const Vec3d& p : plane.positions) plane.uvs[0].emplace_back(p.x, p.z);
  EXPECT_EQ(find_uv_islands(lab::as_mesh(plane), topology_of(plane), materials).count, 0U);
  Primitive cut = unshared(plane);
  for (std::size_t i = 0; i < cut.positions.size(); ++i) {
    cut.uvs[0].emplace_back(static_cast<float>(i), static_cast<float>(i % 3));
  }
  const Fault fault = find_uv_islands(lab::as_mesh(cut), topology_of(cut), materials);
  EXPECT_EQ(fault.count, 512U);
  EXPECT_EQ(fault.measure, 1.0);
  EXPECT_EQ(fault.triangle_count, 512U);
  EXPECT_EQ(find_uv_islands(lab::as_mesh(cut), topology_of(cut), {}).count, 0U) << "no material samples it";
  // Leaf cards are loose anyway: an island each is what there must be.
  const Primitive foliage = lab::make_foliage(100);
  EXPECT_EQ(find_uv_islands(lab::as_mesh(foliage), topology_of(foliage), materials).count, 0U);
}

TEST(Detect, CoordinatesThatAreMissingOrOfNoUse) {
  const std::vector<SceneMaterial> sampled{sampling(1)}, plain{sampling(0)};
  Primitive square = make_square();
  const Topology topology = topology_of(square);
  EXPECT_EQ(find_missing_uvs(lab::as_mesh(square), topology, sampled).count, 1U);
  EXPECT_EQ(find_missing_uvs(lab::as_mesh(square), topology, plain).count, 0U);
  EXPECT_EQ(find_unused_uvs(lab::as_mesh(square), topology, plain).count, 0U);
  square.uvs[0].assign(4, Vec2f(0.0F));
  square.uvs[2].assign(4, Vec2f(0.0F));
  EXPECT_EQ(find_missing_uvs(lab::as_mesh(square), topology, sampled).count, 0U);
  const Fault unused = find_unused_uvs(lab::as_mesh(square), topology, sampled);
  EXPECT_EQ(unused.count, 1U);
  ASSERT_EQ(unused.costs.size(), 1U);
  EXPECT_EQ(unused.costs[0].amount, 32.0);
  EXPECT_EQ(find_unused_uvs(lab::as_mesh(square), topology, plain).count, 2U);
}

TEST(Detect, ADozenMaterialsAreMany) {
  SourceMesh mesh;
  for (std::uint32_t m = 0; m < 11; ++m) {
    mesh.primitives.push_back(make_square());
    mesh.primitives.back().material = MaterialId(m);
  }
  EXPECT_EQ(find_many_materials(mesh, make_topology(mesh)).count, 0U);
  mesh.primitives.push_back(make_square());
  mesh.primitives.back().material = MaterialId(11U);
  const Fault fault = find_many_materials(mesh, make_topology(mesh));
  EXPECT_EQ(fault.count, 12U);
  EXPECT_EQ(fault.triangle_count, 24U) << "layers on each other meet everywhere";
}

TEST(Detect, ScenesOfSmallMeshesThoseNobodyDrawsAndImagesNobodySees) {
  Scene scene = lab::as_scene(lab::as_mesh(lab::make_cube(1)));
  EXPECT_TRUE(examine_scene(scene).empty()) << "one small mesh harms nobody";
  for (int i = 1; i < 16; ++i) scene.instances.push_back(scene.instances[0]);
  std::vector<Fault> faults = examine_scene(scene);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, FaultKind::kSmallMeshes);
  EXPECT_EQ(faults[0].measure, 16.0);
  EXPECT_EQ(faults[0].meshes, std::vector<std::uint32_t>{0});

  scene = lab::as_scene(lab::as_mesh(lab::make_sphere(8)));
  scene.meshes.push_back(lab::as_mesh(lab::make_sphere(8)));
  scene.blobs.resize(2);
  for (SceneBlob& blob : scene.blobs) blob.bytes.resize(1000);
  TextureUse use;
  use.blob = 1;
  scene.materials[0].textures.push_back(use);
  faults = examine_scene(scene);
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].kind, FaultKind::kUndrawnMeshes);
  EXPECT_DOUBLE_EQ(faults[0].costs.at(0).share, 0.5);
  EXPECT_EQ(faults[1].kind, FaultKind::kUnsampledImages);
  EXPECT_EQ(faults[1].costs.at(0).amount, 1000.0);
}

}  // namespace
}  // namespace meshlode::scene
