// SPDX-License-Identifier: GPL-3.0-or-later
// Names of files that are no plain names below the scene's folder: percent signs, other folders, links.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/utf8.h"
#include "gltf_builder.h"
#include "scene/import/gltf/uri.h"

namespace meshlode::testing {
namespace {

namespace fs = std::filesystem;

/// A scene of a triangle in "models", with one image.
class ImportOutside : public ::testing::Test {
 protected:
  fs::path write_scene(const std::string& uri, const std::string& buffer = "b.bin") {
    GltfBuilder b;
    b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
    folder.write("models/" + (buffer.find('%') == std::string::npos ? "b.bin" : buffer),
                 std::string(b.bin.begin(), b.bin.end()));
    return folder.write(
        "models/scene.gltf",
        b.json(mesh_text("\"POSITION\":0") + ",\"images\":[{\"uri\":\"" + uri + "\"}]", ",\"uri\":\"" + buffer + "\""));
  }

  /// The image's bytes as a text; "-" where it is left out, "refused" where the scene is.
  std::string image_of(const std::string& uri, const std::vector<fs::path>& allowed = {}) {
    const fs::path path = write_scene(uri);
    std::vector<FileId> opened;
    const auto scene =
        scene::import_scene(path, {.files_read = &opened, .may_lack_images = true, .allow_outside = allowed});
    if (!scene) return "refused: " + scene.error().message();
    const auto references = scene::list_references(path, allowed);
    if (!references) return "not listed: " + references.error().message();
    // What is opened is listed, with the path that opens it.
    for (const FileId& id : opened) {
      bool is_listed = find_file_id(path).value() == id;
      for (const scene::FileReference& reference : *references) {
        const auto known = find_file_id(reference.path);
        is_listed = is_listed || (known && *known == id);
      }
      if (!is_listed) return "opened, but not listed";
    }
    hash = scene->source_hash;
    if (scene->blobs.empty()) {
      EXPECT_EQ(scene->left_out.size(), 1U) << uri;
      return "-";
    }
    return std::string(scene->blobs[0].bytes.begin(), scene->blobs[0].bytes.end());
  }

  TempFolder folder;
  std::string hash;
};

TEST_F(ImportOutside, APercentSignThatIsNoEscapeMeansItself) {
  folder.write("models/100%wood.png", "wood");
  folder.write("models/ball%ball.png", "ball");
  folder.write("models/a b.png", "blank");
  folder.write("models/c%20d.png", "letters");
  EXPECT_EQ(image_of("100%wood.png"), "wood");
  EXPECT_EQ(image_of("100%25wood.png"), "wood");
  EXPECT_EQ(image_of("ball%ball.png"), "ball");
  EXPECT_EQ(image_of("a%20b.png"), "blank");
  EXPECT_EQ(image_of("c%20d.png"), "letters");
  folder.write("models/c d.png", "decoded");
  EXPECT_EQ(image_of("c%20d.png"), "decoded");  // what the specification means comes first
  EXPECT_EQ(image_of("99%wood.png"), "-");
}

TEST_F(ImportOutside, BackslashesSeparateFoldersWhereNoFileIsCalledSo) {
  folder.write("models/tex/a.png", "in a folder");
  EXPECT_EQ(image_of("tex\\\\a.png"), "in a folder");
  folder.write("models/tex\\a.png", "so called");
  EXPECT_EQ(image_of("tex\\\\a.png"), "so called");
}

TEST_F(ImportOutside, BuffersMayBeCalledSoTooAndMessagesAreText) {
  const auto scene = scene::import_scene(write_scene("a.png", "ball%ball.bin"), {.may_lack_images = true});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->meshes.at(0).primitives.at(0).positions.size(), 3U);
  fs::remove(folder.path() / "models/ball%ball.bin");
  const auto missing = scene::import_scene(folder.path() / "models/scene.gltf", {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  const std::string message = missing.error().message();
  EXPECT_EQ(as_utf8(message), message);
}

TEST_F(ImportOutside, AFolderThatIsAllowedIsReadHoweverItIsNamed) {
  folder.write("textures/wood.png", "wood");
  folder.write("other/oak.png", "oak");
  const fs::path textures = folder.path() / "textures";
  const std::string absolute = (textures / "wood.png").string();
  for (const std::string& uri :
       {std::string("../textures/wood.png"), std::string("..\\\\textures\\\\wood.png"),
        std::string("%2e%2e/textures/wood.png"), absolute, "file://" + absolute, "file://localhost" + absolute}) {
    EXPECT_EQ(image_of(uri), "-") << uri;
    const std::string without = hash;
    EXPECT_EQ(image_of(uri, {textures}), "wood") << uri;
    EXPECT_NE(hash, without) << uri;  // the image is part of what the asset is made from
    EXPECT_EQ(image_of(uri, {folder.path() / "models/../textures"}), "wood") << uri;
    EXPECT_EQ(image_of(uri, {folder.path() / "other", textures}), "wood") << uri;
    EXPECT_EQ(image_of(uri, {folder.path() / "other"}), "-") << uri;
    EXPECT_EQ(image_of(uri, {folder.path() / "nowhere"}), "-") << uri;
  }
  EXPECT_EQ(image_of("../textures/gone.png", {textures}), "-");
  EXPECT_EQ(image_of("../textures/../other/oak.png", {textures}), "-");
  EXPECT_EQ(image_of("../textures", {textures}), "-");
  EXPECT_EQ(image_of("http://example.org/wood.png", {textures}), "-");
}

TEST_F(ImportOutside, LinksLeadWhereAFolderIsAllowedAndNowhereElse) {
  folder.write("textures/wood.png", "wood");
  folder.write("other/oak.png", "oak");
  const fs::path textures = folder.path() / "textures";
  fs::create_directories(folder.path() / "models");
  fs::create_symlink(textures / "wood.png", folder.path() / "models/in.png");
  fs::create_symlink(folder.path() / "other/oak.png", textures / "out.png");
  fs::create_directory_symlink(textures, folder.path() / "by name");
  EXPECT_EQ(image_of("in.png"), "-");
  EXPECT_EQ(image_of("in.png", {textures}), "wood");
  EXPECT_EQ(image_of("../textures/out.png", {textures}), "-");
  EXPECT_EQ(image_of("../textures/out.png", {textures, folder.path() / "other"}), "oak");
  EXPECT_EQ(image_of("../by%20name/wood.png", {folder.path() / "by name"}), "wood");
  EXPECT_EQ(image_of("../by%20name/wood.png", {folder.path() / "by name/"}), "wood");
  EXPECT_EQ(image_of("../by%20name/wood.png", {folder.path() / "by name/."}), "wood");
  EXPECT_EQ(image_of("../by%20name/wood.png", {textures}), "-");  // by its letters it lies elsewhere
}

TEST_F(ImportOutside, ABufferAndAnObjsTexturesFollowTheSameRule) {
  fs::path path = write_scene("a.png", "b.bin");
  fs::create_directories(folder.path() / "data");
  fs::rename(folder.path() / "models/b.bin", folder.path() / "data/c.bin");
  GltfBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  path = folder.write("models/scene.gltf", b.json(mesh_text("\"POSITION\":0"), ",\"uri\":\"../data/c.bin\""));
  const auto refused = scene::import_scene(path, {.may_lack_images = true});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalid);
  EXPECT_FALSE(scene::list_references(path));
  const std::vector<fs::path> allowed{folder.path() / "data"};
  EXPECT_TRUE(scene::import_scene(path, {.allow_outside = allowed}));
  EXPECT_EQ(scene::list_references(path, allowed).value().size(), 1U);

  folder.write("data/a.mtl", "newmtl a\nmap_Kd wood.png\n");
  folder.write("models/wood.png", "wood");
  path = folder.write("models/a.obj", "mtllib ../data/a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  EXPECT_TRUE(scene::import_scene(path, {.may_lack_images = true}).value().blobs.empty());
  EXPECT_EQ(scene::import_scene(path, {.may_lack_images = true, .allow_outside = allowed}).value().blobs.size(), 1U);
  EXPECT_EQ(scene::list_references(path, allowed).value().size(), 2U);
}

TEST_F(ImportOutside, WhatCannotBeDecodedIsLeftOutToo) {
  for (const char* uri : {"data:image/png;base64,*", "data:image/png"}) {
    EXPECT_EQ(image_of(uri), "-") << uri;
    EXPECT_FALSE(scene::import_scene(folder.path() / "models/scene.gltf", {})) << uri;
  }
}

}  // namespace
}  // namespace meshlode::testing
