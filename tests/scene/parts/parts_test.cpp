// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces that are taken out of a mesh are all there, once, with their attributes, and so is the rest.
#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "lab/samples/samples.h"
#include "scene/parts/pieces.h"
#include "scene/parts/split_parts.h"

namespace meshlode::scene {
namespace {

using Corner = std::tuple<double, double, double, float, float>;
using Triangle = std::tuple<std::uint32_t, std::array<Corner, 3>>;

/// Of these meshes, in no order: material, and of each corner its position, normal.x and u.
std::vector<Triangle> triangles_of(std::span<const SourceMesh> meshes) {
  std::vector<Triangle> out;
  for (const SourceMesh& mesh : meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        std::array<Corner, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = primitive.indices[i + k];
          const Vec3d& p = primitive.positions[v];
          corners[k] = {p.x, p.y, p.z, primitive.normals.empty() ? 2.0F : primitive.normals[v].x,
                        primitive.uvs[0].empty() ? -1.0F : primitive.uvs[0][v].x};
        }
        out.emplace_back(primitive.material.value, corners);
      }
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// A rock of material 0, and cards of materials 0 and 1.
Scene rock_and_cards() {
  SourceMesh mesh = lab::as_mesh(lab::make_rock(6));
  mesh.name = "tree";
  mesh.drops.repaired = 3;
  mesh.primitives.push_back(lab::make_foliage(40));
  mesh.primitives.push_back(lab::make_grass(30));
  mesh.primitives[1].material = MaterialId(1U);
  mesh.primitives[2].material = MaterialId(0U);
  mesh.primitives[2].normals.clear();
  Scene scene = lab::as_scene(std::move(mesh));
  scene.materials.resize(2);
  scene.meshes.push_back(lab::as_mesh(lab::make_sphere(4)));
  return scene;
}

TEST(Pieces, ShareNoPosition) {
  Primitive pair = lab::make_foliage(2);
  const Pieces apart(lab::as_mesh(pair));
  ASSERT_EQ(apart.pieces.size(), 2U);
  EXPECT_EQ(apart.pieces[0].triangles, 2U);
  EXPECT_EQ(apart.of_triangle, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  // Vertices in one place are one position, whatever primitive they are of.
  SourceMesh two = lab::as_mesh(pair);
  two.primitives.push_back(lab::make_foliage(1));
  two.primitives[1].material = MaterialId(1U);
  two.primitives[1].positions[0] = pair.positions[pair.indices[0]];
  const Pieces joined(two);
  ASSERT_EQ(joined.pieces.size(), 2U);
  EXPECT_EQ(joined.pieces[0].triangles, 4U);
  using Flags = std::vector<std::uint8_t>;
  EXPECT_EQ(joined.find_small(two, std::vector<std::uint32_t>{4, 4}), (Flags{1, 1}));
  EXPECT_EQ(joined.find_small(two, std::vector<std::uint32_t>{4, 3}), (Flags{0, 1})) << "of both its materials";
  EXPECT_EQ(joined.find_small(two, std::vector<std::uint32_t>{4}), (Flags{0, 1}));
  EXPECT_EQ(joined.find_small(two, {}), (Flags{0, 0}));
}

TEST(Pieces, AreNoMoreThanPartsByVertex) {
  const Primitive pair = lab::make_foliage(2);
  EXPECT_EQ(count_parts_by_vertex(lab::as_mesh(pair)), 2U);
  SourceMesh mesh = lab::as_mesh(lab::make_rock(6));
  EXPECT_EQ(Pieces(mesh).pieces.size(), 1U);
  EXPECT_EQ(count_parts_by_vertex(mesh), 6U) << "the faces of the cube that it is made from";
  // A vertex of its own for each corner, and one that no triangle has.
  Primitive& primitive = mesh.primitives[0];
  const std::size_t triangles = primitive.indices.size() / 3;
  const std::vector<Vec3d> positions = primitive.positions;
  primitive.positions.clear();
  for (std::uint32_t& v : primitive.indices) {
    primitive.positions.push_back(positions[v]);
    v = static_cast<std::uint32_t>(primitive.positions.size()) - 1U;
  }
  primitive.positions.push_back(Vec3d(9.0));
  EXPECT_EQ(Pieces(mesh).pieces.size(), 1U);
  EXPECT_EQ(count_parts_by_vertex(mesh), triangles);
  mesh.primitives.push_back(pair);
  EXPECT_EQ(count_parts_by_vertex(mesh), triangles + 2);
}

TEST(SplitParts, TakeEachTriangleOnce) {
  const Scene before = rock_and_cards();
  Scene scene = before;
  const std::vector<MeshPart> parts{{0, "tree#leaves", {2, 2}}};
  split_parts(scene, parts);
  ASSERT_EQ(scene.meshes.size(), 3U);
  EXPECT_EQ(scene.meshes[2].name, "tree#leaves");
  EXPECT_EQ(scene.meshes[0].name, "tree");
  EXPECT_EQ(scene.meshes[0].drops.repaired, 3U);
  EXPECT_EQ(scene.meshes[2].drops.repaired, 0U);
  ASSERT_EQ(scene.meshes[0].primitives.size(), 1U) << "the rock; an empty primitive is none";
  EXPECT_EQ(scene.meshes[2].primitives.size(), 2U);
  EXPECT_EQ(Pieces(scene.meshes[2]).pieces.size(), 70U);
  EXPECT_EQ(triangles_of(scene.meshes), triangles_of(before.meshes));
  for (const SourceMesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      std::vector<std::uint8_t> is_used(primitive.positions.size(), 0);
      for (const std::uint32_t v : primitive.indices) is_used.at(v) = 1;
      EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 1), static_cast<std::ptrdiff_t>(is_used.size()));
    }
  }
}

TEST(SplitParts, OfOnePrimitiveBothHaveSome) {
  SourceMesh mesh = lab::as_mesh(lab::make_rock(6));
  const Primitive cards = lab::make_foliage(40);
  Primitive& all = mesh.primitives[0];
  const auto base = static_cast<std::uint32_t>(all.positions.size());
  all.positions.insert(all.positions.begin(), cards.positions.begin(), cards.positions.end());
  all.normals.insert(all.normals.begin(), cards.normals.begin(), cards.normals.end());
  all.uvs[0].insert(all.uvs[0].begin(), cards.uvs[0].begin(), cards.uvs[0].end());
  for (std::uint32_t& v : all.indices) v += static_cast<std::uint32_t>(cards.positions.size());
  all.indices.insert(all.indices.end(), cards.indices.begin(), cards.indices.end());
  Scene scene = lab::as_scene(std::move(mesh));
  const Scene before = scene;
  split_parts(scene, std::vector<MeshPart>{{0, "leaves", {2}}});
  EXPECT_EQ(scene.meshes[0].primitives[0].positions.size(), base);
  EXPECT_EQ(scene.meshes[1].primitives[0].indices.size(), 3U * 80U);
  EXPECT_EQ(triangles_of(scene.meshes), triangles_of(before.meshes));
}

TEST(SplitParts, StandWhereTheirMeshDoes) {
  Scene scene = rock_and_cards();
  scene.instances.assign(3, {});
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.instances[i].name = std::string(1, static_cast<char>('a' + i));
    scene.instances[i].node = 10 + i;
    scene.instances[i].mesh = MeshId(i % 2);
    scene.instances[i].transform[3].x = i;
  }
  split_parts(scene, std::vector<MeshPart>{{0, "0", {2, 2}}, {1, "1", {1000}}});
  ASSERT_EQ(scene.instances.size(), 6U);
  const std::array<std::uint32_t, 6> meshes{0, 1, 0, 2, 3, 2}, of{0, 1, 2, 0, 1, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(scene.instances[i].mesh, MeshId(meshes[i])) << i;
    EXPECT_EQ(scene.instances[i].node, 10 + of[i]) << i;
    EXPECT_EQ(scene.instances[i].name, scene.instances[of[i]].name) << i;
    EXPECT_EQ(scene.instances[i].transform, scene.instances[of[i]].transform) << i;
  }
  EXPECT_TRUE(scene.meshes[1].primitives.empty()) << "all of it was taken";
}

}  // namespace
}  // namespace meshlode::scene
