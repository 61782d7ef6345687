// SPDX-License-Identifier: GPL-3.0-or-later
// Which files a scene names, and what becomes of it where one of them is not there.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gltf_builder.h"

namespace meshlode::testing {
namespace {

using scene::FileReference;

/// One triangle in b.bin, with a material whose base colour is the first of these images.
std::filesystem::path write_scene(const TempFolder& folder, const std::string& images) {
  GltfBuilder b;
  const int positions = b.floats(kSquare, "VEC3", 3);
  const std::string text =
      b.json("\"images\":[" + images +
                 "],\"textures\":[{\"source\":0}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{"
                 "\"index\":0}}"
                 "}],\"meshes\":[{\"primitives\":[{\"material\":0,\"attributes\":{\"POSITION\":" +
                 std::to_string(positions) + "}}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]",
             ",\"uri\":\"b.bin\"");
  folder.write("b.bin", std::string(b.bin.begin(), b.bin.end()));
  return folder.write("scene.gltf", text);
}

TEST(ImportReferences, EveryFileIsListedOnceWhetherOrNotItIsThere) {
  const TempFolder folder;
  folder.write("tex/a b.png", "a picture");
  const auto path = write_scene(folder,
                                "{\"uri\":\"tex/a%20b.png\"},{\"uri\":\"tex/../tex/a%20b.png\"},{\"uri\":\"gone.png\"},"
                                "{\"uri\":\"data:image/png;base64,AAAA\"}");
  const auto references = scene::list_references(path);
  ASSERT_TRUE(references) << references.error().message();
  ASSERT_EQ(references->size(), 3U);
  EXPECT_EQ((*references)[0].kind, FileReference::Kind::kBuffer);
  EXPECT_EQ((*references)[0].path, folder.path() / "b.bin");
  EXPECT_EQ((*references)[1].kind, FileReference::Kind::kImage);
  EXPECT_EQ((*references)[1].uri, "tex/a%20b.png");
  EXPECT_EQ((*references)[1].path, folder.path() / "tex/a b.png");
  EXPECT_EQ((*references)[2].path, folder.path() / "gone.png");
}

/// The list is what a cache trusts: nothing may be read that is not on it.
TEST(ImportReferences, TheListHoldsAllThatImportOpens) {
  const TempFolder folder;
  folder.write("a.png", "a picture");
  const auto path = write_scene(folder, "{\"uri\":\"a.png\"}");
  std::vector<FileId> opened;
  ASSERT_TRUE(scene::import_scene(path, {.files_read = &opened, .may_lack_images = true}));
  const auto references = scene::list_references(path);
  ASSERT_TRUE(references);
  std::set<FileId> listed{find_file_id(path).value()};
  for (const FileReference& reference : *references) listed.insert(find_file_id(reference.path).value());
  EXPECT_EQ(std::set<FileId>(opened.begin(), opened.end()), listed);
  EXPECT_EQ(opened.size(), 3U);
}

/// Geometry does not need an image, wherever it is. It is on the list without a path: nothing is opened for it, and a
/// cache knows that it is missing.
TEST(ImportReferences, AnImageOutsideIsLeftOutAsAMissingOneIsAndListedWithoutAPath) {
  const TempFolder folder;
  for (const char* uri : {"../a.png", "/etc/passwd", "http://example.org/a.png", "", "file:///etc/passwd",
                          "C:\\\\a.png", "..\\\\a.png", "a%00.png"}) {
    const auto path = write_scene(folder, "{\"uri\":\"" + std::string(uri) + "\"}");
    EXPECT_FALSE(scene::import_scene(path, {})) << uri;
    std::vector<FileId> opened;
    const auto scene = scene::import_scene(path, {.files_read = &opened, .may_lack_images = true});
    ASSERT_TRUE(scene) << uri << ": " << scene.error().message();
    EXPECT_EQ(opened.size(), 2U) << uri;
    ASSERT_EQ(scene->left_out.size(), 1U + 1U) << uri;  // the square's fourth corner makes no triangle
    EXPECT_EQ(scene->left_out[1].what, "image 0");
    EXPECT_NE(scene->left_out[1].why.find("cannot be opened"), std::string::npos) << scene->left_out[1].why;
    const auto references = scene::list_references(path);
    ASSERT_TRUE(references) << uri;
    ASSERT_EQ(references->size(), 2U) << uri;
    EXPECT_TRUE((*references)[1].path.empty() || !find_file_id((*references)[1].path)) << uri;
  }
}

TEST(ImportReferences, ABufferOutsideIsRefusedAsImportDoes) {
  const TempFolder folder;
  for (const char* uri : {"../a.bin", "/etc/passwd", "%zz", "http://example.org/a.bin", ""}) {
    const auto path = folder.write("scene.gltf",
                                   "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,"
                                   "\"uri\":\"" +
                                       std::string(uri) + "\"}]}");
    const auto scene = scene::import_scene(path, {.may_lack_images = true});
    ASSERT_FALSE(scene) << uri;
    EXPECT_NE(scene.error().where.find("/buffers/0/uri"), std::string::npos) << scene.error().message();
    const auto references = scene::list_references(path);
    if (references) continue;  // one that may come to be there
    EXPECT_EQ(references.error().message(), scene.error().message());
    EXPECT_EQ(references.error().code, scene.error().code);
  }
}

TEST(ImportReferences, NoBytesMakeItDoMoreThanRefuse) {
  const TempFolder folder;
  for (const char* text : {"", "{", "[]", "{\"buffers\":3,\"images\":[1,null,{\"uri\":[]},{}]}", "glTF\2"}) {
    const auto references = scene::list_references(folder.write("scene.gltf", text));
    EXPECT_TRUE(!references || references->empty()) << text;
  }
  EXPECT_FALSE(scene::list_references(folder.path() / "none.gltf"));
  const auto outside = scene::list_references(folder.write("a.obj", "mtllib\nmtllib ../a.mtl\n"));
  ASSERT_TRUE(outside);
  for (const FileReference& reference : *outside) EXPECT_TRUE(reference.path.empty()) << reference.path;
}

/// As for glTF: nothing is opened that is not listed, and what may come to be there is listed too.
TEST(ImportReferences, TheLibrariesAndTexturesOfAnObjAreListed) {
  const TempFolder folder;
  folder.write("my set.mtl", "newmtl a\nmap_Kd tex\\a.png\nnewmtl b\nmap_Kd gone.png\n");
  folder.write("tex/a.png", "a picture");
  const auto path = folder.write("a.obj",
                                 "mtllib my set.mtl\nmtllib x.mtl \\\n y.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                 "usemtl a\nf 1 2 3\n");
  const auto references = scene::list_references(path);
  ASSERT_TRUE(references) << references.error().message();
  std::vector<std::string> listed;
  for (const FileReference& reference : *references) {
    listed.push_back(reference.path.lexically_relative(folder.path()).string());
  }
  EXPECT_EQ(listed,
            (std::vector<std::string>{"my set.mtl", "tex/a.png", "gone.png", "x.mtl   y.mtl", "x.mtl", "y.mtl"}));
  EXPECT_EQ(references->front().kind, FileReference::Kind::kMaterials);
  EXPECT_EQ((*references)[1].kind, FileReference::Kind::kImage);
  std::vector<FileId> opened;
  ASSERT_TRUE(scene::import_scene(path, {.files_read = &opened, .may_lack_images = true}));
  EXPECT_EQ(opened.size(), 3U);
  std::set<FileId> known{find_file_id(path).value()};
  for (const FileReference& reference : *references) {
    if (const auto id = find_file_id(reference.path)) known.insert(*id);
  }
  for (const FileId& id : opened) EXPECT_TRUE(known.contains(id));
}

TEST(ImportReferences, AMissingImageIsLeftOutAndNamedWhereThatIsAllowed) {
  const TempFolder folder;
  folder.write("b.png", "another picture");
  const auto path = write_scene(folder, "{\"uri\":\"gone.png\"},{\"uri\":\"b.png\"}");
  const auto strict = scene::import_scene(path, {});
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().code, ErrorCode::kIo);
  const auto scene = scene::import_scene(path, {.may_lack_images = true});
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_FALSE(scene->left_out.empty());
  EXPECT_EQ(scene->left_out.back().what, "image 0");
  EXPECT_EQ(scene->left_out.back().why,
            "its file \"gone.png\" cannot be opened: there is no such file, or it cannot be read");
  ASSERT_EQ(scene->blobs.size(), 1U);
  EXPECT_EQ(scene->blobs[0].name, "b.png");
  ASSERT_EQ(scene->materials.at(0).textures.size(), 1U);
  EXPECT_EQ(scene->materials[0].textures[0].image, 0U);
  EXPECT_EQ(scene->materials[0].textures[0].blob, kNoId);
  EXPECT_FALSE(nlohmann::json::parse(scene->document)["images"][0].contains("blob"));
}

TEST(ImportReferences, AMissingBufferIsAnErrorAlways) {
  const TempFolder folder;
  const auto path = write_scene(folder, "{\"uri\":\"gone.png\"}");
  std::filesystem::remove(folder.path() / "b.bin");
  const auto scene = scene::import_scene(path, {.may_lack_images = true});
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::kIo);
  EXPECT_NE(scene.error().where.find("/buffers/0/uri"), std::string::npos) << describe(scene);
}

}  // namespace
}  // namespace meshlode::testing
