// SPDX-License-Identifier: GPL-3.0-or-later
// <meshlode/meshlode_build.h>: the same bytes as <meshlode/build.h>, and errors for what C lets a caller pass.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/meshlode_build.h>

#include "arrays.h"

namespace meshlode {
namespace {

using test::Arrays;
using Bytes = std::vector<std::uint8_t>;

/// A sphere as C sees it; the arrays must outlive it.
struct CScene {
  meshlode_primitive_input primitive{};
  meshlode_material_input material{"red", {1.0F, 0.0F, 0.0F, 1.0F}, 1, 0.25F, 1, 1};
  meshlode_instance_input instance{"moved", 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}};
  meshlode_mesh_input mesh{"one", &primitive, 1};
  meshlode_scene_input scene{"arrays", &mesh, 1, &material, 1, &instance, 1};

  explicit CScene(const Arrays& arrays) {
    primitive.positions = arrays.positions.data();
    primitive.normals = arrays.normals.data();
    primitive.vertex_count = arrays.positions.size() / 3;
    primitive.indices = arrays.indices.data();
    primitive.triangle_count = arrays.indices.size() / 3;
  }
  CScene(const CScene&) = delete;
  CScene& operator=(const CScene&) = delete;
};

/// The same scene through C++.
Bytes build_in_cpp(const Arrays& arrays, const BuildOptions& options) {
  PrimitiveInput primitive;
  primitive.positions = arrays.positions;
  primitive.normals = arrays.normals;
  primitive.indices = arrays.indices;
  primitive.material = 0;
  MeshInput mesh{"one", {&primitive, 1}};
  MaterialInput material{"red", {1.0F, 0.0F, 0.0F, 1.0F}, format::AlphaMode::kMask, 0.25F, true, 1};
  InstanceInput instance{"moved", 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}};
  const auto bytes = build_asset({"arrays", {&mesh, 1}, {&material, 1}, {&instance, 1}}, options);
  EXPECT_TRUE(bytes.ok());
  return bytes ? *bytes : Bytes();
}

Bytes build_in_c(const CScene& scene, const meshlode_build_options* options) {
  void* bytes = nullptr;
  std::size_t size = 0;
  meshlode_error error;
  EXPECT_EQ(meshlode_build_to_buffer(&scene.scene, options, &bytes, &size, &error), MESHLODE_OK) << error.text;
  const auto* first = static_cast<const std::uint8_t*>(bytes);
  Bytes out(first, first + size);
  meshlode_build_free(bytes);
  return out;
}

Arrays sphere() {
  return Arrays(lab::with_smooth_normals(lab::make_sphere(24)));
}

TEST(CBuild, TheSameBytesAsInCpp) {
  const Arrays arrays = sphere();
  const CScene scene(arrays);
  EXPECT_EQ(build_in_c(scene, nullptr), build_in_cpp(arrays, {}));

  meshlode_build_options options;
  meshlode_build_defaults(&options);
  EXPECT_EQ(build_in_c(scene, &options), build_in_cpp(arrays, {})) << "the defaults are the defaults";
  options.error_tier = 2;
  options.preset = 2;
  options.attributes = 1;
  options.codec = 0;
  options.strip_effort = 1;
  options.keep_topology = 1;
  options.lock_borders = 1;
  options.keep_layers = 0;
  options.page_size = 16;
  options.page_order = 1;
  options.root_bytes = 20000;
  options.page_hints = 1;
  options.aggregate = 1;
  options.position_error = 0.01;
  options.thread_count = 1;
  BuildOptions same;
  same.error_tier = format::ErrorTier::kCertified;
  same.preset = Preset::kBest;
  same.attributes = AttributeChoice::kNone;
  same.codec = format::Codec::kNone;
  same.strip_effort = StripEffort::kFast;
  same.keep_topology = true;
  same.lock_borders = true;
  same.keep_layers = false;
  same.page_size = 16;
  same.page_order = PageOrder::kCovisible;
  same.root_bytes = 20000;
  same.page_hints = true;
  same.aggregate = AggregateChoice::kAuto;
  same.position_error = 0.01;
  EXPECT_EQ(build_in_c(scene, &options), build_in_cpp(arrays, same));

  meshlode_build_defaults(&options);
  options.promise = 2;
  same = {};
  same.promise = format::Promise::kAppearance;
  EXPECT_EQ(build_in_c(scene, &options), build_in_cpp(arrays, same));
}

TEST(CBuild, AFileHasTheSameBytes) {
  const Arrays arrays = sphere();
  const CScene scene(arrays);
  const std::string path = testing::TempDir() + "c_build_test.lode";
  meshlode_error error;
  ASSERT_EQ(meshlode_build_to_file(&scene.scene, nullptr, path.c_str(), &error), MESHLODE_OK) << error.text;
  EXPECT_STREQ(error.text, "");
  std::ifstream in(path, std::ios::binary);
  const Bytes written{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_EQ(written, build_in_cpp(arrays, {}));
  std::filesystem::remove(path);
}

TEST(CBuild, WhatMakesNoSenseIsAnErrorWithItsPlace) {
  const Arrays arrays = sphere();
  const auto expect = [&](meshlode_status status, const char* place, auto change) {
    CScene scene(arrays);
    meshlode_build_options options;
    meshlode_build_defaults(&options);
    change(scene, options);
    void* bytes = &scene;
    std::size_t size = 77;
    meshlode_error error;
    EXPECT_EQ(meshlode_build_to_buffer(&scene.scene, &options, &bytes, &size, &error), status) << place;
    EXPECT_NE(std::string(error.text).find(place), std::string::npos) << error.text;
    EXPECT_TRUE(bytes == &scene && size == 77) << "outputs stay as they were";
    EXPECT_EQ(meshlode_build_to_buffer(&scene.scene, &options, &bytes, &size, nullptr), status);
  };
  using O = meshlode_build_options;
  expect(MESHLODE_USAGE, "meshes", [](CScene& s, O&) { s.scene.meshes = nullptr; });
  expect(MESHLODE_USAGE, "meshes[0].primitives", [](CScene& s, O&) { s.mesh.primitives = nullptr; });
  expect(MESHLODE_USAGE, "meshes[0].primitives[0].indices", [](CScene& s, O&) { s.primitive.indices = nullptr; });
  expect(MESHLODE_USAGE, "meshes[0].primitives[0].vertex_count",
         [](CScene& s, O&) { s.primitive.vertex_count = SIZE_MAX; });
  expect(MESHLODE_USAGE, "meshes[0].primitives[0].indices",
         [](CScene& s, O&) { s.primitive.triangle_count = SIZE_MAX; });
  expect(MESHLODE_INVALID, "meshes[0].primitives[0].indices", [](CScene& s, O&) { s.primitive.vertex_count = 5; });
  expect(MESHLODE_INVALID, "meshes[0].primitives[0]", [](CScene& s, O&) { s.primitive.positions = nullptr; });
  expect(MESHLODE_INVALID, "materials[0].alpha_mode", [](CScene& s, O&) { s.material.alpha_mode = 3; });
  expect(MESHLODE_INVALID, "material", [](CScene& s, O&) { s.primitive.material = 1; });
  expect(MESHLODE_USAGE, "error_tier", [](CScene&, O& o) { o.error_tier = 3; });
  expect(MESHLODE_USAGE, "preset", [](CScene&, O& o) { o.preset = 256; });
  expect(MESHLODE_USAGE, "page_size", [](CScene&, O& o) { o.page_size = 48; });
  expect(MESHLODE_USAGE, "page_order", [](CScene&, O& o) { o.page_order = 2; });
  expect(MESHLODE_USAGE, "root_bytes", [](CScene&, O& o) { o.root_bytes = 131073; });
  expect(MESHLODE_USAGE, "strip_effort", [](CScene&, O& o) { o.strip_effort = 4; });
  expect(MESHLODE_USAGE, "attributes", [](CScene&, O& o) { o.attributes = 3; });
  expect(MESHLODE_USAGE, "codec", [](CScene&, O& o) { o.codec = 5; });
  expect(MESHLODE_USAGE, "codec", [](CScene&, O& o) { o.codec = 1; });
  const CScene sound(arrays);
  meshlode_error error;
  EXPECT_EQ(meshlode_build_to_file(nullptr, nullptr, "x.lode", &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_build_to_file(&sound.scene, nullptr, nullptr, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_build_to_file(&sound.scene, nullptr, "no/such/folder/x.lode", &error), MESHLODE_IO);
}

TEST(CBuild, ProgressIsToldAndMayEndTheBuild) {
  const Arrays arrays = sphere();
  const CScene scene(arrays);
  meshlode_build_options options;
  meshlode_build_defaults(&options);
  double reached = 0.0;
  options.user = &reached;
  options.on_progress = [](double fraction, void* user) {
    *static_cast<double*>(user) = fraction;
    return 0;
  };
  EXPECT_FALSE(build_in_c(scene, &options).empty());
  EXPECT_GT(reached, 0.0);
  options.on_progress = [](double, void*) { return 1; };
  void* bytes = nullptr;
  std::size_t size = 0;
  meshlode_error error;
  EXPECT_EQ(meshlode_build_to_buffer(&scene.scene, &options, &bytes, &size, &error), MESHLODE_BUILD_FAILED);
  EXPECT_EQ(bytes, nullptr);
  EXPECT_NE(std::string(error.text).find("cancelled"), std::string::npos) << error.text;
}

}  // namespace
}  // namespace meshlode
