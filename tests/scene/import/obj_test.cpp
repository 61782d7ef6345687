// SPDX-License-Identifier: GPL-3.0-or-later
// OBJ as its users write it: dented faces, attributes of some faces alone, objects and groups.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "polygon_support.h"

namespace meshlode::testing {
namespace {

using ObjAsWritten = PolygonFiles;

const std::string kSquareObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";

TEST_F(ObjAsWritten, AMarkInFrontAndAnyLineEndsAreRead) {
  std::string cr = kSquareObj + "f 1 2 3 4\n";
  for (char& c : cr) c = c == '\n' ? '\r' : c;
  for (const std::string& bytes :
       {"\xEF\xBB\xBF" + kSquareObj + "f 1 2 3 4\n", cr, "\xEF\xBB\xBF" + cr, "\f" + kSquareObj + "f 1 2 3 4 \t\v",
        kSquareObj + std::string("f 1 2 3 4\0\0", 11)}) {
    const auto scene = read("a.obj", bytes);
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(area(*scene), 1.0);
    EXPECT_EQ(scene->triangles_in_file, 1U);  // a face, however it is cut
    EXPECT_EQ(all_left_out(*scene), "");
  }
}

TEST_F(ObjAsWritten, CommentsMayFollowNumbers) {
  const auto scene =
      read("a.obj", "v 0 0 0 # origin\nv 1 0 0\nv 0 1 0\nvt 0 0 # u v\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 # f\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(area(*scene), 0.5);
}

TEST_F(ObjAsWritten, DentedAndHoledFacesCoverTheirAreaAndNoMore) {
  // A frame whose hole is cut open by a bridge, in planes of every direction; the bridge's ends have vertices of their
  // own, or are named twice.
  const std::string frame =
      "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 0 0 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\nv 1 1 0\n";
  for (const char* face : {"f 1 2 3 4 5 6 7 8 9 10\n", "f 1 2 3 4 1 6 7 8 9 6\n", "f 10 9 8 7 6 5 4 3 2 1\n"}) {
    const auto scene = read("a.obj", frame + face);
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_DOUBLE_EQ(area(*scene), 12.0) << face;
    EXPECT_EQ(triangle_count(*scene), 8U);
    EXPECT_EQ(scene->triangles_in_file, 1U);
    EXPECT_EQ(all_left_out(*scene), "");
  }
  const auto tilted =
      read("a.obj", "v 0 0 0\nv 5 5 1\nv 5 5 3\nv 4 4 3\nv 4 4 2\nv 3 3 2\nv 3 3 3\nv 0 0 3\nf 1 2 3 4 5 6 7 8\n");
  ASSERT_TRUE(tilted) << describe(tilted);
  EXPECT_NEAR(area(*tilted), std::sqrt(2.0) * (5 * 3 - 2.5 - 1), 1e-12);
}

TEST_F(ObjAsWritten, FacesThatCrossThemselvesAreNamed) {
  const auto scene = read("a.obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nv -1 1 0\nf 1 2 3 4\nf 1 2 3 4 5\nf 1 3 2\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(triangle_count(*scene), 6U);
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_EQ(scene->left_out[0].what, "the shape of 2 faces");
}

TEST_F(ObjAsWritten, AFaceThatGoesRoundManyTimesIsThereOnce) {
  for (const int rounds : {2, 3, 4}) {
    std::string face = "f";
    for (int i = 0; i < rounds; ++i) face += " 1 2 3 4";
    const auto scene = read("a.obj", kSquareObj + face + "\n");
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(area(*scene), 1.0) << rounds;
    EXPECT_EQ(triangle_count(*scene), 2U);
  }
}

TEST_F(ObjAsWritten, CornersThatRepeatTheOneBeforeAreOne) {
  const auto scene = read("a.obj", kSquareObj + "f 1 1 2 3 3\nf 1 2 3 1\nf 1 1 2\nf 1 2 1 2\nf 1 2\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(triangle_count(*scene), 2U);
  EXPECT_EQ(all_left_out(*scene), "3 faces: they have fewer than three distinct corners; ");
  EXPECT_EQ(scene->triangles_in_file, 2U);  // a face without three corners is no triangle
}

TEST_F(ObjAsWritten, FacesKeepTheAttributesThatTheyHave) {
  const auto scene = read("a.obj", kSquareObj + "f 1/1/1 2/2/1 3/3/1\nf 1 3 4\nf 1//1 2//1 4//1\nf 1/1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->meshes.size(), 1U);
  const auto& parts = scene->meshes[0].primitives;
  ASSERT_EQ(parts.size(), 3U);  // both, normals alone, neither
  EXPECT_EQ(parts[0].uvs[0][parts[0].indices[2]], Vec2f(1, 0));
  EXPECT_EQ(parts[0].normals[0], Vec3f(0, 0, 1));
  EXPECT_TRUE(parts[1].uvs[0].empty());
  EXPECT_EQ(parts[1].normals.size(), 3U);
  EXPECT_TRUE(parts[2].uvs[0].empty() && parts[2].normals.empty());
  EXPECT_EQ(parts[2].indices.size(), 6U);
  EXPECT_EQ(all_left_out(*scene), "texture coordinates: 1 face: only some corners have them; ");
}

TEST_F(ObjAsWritten, AttributesThatAreNotThereCostNoFaceAndPositionsCostOneUnderRepair) {
  const std::string bytes = kSquareObj + "f 1/1/1 2/2/1 9/3/1\nf 1/1/1 2/2/1 3/9/1\nf 1/1/1 3/3/1 4/4/7\n";
  EXPECT_TRUE(read("a.obj", kSquareObj + "f 1/1/1 2/2/1 3/9/1\nf 1/1/1 3/3/1 4/4/7\n"));
  const auto refused = read("a.obj", bytes);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().detail.find("--repair drops the face"), std::string::npos) << refused.error().detail;
  const auto scene = read("a.obj", bytes, {.repair = true});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(triangle_count(*scene), 2U);
  EXPECT_EQ(scene->triangles_in_file, 3U);
  EXPECT_EQ(scene->meshes[0].drops.repaired, 1U);
  EXPECT_EQ(all_left_out(*scene),
            "texture coordinates: 1 face: they name one that no line before them has; "
            "normals: 1 face: they name one that no line before them has; ");
  ASSERT_EQ(scene->meshes[0].primitives.size(), 2U);
  EXPECT_TRUE(scene->meshes[0].primitives[0].uvs[0].empty());
  EXPECT_FALSE(scene->meshes[0].primitives[0].normals.empty());
  EXPECT_FALSE(scene->meshes[0].primitives[1].uvs[0].empty());
  EXPECT_TRUE(scene->meshes[0].primitives[1].normals.empty());
}

TEST_F(ObjAsWritten, ColoursOfSomeVerticesAreKeptWhereAWholeFaceHasThem) {
  const auto scene = read("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 2\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->meshes[0].primitives.size(), 2U);
  EXPECT_EQ(primitive(scene).colors[0], Vec4f(1, 0, 0, 1));
  EXPECT_TRUE(scene->meshes[0].primitives[1].colors.empty());
  EXPECT_EQ(all_left_out(*scene),
            "colours: 1 face: only some corners have them; colours: 1 vertex: a level outside 0 … 1, which is "
            "clamped; ");
}

TEST_F(ObjAsWritten, WhatIsNotReadIsNamedOnceWithACount) {
  const auto scene = read("a.obj",
                          "v 0 0 0 0.5\nv 1 0 0\nv 0 1 0\nvt 0 0 3\ns 1\ns off\ng a b\ng c\nl 1 2\nl 2 3\nlod 2\n"
                          "f 1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(all_left_out(*scene),
            "the fourth number of v: 1 vertex: a weight for curves; the third number of vt: 1 line: it is not 0; "
            "smoothing groups (s): 1 line: without vn a face is flat; the names of 2 groups: groups (g) are no meshes: "
            "a b, c; "
            "l: 2 lines: points and lines are not triangles; lod: 1 line: not a keyword that is read; ");
}

TEST_F(ObjAsWritten, ObjectsThatStandApartAreMeshesWithNames) {
  const std::string first = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", apart = "v 5 0 0\nv 6 0 0\nv 5 1 0\n";
  const auto scene = read("a.obj", first + apart + "f 1 2 3\no box\nf 4 5 6\no empty\n");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->meshes.size(), 2U);
  EXPECT_EQ(scene->meshes[0].name, "a");  // what is in no object
  EXPECT_EQ(scene->meshes[1].name, "box");
  ASSERT_EQ(scene->instances.size(), 2U);
  EXPECT_EQ(scene->instances[1].name, "box");
  EXPECT_EQ(scene->instances[1].mesh, MeshId(1U));
  EXPECT_EQ(scene->meshes[1].primitives[0].positions.size(), 3U);
  EXPECT_EQ(all_left_out(*scene), "the names of 1 object: they have no faces: empty; ");
  // One place in common, though by another line: -0 is 0.
  const auto joined = read("a.obj", first + "v -0 1 0\nv 6 0 0\nv 5 1 0\no a\nf 1 2 3\no b\nf 4 5 6\no a\nf 1 3 2\n");
  ASSERT_TRUE(joined) << describe(joined);
  ASSERT_EQ(joined->meshes.size(), 1U);
  EXPECT_EQ(all_left_out(*joined), "the names of 2 objects: they share positions and stay one mesh: a, b; ");
}

/// A sphere of which every other ring is in another group or object.
std::string sphere(const std::string& keyword) {
  constexpr int kRings = 12, kSides = 24;
  std::string vertices, faces;
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j < kSides; ++j) {
      const double t = 3.14159265358979 * i / kRings, f = 6.28318530717959 * j / kSides;
      const bool is_pole = i == 0 || i == kRings;
      vertices += "v " + std::to_string(is_pole ? 0.0 : std::sin(t) * std::cos(f)) + " " + std::to_string(std::cos(t)) +
                  " " + std::to_string(is_pole ? 0.0 : std::sin(t) * std::sin(f)) + "\n";
    }
  }
  for (int i = 0; i < kRings; ++i) {
    faces += keyword + " part" + std::to_string(i % 2) + "\n";
    for (int j = 0; j < kSides; ++j) {
      const auto at = [&](int ring, int side) { return " " + std::to_string(ring * kSides + side % kSides + 1); };
      if (i > 0) faces += "f" + at(i, j) + at(i, j + 1) + at(i + 1, j) + "\n";
      if (i + 1 < kRings) faces += "f" + at(i, j + 1) + at(i + 1, j + 1) + at(i + 1, j) + "\n";
    }
  }
  return vertices + faces;
}

TEST_F(ObjAsWritten, AClosedSphereInGroupsOrObjectsHasNoBorder) {
  for (const std::string keyword : {"g", "o"}) {
    const auto scene = read("a.obj", sphere(keyword));
    ASSERT_TRUE(scene) << describe(scene);
    ASSERT_EQ(scene->meshes.size(), 1U);
    std::map<std::pair<std::array<double, 3>, std::array<double, 3>>, int> edges;
    for (const scene::Primitive& p : scene->meshes[0].primitives) {
      for (std::size_t i = 0; i < p.indices.size(); ++i) {
        const Vec3d &a = p.positions[p.indices[i]], &b = p.positions[p.indices[i / 3 * 3 + (i + 1) % 3]];
        ++edges[{{a.x, a.y, a.z}, {b.x, b.y, b.z}}];
        --edges[{{b.x, b.y, b.z}, {a.x, a.y, a.z}}];
      }
    }
    for (const auto& [edge, balance] : edges) EXPECT_EQ(balance, 0);
    EXPECT_EQ(scene->left_out.size(), 1U);
  }
}

TEST_F(ObjAsWritten, HostileFacesEnd) {
  std::string long_face = kSquareObj + "f";
  for (int i = 0; i < 100000; ++i) long_face += i % 2 == 0 ? " 1 2" : " 3 4";
  EXPECT_TRUE(read("a.obj", long_face + "\n"));
  EXPECT_FALSE(read("a.obj", kSquareObj + "f 1/// 2/x 3\n"));
  EXPECT_TRUE(read("a.obj", kSquareObj + "f 1/// 2/x 3\nf x y z\nf / // ///\n", {.repair = true}));
  std::string objects = kSquareObj;
  for (int i = 0; i < 70000; ++i) objects += "o n" + std::to_string(i) + "\n";
  EXPECT_TRUE(read("a.obj", objects + "f 1 2 3\n"));
}

TEST_F(ObjAsWritten, ANormalThatSaysNothingCostsNoOther) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nvn 0 0.6 0.8\nvn 0 0 nan\n";
  const auto whole = read("a.obj", corners + "s 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
  ASSERT_TRUE(whole) << describe(whole);
  EXPECT_EQ(primitive(whole).normals.at(3), Vec3f(0, 0.6F, 0.8F));
  EXPECT_EQ(all_left_out(*whole), "");  // nor is there a flat face that would be smooth
  const auto scene = read("a.obj", corners + "f 1//1 2//1 3//1\nf 1//1 3//1 4//2\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(primitive(scene).normals.at(0), Vec3f(0, 0.6F, 0.8F));
  EXPECT_EQ(primitive(scene).normals.at(3), Vec3f(0, 0, 1));
  EXPECT_EQ(all_left_out(*scene),
            "normals: 1 are not finite or have no length; the triangles' own stand in for them; ");
}

TEST_F(ObjAsWritten, TextureCoordinatesThatAreNotFiniteAreCounted) {
  const auto scene = read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nvt 0 -inf\nvt 1 1\nf 1/1 2/2 3/3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(all_left_out(*scene), "texture coordinates: 2 are not finite; zero stands in for them; ");
}

TEST_F(ObjAsWritten, FacesWhosePartsCancelOutCrossThemselves) {
  const auto bow = read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 4 3\n");
  ASSERT_TRUE(bow) << describe(bow);
  EXPECT_EQ(all_left_out(*bow),
            "the shape of 1 face: their sides cross or touch each other, so that what is inside is a guess; ");
  const auto five = read("a.obj", "v 0 0 0\nv 1 1 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 3 4 5\nf 1 2 3 4 5\n");
  ASSERT_TRUE(five) << describe(five);
  EXPECT_EQ(all_left_out(*five),
            "the shape of 2 faces: their sides cross or touch each other, so that what is inside is a guess; ");
}

}  // namespace
}  // namespace meshlode::testing
