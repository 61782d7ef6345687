// SPDX-License-Identifier: GPL-3.0-or-later
// PLY as its users write it: texture coordinates of corners, textures, colours of faces, headers of any line ends.
#include <gtest/gtest.h>

#include "polygon_support.h"

namespace meshlode::testing {
namespace {

using PlyAsWritten = PolygonFiles;

std::string header(const std::string& vertex, const std::string& face, const std::string& comments = "",
                   int faces = 2) {
  return "ply\nformat ascii 1.0\n" + comments +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + vertex + "element face " +
         std::to_string(faces) + "\nproperty list uchar int vertex_indices\n" + face + "end_header\n";
}
const std::string kVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kUv = "property list uchar float texcoord\n", kPng = "\x89PNG\r\n";

std::string with_cr(std::string text) {
  for (char& c : text) c = c == '\n' ? '\r' : c;
  return text;
}

TEST_F(PlyAsWritten, AHeaderMayHaveAnyLineEndsBeforeABinaryBody) {
  const std::string head =
      "ply\nformat binary_little_endian 1.0\ncomment a CAD program\nelement vertex 4\nproperty uchar x\nproperty uchar "
      "y\n"
      "property uchar z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n";
  // The first byte of the body is a line feed, which belongs to it.
  const std::string body(
      "\n\n\0"
      "\r\n\0"
      "\r\r\0"
      "\n\r\0"
      "\4\0\1\2\3",
      17);
  std::string crlf;
  for (const char c : head) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const std::string& bytes :
       {head + body, with_cr(head) + body, crlf + body, "\xEF\xBB\xBF" + with_cr(head) + body}) {
    for (const char* name : {"a.ply", "a.bin"}) {
      const auto scene = read(name, bytes);
      ASSERT_TRUE(scene) << describe(scene);
      EXPECT_EQ(area(*scene), 9.0);
      EXPECT_EQ(all_left_out(*scene), "");
    }
  }
}

TEST_F(PlyAsWritten, AsciiBodiesMayHaveAnyLineEnds) {
  const std::string bytes = header("", "", "", 1) + kVertices + "4 0 1 2 3\n";
  for (const std::string& text :
       {bytes, with_cr(bytes), "\xEF\xBB\xBF" + bytes, bytes + "\n\n \f", "ply \t" + bytes.substr(3)}) {
    const auto scene = read("a.ply", text);
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(area(*scene), 1.0);
    EXPECT_EQ(scene->triangles_in_file, 1U);  // a face, however it is cut
    EXPECT_EQ(all_left_out(*scene), "");
  }
}

TEST_F(PlyAsWritten, TextureCoordinatesOfCornersAndTheirTexture) {
  folder_.write("my tex.png", kPng);
  const auto scene = read("a.ply", header("", kUv, "comment TextureFile my tex.png\n") + kVertices +
                                       "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0.5 0 1 0.25 0 1\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(all_left_out(*scene), "");
  const scene::Primitive& p = primitive(scene);
  ASSERT_EQ(p.indices.size(), 6U);
  EXPECT_EQ(p.positions.size(), 6U);               // 0 and 2 have two each
  EXPECT_EQ(p.uvs[0][p.indices[2]], Vec2f(1, 0));  // glTF's begin above
  EXPECT_EQ(p.uvs[0][p.indices[3]], Vec2f(0.5F, 1));
  EXPECT_EQ(p.uvs[0][p.indices[4]], Vec2f(1, 0.75F));
  ASSERT_EQ(scene->materials.size(), 1U);
  EXPECT_EQ(scene->materials[0].name, "my tex");
  EXPECT_EQ(scene->materials[0].base_color_texture, 0U);
  EXPECT_EQ(scene->materials[0].uv_sets_used, 1U);
  ASSERT_EQ(scene->blobs.size(), 1U);
  EXPECT_EQ(scene->blobs[0].name, "my tex.png");
  const auto references = scene::list_references(folder_.path() / "a.ply");
  ASSERT_TRUE(references);
  ASSERT_EQ(references->size(), 1U);
  EXPECT_EQ((*references)[0].path, folder_.path() / "my tex.png");
  EXPECT_EQ((*references)[0].kind, scene::FileReference::Kind::kImage);
}

TEST_F(PlyAsWritten, ATextureThatIsMissingOrOutsideIsNamed) {
  const std::string bytes =
      header("", kUv, "comment TextureFile ../gone.png\n", 1) + kVertices + "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n";
  EXPECT_FALSE(read("a.ply", bytes));
  const auto scene = read("a.ply", bytes, {.may_lack_images = true});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(all_left_out(*scene),
            "TextureFile ../gone.png: it cannot be opened: a path that leaves the scene's folder, into none of "
            "--allow-outside; ");
  EXPECT_EQ(primitive(scene).uvs[0].size(), 4U);
}

TEST_F(PlyAsWritten, FacesNameTheirTextureByNumber) {
  for (const char* name : {"a.png", "b.png"}) folder_.write(name, kPng + name);
  const auto scene =
      read("a.ply",
           header("", kUv + "property int texnumber\n", "comment TextureFile a.png\ncomment TextureFile b.png\n", 4) +
               kVertices + "3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 6 0 0 1 1 0 1 0\n3 0 1 3 0 -1\n3 1 2 3 6 0 0 0 0 0 0 7\n");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->materials.size(), 3U);
  const auto& parts = scene->meshes[0].primitives;
  ASSERT_EQ(parts.size(), 4U);  // a, b, none with and none without texture coordinates
  EXPECT_EQ(parts[0].material, MaterialId(0U));
  EXPECT_EQ(parts[0].positions[parts[0].indices[2]], Vec3d(0, 1, 0));
  EXPECT_EQ(parts[1].material, MaterialId(1U));
  EXPECT_EQ(parts[2].material, MaterialId(2U));
  EXPECT_TRUE(parts[3].uvs[0].empty());
  EXPECT_EQ(all_left_out(*scene), "face property texnumber: 1 face without such a texture; ");
}

TEST_F(PlyAsWritten, TextureCoordinatesOfVerticesHaveTheTextureToo) {
  folder_.write("a.png", kPng);
  for (const auto& [u, v] : {std::pair("s", "t"), {"u", "v"}, {"texture_u", "texture_v"}}) {
    const auto scene = read("a.ply", header("property float " + std::string(u) + "\nproperty float " + v + "\n", "",
                                            "comment TextureFile a.png\n", 1) +
                                         "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 0.75\n4 0 1 2 3\n");
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(primitive(scene).uvs[0][3], Vec2f(0, 0.25F));
    EXPECT_EQ(scene->materials[0].base_color_texture, 0U);
  }
  const auto bare = read("a.ply", header("", "", "comment TextureFile a.png\n", 1) + kVertices + "4 0 1 2 3\n");
  ASSERT_TRUE(bare) << describe(bare);
  EXPECT_EQ(all_left_out(*bare), "TextureFile a.png: the file has no texture coordinates; ");
}

TEST_F(PlyAsWritten, ColoursOfFacesAreFlat) {
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const auto scene = read("a.ply", header("", colors) + kVertices + "3 0 1 2 255 0 0\n3 0 2 3 0 188 0\n");
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  ASSERT_EQ(p.positions.size(), 6U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(p.colors[p.indices[c]], Vec4f(1, 0, 0, 1));
    EXPECT_FLOAT_EQ(p.colors[p.indices[3 + c]].y, 0.50288648F);
  }
  EXPECT_EQ(all_left_out(*scene), "");
  const auto alpha = read("a.ply", header("", "property uchar alpha\n" + colors) + kVertices +
                                       "3 0 1 2 128 255 0 0\n"
                                       "3 0 2 3 128 255 0 0\n");
  ASSERT_TRUE(alpha) << describe(alpha);
  EXPECT_EQ(primitive(alpha).positions.size(), 4U);  // where facets agree they share
  EXPECT_FLOAT_EQ(primitive(alpha).colors[0].w, 128.0F / 255.0F);
  const auto both = read("a.ply", header(colors, colors) +
                                      "0 0 0 0 0 255\n1 0 0 0 0 255\n1 1 0 0 0 255\n0 1 0 0 0 255\n"
                                      "3 0 1 2 255 0 0\n3 0 2 3 0 188 0\n");
  ASSERT_TRUE(both) << describe(both);
  EXPECT_EQ(primitive(both).colors[0], Vec4f(0, 0, 1, 1));
  EXPECT_EQ(all_left_out(*both), "face properties red, green and blue: 2 faces; the vertices have colours too; ");
}

/// IEC 61966-2-1 at a few levels, to the last digit of a float.
TEST_F(PlyAsWritten, LevelsAreOfSrgbAndFloatsAreLinear) {
  const auto color_of = [&](const std::string& type, const std::string& value, bool is_linear = false) {
    const std::string t = "property " + type + " ";
    const std::string row = " " + value + "\n";
    const auto scene = read("a.ply",
                            header(t + "red\n" + t + "green\n" + t + "blue\n", "", "", 1) + "0 0 0" + row + "1 0 0" +
                                row + "1 1 0" + row + "0 1 0" + row + "4 0 1 2 3\n",
                            {.linear_colors = is_linear});
    return primitive(scene).colors[0];
  };
  EXPECT_EQ(color_of("uchar", "188 100 50"), Vec4f(0.50288646F, 0.12743768F, 0.031896032F, 1));
  EXPECT_EQ(color_of("uchar", "0 10 255"), Vec4f(0, 0.00303527F, 1, 1));
  EXPECT_EQ(color_of("int", "188 100 50"), color_of("uchar", "188 100 50"));
  EXPECT_EQ(color_of("ushort", "65535 0 48316"), Vec4f(1, 0, 0.50288646F, 1));
  EXPECT_EQ(color_of("uchar", "188 100 50", true), Vec4f(188 / 255.0F, 100 / 255.0F, 50 / 255.0F, 1));
  EXPECT_EQ(color_of("float", "0.8 0.2 0"), Vec4f(204 / 255.0F, 51 / 255.0F, 0, 1));
}

TEST_F(PlyAsWritten, WhatIsNotReadIsNamedOnceWithACount) {
  const auto scene = read(
      "a.ply",
      "ply\nformat ascii 1.0\nobj_info made\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float quality\nproperty list uchar int ring\nproperty float nx\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty uchar flags\nproperty uchar red\nelement edge 2\n"
      "property int a\nend_header\n0 0 0 1 0 0\n1 0 0 1 0 0\n1 1 0 1 2 1 1 0\n0 1 0 1 0 0\n4 0 1 2 3 7 255\n1\n2\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(area(*scene), 1.0);
  EXPECT_EQ(
      all_left_out(*scene),
      "vertex property quality: it is not one that is kept: 4 vertices; vertex property ring: it is not one that is "
      "kept: 4 vertices; vertex property nx: it is not one that is kept: 4 vertices; face property flags: it is not "
      "one that is kept: 1 face; face property red: it is not one that is kept: 1 face; element edge: 2 of it; only "
      "vertices and faces are read; header keyword obj_info: 1 line; ");
}

TEST_F(PlyAsWritten, WhatFollowsTheLastElementIsNamed) {
  const auto scene = read("a.ply", header("", "", "", 1) + kVertices + "4 0 1 2 3\n1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(all_left_out(*scene), "5 bytes: they follow the last element; ");
}

/// Old VCGLIB wrote lists that its header does not have.
TEST_F(PlyAsWritten, RowsWithMoreThanTheHeaderSaysAreReadLineByLine) {
  const auto scene = read("a.ply", header("", "") + kVertices + "3 0 1 2 3 9 9 9\n3 0 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(area(*scene), 1.0);
  EXPECT_EQ(all_left_out(*scene), "4 numbers: rows have more than the header says, at their ends; ");
  // A row over two lines: lines say nothing then.
  const auto broken = read("a.ply", header("", "") + "0 0 0 1 0 0 1 1 0 0 1 0\n3 0 1\n2 3 0 2 3\n");
  ASSERT_TRUE(broken) << describe(broken);
  EXPECT_EQ(area(*broken), 1.0);
}

TEST_F(PlyAsWritten, StripsAreTriangles) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n5 5 5\n";
  const auto scene = read("a.ply", head + "9 0 1 2 3 -1 2 1 3 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(primitive(scene).indices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 1, 3}));
  EXPECT_EQ(scene->triangles_in_file, 0U);  // strips are not counted
  EXPECT_EQ(all_left_out(*scene), "");
  EXPECT_FALSE(read("a.ply", head + "3 0 1 9\n"));
  EXPECT_FALSE(read("a.ply", head + "3 0 1 -2\n"));
  EXPECT_FALSE(read("a.ply", head + "4 0 1 2\n"));
}

TEST_F(PlyAsWritten, ListsOfTheWrongLengthAreNamedOrRefused) {
  const auto scene = read("a.ply", header("", kUv) + kVertices + "3 0 1 2 5 0 0 1 0 1\n3 0 2 3 0\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_TRUE(primitive(scene).uvs[0].empty());
  EXPECT_EQ(all_left_out(*scene), "texture coordinates (texcoord): 1 face with another number than two a corner; ");
  EXPECT_FALSE(read("a.ply", header("", kUv) + kVertices + "3 0 1 2 4000000000 0 0 1 0 1\n3 0 2 3 0\n"));
  EXPECT_FALSE(read("a.ply", header("", kUv) + kVertices + "3 0 1 2 -1\n3 0 2 3 0\n"));
  EXPECT_FALSE(read("a.ply", header("", kUv) + kVertices + "3 0 1 2 6 0 0 x 0 1 1\n3 0 2 3 0\n"));
}

TEST_F(PlyAsWritten, StripsBesideAnElementOfNoFacesHaveNoTextureNumbers) {
  folder_.write("a.png", kPng);
  const auto scene = read("a.ply",
                          "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\n"
                          "property float y\nproperty float z\nproperty float u\nproperty float v\nelement face 0\n"
                          "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                          "property int texnumber\nelement tristrips 1\nproperty list int int vertex_indices\n"
                          "end_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n1 1 0 1 1\n4 0 1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(triangle_count(*scene), 2U);
  EXPECT_EQ(primitive(scene).material.value, 0U);
  EXPECT_EQ(scene->materials.at(0).base_color_texture, 0U);
  EXPECT_EQ(all_left_out(*scene), "");
}

TEST_F(PlyAsWritten, ColoursOfEightBitsEndAt255) {
  const std::string color = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const auto scene =
      read("a.ply", header(color, "", "", 1) + "0 0 0 255 0 0\n1 0 0 0 0 0\n1 1 0 256 0 0\n0 1 0 0 0 0\n4 0 1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(primitive(scene).colors[0], Vec4f(1, 0, 0, 1));
  EXPECT_EQ(primitive(scene).colors[2], Vec4f(1, 0, 0, 1));
  EXPECT_EQ(all_left_out(*scene), "colours: 1 outside of what their type covers are clamped; ");
}

TEST_F(PlyAsWritten, AnElementWithoutPropertiesIsNamed) {
  for (const char* count : {"2", "2000000000"}) {
    const auto scene =
        read("a.ply", header("", "", "element material " + std::string(count) + "\n", 1) + kVertices + "4 0 1 2 3 9\n");
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(area(*scene), 1.0);
    EXPECT_EQ(all_left_out(*scene), "element material: " + std::string(count) +
                                        " of it; only vertices and faces are read; 1 number: rows have more than the "
                                        "header says, at their ends; ");
  }
}

TEST_F(PlyAsWritten, AVertexThatNoFaceNamesDecidesNothing) {
  const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
  const auto scene = read(
      "a.ply", header(normals, "", "", 1) + "0 0 0 0 .6 .8\n1 0 0 0 .6 .8\n0 1 0 0 .6 .8\nnan 9 9 0 0 0\n3 0 1 2\n");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(primitive(scene).normals.size(), 3U);
  EXPECT_EQ(primitive(scene).normals[2], Vec3f(0, 0.6F, 0.8F));
  EXPECT_EQ(all_left_out(*scene),
            "1 vertex: no face names them, and their positions are not finite or beyond what a float can hold; ");
}

}  // namespace
}  // namespace meshlode::testing
