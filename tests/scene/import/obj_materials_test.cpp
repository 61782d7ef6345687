// SPDX-License-Identifier: GPL-3.0-or-later
// usemtl and mtllib: colours, textures and opacity as a glTF would have them; what is missing is said, and nothing is
// opened outside the scene's folder.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/import/json.h"
#include "scene/import/polygons/mtl_material.h"
#include "scene/import/polygons/read_mtl.h"

namespace meshlode::testing {
namespace {

/// Four corners with UVs, and faces.
std::string obj(const std::string& faces, const std::string& head = "mtllib a.mtl\n") {
  return head + "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 0.25\nvt 0 1\n" + faces;
}

const std::string kRed = "usemtl red\nf 1/1 2/2 3/3\n", kGlass = "usemtl old glass\nf 1/1 3/3 4/4\n";
const std::string kMtl =
    "# made by hand\nnewmtl red\nKd 1 0.5 0\nNs 10\n\nnewmtl old glass\nKd 0.25\nd 0.5\nmap_Kd -s 2 2 -clamp on my "
    "tex.png\n";
const std::string kPng = "\x89PNG\r\n";

std::string left_out(const scene::Scene& scene) {
  std::string out;
  for (const scene::LeftOut& item : scene.left_out) out += item.what + "; ";
  return out;
}

TEST(ImportObjMaterials, ColoursTexturesAndOpacityAreTheScenes) {
  const TempFolder folder;
  folder.write("a.mtl", kMtl);
  folder.write("my tex.png", kPng);
  const auto scene = scene::import_scene(folder.write("a.obj", obj(kRed + kGlass)), {});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(left_out(*scene), "MTL option -clamp of map_Kd; MTL option -s of map_Kd; MTL Ns; ");
  ASSERT_EQ(scene->materials.size(), 2U);
  const scene::SceneMaterial &red = scene->materials[0], &glass = scene->materials[1];
  EXPECT_EQ(red.name, "red");
  EXPECT_EQ(red.base_color, Vec4f(1.0F, 0.5F, 0.0F, 1.0F));
  EXPECT_EQ(red.alpha_mode, scene::AlphaMode::kOpaque);
  EXPECT_EQ(red.uv_sets_used, 0U);
  EXPECT_EQ(glass.name, "old glass");
  EXPECT_EQ(glass.base_color, Vec4f(0.25F, 0.25F, 0.25F, 0.5F));
  EXPECT_EQ(glass.alpha_mode, scene::AlphaMode::kBlend);
  EXPECT_EQ(glass.base_color_texture, 0U);
  ASSERT_EQ(glass.textures.size(), 1U);
  EXPECT_EQ(glass.textures[0].blob, 0U);
  ASSERT_EQ(scene->blobs.size(), 1U);
  EXPECT_EQ(scene->blobs[0].mime_type, "image/png");
  EXPECT_EQ(std::string(scene->blobs[0].bytes.begin(), scene->blobs[0].bytes.end()), kPng);
  ASSERT_EQ(scene->meshes[0].primitives.size(), 2U);
  const scene::Primitive& second = scene->meshes[0].primitives[1];
  EXPECT_EQ(second.material.value, 1U);
  ASSERT_EQ(second.positions.size(), 3U);  // its own vertices, and no other
  EXPECT_EQ(second.positions[second.indices[1]], Vec3d(1, 1, 0));
  EXPECT_EQ(second.uvs[0][second.indices[1]], Vec2f(1.0F, 0.75F));  // glTF's begin above
  const auto document = scene::parse_json(scene->document);
  ASSERT_TRUE(document);
  EXPECT_EQ(scene::dump_json(document->items("materials")[1]),
            "{\"name\":\"old glass\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.25,0.25,0.5],"
            "\"baseColorTexture\":{\"index\":0},\"metallicFactor\":0.0},\"alphaMode\":\"BLEND\"}");
  EXPECT_EQ(scene::dump_json(document->items("images")[0]),
            "{\"name\":\"my tex.png\",\"mimeType\":\"image/png\",\"blob\":0}");
  EXPECT_EQ(scene::dump_json(document->items("textures")[0]), "{\"source\":0}");
}

// As programs write them that know one language: names of an asset are UTF-8.
TEST(ImportObjMaterials, NamesInOtherEncodingsAreReadAndShownAsFarAsTheyCan) {
  const TempFolder folder;
  folder.write("a.mtl", "newmtl gr\xFCn\nKd 0 1 0\nmap_Kd bl\xE4tter.png\n");
  folder.write("bl\xE4tter.png", kPng);
  const auto scene = scene::import_scene(folder.write("b\xE4r.obj", obj("usemtl gr\xFCn\nf 1/1 2/2 3/3\n")), {});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(left_out(*scene), "");
  EXPECT_EQ(scene->meshes[0].name, "b\xEF\xBF\xBDr");
  EXPECT_EQ(scene->instances[0].name, "b\xEF\xBF\xBDr");
  ASSERT_EQ(scene->materials.size(), 1U);
  EXPECT_EQ(scene->materials[0].name, "gr\xEF\xBF\xBDn");
  EXPECT_EQ(scene->materials[0].base_color, Vec4f(0.0F, 1.0F, 0.0F, 1.0F));
  ASSERT_EQ(scene->blobs.size(), 1U);
  EXPECT_EQ(scene->blobs[0].name, "bl\xEF\xBF\xBDtter.png");
  EXPECT_TRUE(scene::parse_json(scene->document));
}

TEST(ImportObjMaterials, WhatIsMissingIsAWarningOrAnError) {
  const TempFolder folder;
  const auto path = folder.write("a.obj", obj(kRed + kGlass));
  const auto strict = [&] { return describe(scene::import_scene(path, {})); };
  const auto bare = scene::import_scene(path, {.may_lack_images = true});
  EXPECT_EQ(strict(),
            path.string() + ": mtllib a.mtl: it cannot be opened: there is no such file, or it cannot be read");
  ASSERT_TRUE(bare) << describe(bare);
  EXPECT_EQ(left_out(*bare), "mtllib a.mtl; material old glass and 1 more; ");
  EXPECT_EQ(bare->materials[0].name, "red");
  EXPECT_EQ(bare->materials[0].base_color, Vec4f(1.0F));
  EXPECT_EQ(bare->meshes[0].primitives.size(), 2U);
  folder.write("a.mtl", kMtl);
  const auto untextured = scene::import_scene(path, {.may_lack_images = true});
  EXPECT_EQ(strict(),
            path.string() + ": map_Kd my tex.png: it cannot be opened: there is no such file, or it cannot be read");
  ASSERT_TRUE(untextured) << describe(untextured);
  EXPECT_EQ(left_out(*untextured), "map_Kd my tex.png; MTL option -clamp of map_Kd; MTL option -s of map_Kd; MTL Ns; ");
  EXPECT_EQ(untextured->materials[1].base_color_texture, kNoId);
  EXPECT_EQ(untextured->meshes[0].primitives[1].uvs[0][1], Vec2f(1.0F, 0.75F));  // with and without the picture
  EXPECT_NE(untextured->source_hash, bare->source_hash);                         // it covers the library
}

TEST(ImportObjMaterials, NothingIsOpenedOutsideTheFolder) {
  const TempFolder folder;
  folder.write("secret.mtl", "newmtl red\nKd 0 0 0\n");
  folder.write("secret.png", kPng);
  folder.write("below/a.mtl", "newmtl red\nmap_Kd ../secret.png\nnewmtl green\nmap_Kd " +
                                  (folder.path() / "secret.png").string() + "\nnewmtl blue\nmap_Kd ..\\secret.png\n");
  std::vector<FileId> files_read;
  const std::string faces = kRed + "usemtl green\nf 1/1 2/2 3/3\nusemtl blue\nf 1/1 2/2 3/3\n";
  const auto scene = scene::import_scene(
      folder.write("below/a.obj", obj(faces, "mtllib ../secret.mtl\nmtllib a.mtl " + folder.path().string() + "\n")),
      {.files_read = &files_read, .may_lack_images = true});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(files_read.size(), 2U);  // a.obj and a.mtl
  EXPECT_TRUE(scene->blobs.empty());
  EXPECT_EQ(scene->materials[0].base_color, Vec4f(1.0F));
  EXPECT_EQ(scene->left_out.size(), 5U) << left_out(*scene);
}

TEST(ImportObjMaterials, FacesBeforeAnyUsemtlHaveTheDefaultMaterial) {
  const TempFolder folder;
  const auto scene = scene::import_scene(folder.write("a.obj", obj("f 1 2 3\n" + kRed + "usemtl red\n", "")), {});
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->materials.size(), 2U);
  EXPECT_EQ(scene->materials[0].name, "red");
  EXPECT_EQ(scene->materials[1].source_index, kNoId);
  ASSERT_EQ(scene->meshes[0].primitives.size(), 2U);
  EXPECT_EQ(scene->meshes[0].primitives[0].material.value, 0U);
  EXPECT_EQ(scene->meshes[0].primitives[1].material.value, 1U);
  // No material at all: as ever.
  const auto plain = scene::import_scene(folder.write("b.obj", obj("f 1 2 3\n", "")), {});
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->document, "{}");
  EXPECT_EQ(plain->materials.size(), 1U);
}

TEST(ImportObjMaterials, OneImageOfManyMaterialsIsThereOnce) {
  const TempFolder folder;
  std::string mtl, faces;
  for (int i = 0; i < 50; ++i) {
    const std::string name = "m" + std::to_string(i);
    mtl += "newmtl " + name + "\nmap_Kd " + (i % 2 == 0 ? "" : "./") + "tex.png\n";
    faces += "usemtl " + name + "\nf 1/1 2/2 3/3\n";
  }
  folder.write("a.mtl", mtl);
  folder.write("tex.png", kPng);
  const auto scene = scene::import_scene(folder.write("a.obj", obj(faces)), {});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->materials.size(), 50U);
  EXPECT_EQ(scene->blobs.size(), 1U);
}

TEST(ImportObjMaterials, TooManyMaterialsAreRefused) {
  std::string faces;
  for (int i = 0; i <= 65536; ++i) faces += "usemtl " + std::to_string(i) + "\n";
  const TempFolder folder;
  const auto scene = scene::import_scene(folder.write("a.obj", obj(faces)), {});
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::kUnsupported);
}

TEST(ReadMtl, WhatMakesNoSenseIsPassedOver) {
  const std::string text =
      "Kd 1 1 1\nmap_Kd lost.png\nnewmtl a\nKd nan 0 0\nKd 1 x 0\nKd spectral a.rfl\nd -halo 0.5\nTr 0.25\nKd 2 -1 "
      "0.5\n"
      "map_Kd -o 0.1 0.2 0.3 -mm 0 1 -bm 1e99 dir/b c.png \t\r\nnewmtl\nnewmtl b\nmap_Kd\nmap_Kd -s\nTr inf\n";
  const auto read = scene::read_mtl({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const auto& materials = read.materials;
  ASSERT_EQ(materials.size(), 3U);
  EXPECT_EQ(materials[0].name, "a");
  EXPECT_EQ(materials[0].diffuse, (std::array{1.0, 0.0, 0.5}));
  EXPECT_EQ(scene::opacity_of(materials[0]), 0.75);
  EXPECT_EQ(materials[0].base_color.file, "dir/b c.png");
  EXPECT_EQ(materials[2].base_color.file, "");
  EXPECT_EQ(scene::opacity_of(materials[2]), 1.0);
  const std::map<std::string, std::uint64_t, std::less<>> skipped{{"Kd before any newmtl", 1},
                                                                  {"map_Kd before any newmtl", 1},
                                                                  {"Kd without a value that makes sense", 3},
                                                                  {"d without a value that makes sense", 1},
                                                                  {"option -o of map_Kd", 1},
                                                                  {"option -mm of map_Kd", 1},
                                                                  {"option -bm of map_Kd", 1},
                                                                  {"map_Kd without a value that makes sense", 2},
                                                                  {"option -s of map_Kd", 1},
                                                                  {"Tr without a value that makes sense", 1}};
  EXPECT_EQ(read.skipped.counts(), skipped);
}

TEST(ImportObjMaterials, LibrariesMayBeQuotedAndCountInTheirOrder) {
  const TempFolder folder;
  folder.write("m m.mtl", "newmtl red\nKd 0 0 1\n");
  folder.write("a.mtl", "newmtl red\nKd 1 0 0\n");
  const std::string text = obj(kRed, "mtllib \"m m.mtl\"\nmtllib \"m m.mtl\" a.mtl\nmtllib a.mtl\n");
  const auto path = folder.write("a.obj", text);
  const auto scene = scene::import_scene(path, {});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->materials[0].base_color, Vec4f(0, 0, 1, 1));  // the first that has it
  const auto references = scene::list_references(path);
  ASSERT_TRUE(references && !references->empty());
  EXPECT_EQ(references->front().path.filename(), "m m.mtl");
}

TEST(ImportObjMaterials, LibrariesThatAreMissingAreNamedOnceAndTheFirstFew) {
  const TempFolder folder;
  std::string names = "mtllib";
  for (int i = 0; i < 1000; ++i) names += " a " + std::to_string(i);
  const auto scene =
      scene::import_scene(folder.write("a.obj", obj("f 1 2 3\n", names + "\n")), {.may_lack_images = true});
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->left_out.size(), 9U) << left_out(*scene);
  EXPECT_EQ(scene->left_out[0].what, "mtllib a");
  EXPECT_EQ(scene->left_out[8].why, "993 more names: they cannot be opened below the scene's folder");
}

}  // namespace
}  // namespace meshlode::testing
