// SPDX-License-Identifier: GPL-3.0-or-later
// Real scenes there and back: what import finds in an exported cut is what it found in the source.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "app/export/export.h"
#include "build_scene.h"
#include "scene/import/import.h"

namespace meshlode::app {
namespace {

class ExportModels : public testing::TestWithParam<const char*> {};

std::uint64_t triangles_of_mesh(const scene::SourceMesh& mesh) {
  std::uint64_t triangles = 0;
  for (const scene::Primitive& primitive : mesh.primitives) triangles += primitive.indices.size() / 3;
  return triangles;
}

TEST_P(ExportModels, AnExportedFinestCutImportsAsTheSceneItCameFrom) {
  const char* folder = std::getenv("MESHLODE_MODELS");
  if (folder == nullptr) {
    const char* required = std::getenv("MESHLODE_REQUIRE_MODELS");
    if (required != nullptr && std::string(required) == "1") FAIL() << "MESHLODE_MODELS is not set";
    GTEST_SKIP() << "MESHLODE_MODELS is not set";
  }
  const auto source = scene::import_scene(std::filesystem::path(folder) / GetParam(), {});
  ASSERT_TRUE(source.ok()) << source.error().message();
  const auto bytes = test::build_bytes(*source);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  const auto glb = export_glb(*asset, test::finest_cuts(*asset));
  ASSERT_TRUE(glb.ok()) << glb.error().message();
  test::Glb::parse(*glb).expect_sound();

  std::string file_name = GetParam();
  std::replace(file_name.begin(), file_name.end(), '/', '_');
  const auto path = std::filesystem::path(testing::TempDir()) / ("meshlode_export_" + file_name + ".glb");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(glb->data()), static_cast<std::streamsize>(glb->size()));
  const auto again = scene::import_scene(path, {});
  std::filesystem::remove(path);
  ASSERT_TRUE(again.ok()) << again.error().message();

  ASSERT_EQ(again->meshes.size(), source->meshes.size());
  for (std::size_t m = 0; m < source->meshes.size(); ++m) {
    EXPECT_EQ(again->meshes[m].name, source->meshes[m].name);
    const format::MeshRecord& record = asset->meshes()[m];
    EXPECT_EQ(triangles_of_mesh(again->meshes[m]) + record.dropped_degenerate + record.dropped_duplicate,
              triangles_of_mesh(source->meshes[m]));
  }
  ASSERT_EQ(again->instances.size(), source->instances.size());
  for (std::size_t i = 0; i < source->instances.size(); ++i) {
    const scene::SceneInstance& a = again->instances[i];
    const scene::SceneInstance& s = source->instances[i];
    EXPECT_EQ(a.name, s.name);
    EXPECT_EQ(a.mesh, s.mesh);
    EXPECT_TRUE(a.transform == s.transform) << "instance " << i;
  }
  ASSERT_EQ(again->materials.size(), source->materials.size());
  for (std::size_t m = 0; m < source->materials.size(); ++m) {
    EXPECT_EQ(again->materials[m].name, source->materials[m].name);
    EXPECT_EQ(again->materials[m].alpha_mode, source->materials[m].alpha_mode);
    EXPECT_EQ(again->materials[m].base_color_texture, source->materials[m].base_color_texture);
    EXPECT_EQ(again->materials[m].uv_sets_used, source->materials[m].uv_sets_used);
  }
  ASSERT_EQ(again->blobs.size(), source->blobs.size());
  for (std::size_t b = 0; b < source->blobs.size(); ++b) {
    EXPECT_EQ(again->blobs[b].kind, source->blobs[b].kind);
    EXPECT_TRUE(again->blobs[b].bytes == source->blobs[b].bytes) << "blob " << b;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ExportModels,
                         testing::Values("bunny-three-materials.glb", "FlightHelmet/FlightHelmet.gltf",
                                         "MixedLightingExample/MixedLightingExample.gltf",
                                         "khronos/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
                                         "draco/SpheresScaledInstances/glTF/spheres_scaled_instances.gltf",
                                         "khronos/TextureTransformTest/glTF/TextureTransformTest.gltf"));

}  // namespace
}  // namespace meshlode::app
