// SPDX-License-Identifier: GPL-3.0-or-later
// <meshlode/build.h>: what may be passed, what is refused, and that builds do not disturb each other.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/runtime.h>

#include "arrays.h"

namespace meshlode {
namespace {

using test::Arrays;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Arrays sphere(std::uint32_t n = 24) {
  return Arrays(lab::with_smooth_normals(lab::make_sphere(n)));
}

void expect_refused(const Result<std::vector<std::uint8_t>>& result, ErrorCode code, const std::string& place) {
  ASSERT_FALSE(result.ok()) << "expected an error at " << place;
  EXPECT_EQ(result.error().code, code) << result.error().message();
  EXPECT_NE(result.error().where.find(place), std::string::npos) << result.error().message();
}

TEST(ApiBuild, ASphereBecomesAnAssetWithOneMeshAndItsTriangles) {
  const Arrays arrays = sphere();
  auto bytes = test::build_one(arrays.primitive());
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  auto asset = AssetFile::take(std::move(*bytes));
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  ASSERT_EQ(asset->meshes().size(), 1U);
  ASSERT_EQ(asset->instances().size(), 1U) << "without instances each mesh is drawn once";
  EXPECT_EQ(asset->text(asset->meshes()[0].name), "one");
  EXPECT_EQ(asset->meshes()[0].source_triangles, arrays.indices.size() / 3);
  std::uint64_t finest = 0;
  for (const auto& cluster : asset->clusters()) finest += cluster.level == 0 ? cluster.triangle_count() : 0U;
  EXPECT_EQ(finest, arrays.indices.size() / 3);
}

TEST(ApiBuild, FloatAndDoublePositionsOfTheSameValuesDecodeAlike) {
  const Arrays arrays = sphere(8);
  const std::vector<double> widened(arrays.positions.begin(), arrays.positions.end());
  PrimitiveInput primitive = arrays.primitive();
  const auto from_float = test::build_one(primitive);
  primitive.positions = {};
  primitive.positions_double = widened;
  const auto from_double = test::build_one(primitive);
  ASSERT_TRUE(from_float.ok() && from_double.ok());
  const auto a = AssetFile::view(*from_float);
  const auto b = AssetFile::view(*from_double);
  ASSERT_TRUE(a.ok() && b.ok());
  for (int i = 0; i < 16; ++i) EXPECT_EQ(a->header().content_hash[i], b->header().content_hash[i]);
}

TEST(ApiBuild, ArraysThatDoNotFitAreRefusedWithTheirPlace) {
  const Arrays good = sphere(4);
  PrimitiveInput p = good.primitive();
  p.positions = p.positions.first(p.positions.size() - 1);
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "meshes[0].primitives[0].positions");
  p = good.primitive();
  p.normals = p.normals.first(p.normals.size() - 3);
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "meshes[0].primitives[0].normals");
  p = good.primitive();
  p.uvs[2] = p.positions.first(2);
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "primitives[0].uvs[2]");
  p = good.primitive();
  p.colors = p.positions.first(4);
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "primitives[0].colors");
  p = good.primitive();
  p.indices = p.indices.first(p.indices.size() - 1);
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "primitives[0].indices");
  p = good.primitive();
  p.positions_double = good.exact;
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "meshes[0].primitives[0]");
  p = good.primitive();
  p.material = 0;
  expect_refused(test::build_one(p), ErrorCode::kInvalid, "primitives[0].material");
}

TEST(ApiBuild, BadNumbersAreRefusedWithTheirPlace) {
  Arrays bad = sphere(4);
  bad.positions[7] = kNan;
  expect_refused(test::build_one(bad.primitive()), ErrorCode::kInvalid, "positions[7]");
  bad = sphere(4);
  bad.positions[8] = std::numeric_limits<float>::infinity();
  expect_refused(test::build_one(bad.primitive()), ErrorCode::kInvalid, "positions[8]");
  bad = sphere(4);
  bad.normals[3] = kNan;
  expect_refused(test::build_one(bad.primitive()), ErrorCode::kInvalid, "normals[3]");
  bad = sphere(4);
  bad.indices[5] = static_cast<std::uint32_t>(bad.positions.size() / 3);
  expect_refused(test::build_one(bad.primitive()), ErrorCode::kInvalid, "indices[5]");
}

TEST(ApiBuild, RepairDropsAndCountsWhatTouchesABadNumberOrIndex) {
  Arrays bad = sphere(8);
  const auto triangles = static_cast<std::uint32_t>(bad.indices.size() / 3);
  bad.positions[3 * bad.indices[0]] = kNan;
  std::uint32_t touched = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    bool is_touched = false;
    for (std::uint32_t c = 0; c < 3; ++c) is_touched = is_touched || bad.indices[3 * t + c] == bad.indices[0];
    touched += is_touched ? 1U : 0U;
  }
  ASSERT_GT(touched, 0U);
  bad.indices[bad.indices.size() - 1] = 0xFFFFFFFFU;  // one more triangle, far from the first
  BuildOptions options;
  options.repair = true;
  auto bytes = test::build_one(bad.primitive(), options);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const auto asset = AssetFile::take(std::move(*bytes));
  ASSERT_TRUE(asset.ok());
  EXPECT_EQ(asset->meshes()[0].dropped_repaired, touched + 1U);
}

TEST(ApiBuild, ScenesAreCheckedToo) {
  const Arrays arrays = sphere(4);
  const PrimitiveInput primitive = arrays.primitive();
  MeshInput mesh;
  mesh.primitives = {&primitive, 1};
  InstanceInput instance;
  SceneInput scene;
  scene.meshes = {&mesh, 1};
  scene.instances = {&instance, 1};
  instance.mesh = 1;
  expect_refused(build_asset(scene, {}), ErrorCode::kInvalid, "instances[0].mesh");
  instance.mesh = 0;
  instance.transform[5] = std::nan("");
  expect_refused(build_asset(scene, {}), ErrorCode::kInvalid, "instances[0].transform[5]");
  instance = {};
  instance.transform[3] = 0.5;
  expect_refused(build_asset(scene, {}), ErrorCode::kInvalid, "instances[0].transform");
  instance = {};
  MaterialInput material;
  material.base_color[2] = kNan;
  scene.materials = {&material, 1};
  expect_refused(build_asset(scene, {}), ErrorCode::kInvalid, "materials[0].base_color[2]");
}

TEST(ApiBuild, OptionsThatMakeNoSenseAreUsageErrors) {
  const Arrays arrays = sphere(4);
  BuildOptions options;
  options.grid_step = -1.0;
  expect_refused(test::build_one(arrays.primitive(), options), ErrorCode::kUsage, "grid_step");
  const auto expect_usage = [&](const char* field, const auto& spoil) {
    BuildOptions spoilt;
    spoil(spoilt);
    expect_refused(test::build_one(arrays.primitive(), spoilt), ErrorCode::kUsage,
                   std::string("BuildOptions::") + field);
  };
  expect_usage("grid_step", [](BuildOptions& o) { o.grid_step = std::nan(""); });
  expect_usage("position_error", [](BuildOptions& o) { o.position_error = -1e-9; });
  expect_usage("position_error", [](BuildOptions& o) { o.position_error = o.grid_step = 0.01; });
  expect_usage("normal_error", [](BuildOptions& o) { o.normal_error = 0.0; });
  expect_usage("cluster_triangles", [](BuildOptions& o) { o.cluster_triangles = 257; });
  expect_usage("cluster_triangles", [](BuildOptions& o) { o.cluster_triangles = 0; });
  expect_usage("group_clusters", [](BuildOptions& o) { o.group_clusters = 3; });
  expect_usage("group_clusters", [](BuildOptions& o) { o.group_clusters = 33; });
  expect_usage("normal_error", [](BuildOptions& o) { o.normal_error = HUGE_VAL; });
  expect_usage("uv_error", [](BuildOptions& o) { o.uv_error = std::nan(""); });
  expect_usage("thread_count", [](BuildOptions& o) { o.thread_count = 4097; });
  expect_usage("error_tier", [](BuildOptions& o) { o.error_tier = static_cast<format::ErrorTier>(3); });
  expect_usage("preset", [](BuildOptions& o) { o.preset = static_cast<Preset>(3); });
  expect_usage("page_size", [](BuildOptions& o) { o.page_size = 0; });
  expect_usage("page_order", [](BuildOptions& o) { o.page_order = static_cast<PageOrder>(2); });
  expect_usage("root_bytes", [](BuildOptions& o) { o.root_bytes = 16383; });
  expect_usage("strip_effort", [](BuildOptions& o) { o.strip_effort = static_cast<StripEffort>(4); });
  expect_usage("attributes", [](BuildOptions& o) { o.attributes = static_cast<AttributeChoice>(3); });
  expect_usage("uv_error_unit", [](BuildOptions& o) { o.uv_error_unit = static_cast<UvErrorUnit>(2); });
  expect_usage("codec", [](BuildOptions& o) { o.codec = static_cast<format::Codec>(5); });
  expect_usage("codec", [](BuildOptions& o) { o.codec = format::Codec::kZstd; });
}

TEST(ApiBuild, WhatCannotBeDoneIsSaidBeforeItIsTried) {
  const Arrays arrays = sphere(4);
  BuildOptions options;
  options.normal_error = 0.001;
  EXPECT_EQ(test::build_one(arrays.primitive(), options).error().code, ErrorCode::kUnsupported);
  options = {};
  options.position_error = 1e-12;
  EXPECT_EQ(test::build_one(arrays.primitive(), options).error().code, ErrorCode::kUnsupported);
  options = {};
  options.max_memory_bytes = 1;
  EXPECT_EQ(test::build_one(arrays.primitive(), options).error().code, ErrorCode::kBuildFailed);
}

TEST(ApiBuild, BudgetsBoundWhatIsStored) {
  const Arrays arrays(lab::make_rock(12));
  BuildOptions options;
  options.error_tier = format::ErrorTier::kQem;
  options.attributes = AttributeChoice::kAll;
  options.position_error = 1e-3;
  options.normal_error = 1.0;
  options.uv_error = 1.0 / 1024;
  const auto built = test::build_one(arrays.primitive(), options);
  ASSERT_TRUE(built.ok()) << built.error().message();
  const auto asset = AssetFile::view(*built);
  ASSERT_TRUE(asset.ok());
  const format::MeshRecord& mesh = asset->meshes()[0];
  EXPECT_LE(mesh.level0_deviation, 1e-3F);
  EXPECT_GT(mesh.level0_deviation, 1e-4F) << "no finer than asked for";
  EXPECT_EQ(mesh.normal_scale, 82U) << "sqrt(2) / M radians are one degree";
  EXPECT_EQ(mesh.uv_log2[0], -9) << "half a step is a 1024th";

  options.uv_error = 4.0;
  options.uv_error_unit = UvErrorUnit::kTexels;  // of 2,048 a side: no texture is known
  const auto in_texels = test::build_one(arrays.primitive(), options);
  ASSERT_TRUE(in_texels.ok()) << in_texels.error().message();
  EXPECT_EQ(AssetFile::view(*in_texels)->meshes()[0].uv_log2[0], -8) << "half a step is four 2048ths";
}

TEST(ApiBuild, AttributesAreThoseOfTheChoice) {
  const Arrays arrays(lab::make_rock(12));
  PrimitiveInput primitive = arrays.primitive();
  primitive.material = 0;
  MeshInput mesh;
  mesh.primitives = {&primitive, 1};
  MaterialInput material;
  material.uv_sets_used = 0;
  SceneInput scene;
  scene.meshes = {&mesh, 1};
  scene.materials = {&material, 1};
  struct Expected {
    AttributeChoice choice;
    format::NormalMode normals;
    std::uint32_t uv_sets;
  };
  for (const Expected& expected : {Expected{AttributeChoice::kAuto, format::NormalMode::kStored, 0},
                                   Expected{AttributeChoice::kNone, format::NormalMode::kNone, 0},
                                   Expected{AttributeChoice::kAll, format::NormalMode::kStored, 1}}) {
    BuildOptions options;
    options.error_tier = format::ErrorTier::kQem;
    options.attributes = expected.choice;
    const auto built = build_asset(scene, options);
    ASSERT_TRUE(built.ok()) << built.error().message();
    const auto asset = AssetFile::view(*built);
    ASSERT_TRUE(asset.ok());
    EXPECT_EQ(asset->meshes()[0].normal_mode, expected.normals);
    EXPECT_EQ(asset->meshes()[0].uv_set_count, expected.uv_sets);
  }
}

TEST(ApiBuild, EveryErrorTierIsStored) {
  const Arrays arrays = sphere(16);
  for (const auto tier : {format::ErrorTier::kQem, format::ErrorTier::kMeasured, format::ErrorTier::kCertified}) {
    BuildOptions options;
    options.error_tier = tier;
    const auto built = test::build_one(arrays.primitive(), options);
    ASSERT_TRUE(built.ok()) << built.error().message();
    const auto file = AssetFile::view(*built);
    ASSERT_TRUE(file.ok()) << file.error().message();
    EXPECT_EQ(file->meshes()[0].error_tier, tier);
  }
}

TEST(ApiBuild, APresetSetsTheTierThatNobodyAskedForAndIsNamed) {
  const Arrays arrays = sphere(16);
  struct Expected {
    Preset preset;
    std::optional<format::ErrorTier> asked;
    format::ErrorTier tier;
    const char* name;
  };
  using format::ErrorTier;
  for (const Expected& expected : {Expected{Preset::kFast, {}, ErrorTier::kQem, "fast"},
                                   Expected{Preset::kDefault, {}, ErrorTier::kMeasured, "default"},
                                   Expected{Preset::kBest, {}, ErrorTier::kMeasured, "best"},
                                   Expected{Preset::kFast, ErrorTier::kMeasured, ErrorTier::kMeasured, "fast"},
                                   Expected{Preset::kBest, ErrorTier::kQem, ErrorTier::kQem, "best"}}) {
    BuildOptions options;
    options.preset = expected.preset;
    options.error_tier = expected.asked;
    const auto built = test::build_one(arrays.primitive(), options);
    ASSERT_TRUE(built.ok()) << built.error().message();
    const auto file = AssetFile::view(*built);
    ASSERT_TRUE(file.ok()) << file.error().message();
    EXPECT_EQ(file->meshes()[0].error_tier, expected.tier) << expected.name;
    std::string named = "\"preset\":\"";
    named += expected.name;
    EXPECT_NE(file->meta_json().find(named + '"'), std::string_view::npos) << expected.name;
  }
}

TEST(ApiBuild, AnEmptySceneAndAnEmptyMeshAreNoErrors) {
  EXPECT_TRUE(build_asset({}, {}).ok());
  MeshInput mesh;
  mesh.name = "nothing";
  SceneInput scene;
  scene.meshes = {&mesh, 1};
  const auto bytes = build_asset(scene, {});
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  EXPECT_TRUE(AssetFile::view(*bytes).ok());
}

TEST(ApiBuild, InstancesAndMaterialsArriveAsGiven) {
  const Arrays arrays = sphere(6);
  std::array<PrimitiveInput, 2> primitives{arrays.primitive(), arrays.primitive()};
  primitives[0].material = 1;
  primitives[1].material = kDefaultMaterial;
  MeshInput mesh;
  mesh.name = "two";
  mesh.primitives = primitives;
  std::array<MaterialInput, 2> materials;
  materials[0].name = "unused";
  materials[1].name = "leaf";
  materials[1].alpha_mode = format::AlphaMode::kMask;
  materials[1].alpha_cutoff = 0.25F;
  materials[1].double_sided = true;
  InstanceInput mirrored;
  mirrored.name = "mirrored";
  mirrored.transform = {-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1};
  SceneInput scene;
  scene.meshes = {&mesh, 1};
  scene.materials = materials;
  scene.instances = {&mirrored, 1};
  auto bytes = build_asset(scene, {});
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const auto asset = AssetFile::take(std::move(*bytes));
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  ASSERT_EQ(asset->materials().size(), 3U);
  EXPECT_EQ(asset->text(asset->materials()[1].name), "leaf");
  EXPECT_EQ(asset->materials()[1].alpha_mode, format::AlphaMode::kMask);
  EXPECT_EQ(asset->materials()[1].alpha_cutoff, 0.25F);
  EXPECT_EQ(asset->materials()[1].double_sided, 1U);
  EXPECT_EQ(asset->materials()[2].source_index, format::kNone) << "the default material";
  ASSERT_EQ(asset->instances().size(), 1U);
  const format::InstanceRecord& instance = asset->instances()[0];
  EXPECT_EQ(asset->text(instance.name), "mirrored");
  EXPECT_NE(instance.flags & format::kInstanceMirrored, 0U);
  EXPECT_GE(instance.scale, 2.0);
  EXPECT_LT(instance.scale, 2.0 + 1e-9);
  EXPECT_EQ(instance.transform[0], -2.0);
  EXPECT_EQ(instance.transform[3], 10.0);
  EXPECT_EQ(instance.transform[7], 20.0);
  EXPECT_EQ(instance.transform[11], 30.0);
}

TEST(ApiBuild, CancelEndsTheBuildAtItsNextQuestion) {
  const Arrays arrays = sphere(40);
  BuildOptions options;
  options.should_cancel = [] { return true; };
  auto result = test::build_one(arrays.primitive(), options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kBuildFailed);
  int questions = 0;
  options.should_cancel = [&] { return ++questions > 2; };
  result = test::build_one(arrays.primitive(), options);
  ASSERT_FALSE(result.ok()) << "a mesh of several levels asks more than twice";
  EXPECT_EQ(result.error().code, ErrorCode::kBuildFailed);
}

TEST(ApiBuild, ProgressNeverFallsAndNamesTheMesh) {
  const Arrays arrays = sphere(40);
  BuildOptions options;
  double last = 0.0;
  int events = 0;
  options.on_progress = [&](const BuildProgress& progress) {
    ++events;
    EXPECT_GE(progress.fraction, last);
    EXPECT_LE(progress.fraction, 1.0);
    EXPECT_EQ(progress.mesh, 0U);
    EXPECT_EQ(progress.mesh_name, "one");
    last = progress.fraction;
  };
  ASSERT_TRUE(test::build_one(arrays.primitive(), options).ok());
  EXPECT_GT(events, 0);
}

TEST(ApiBuild, AThrowingCallbackIsAnError) {
  const Arrays arrays = sphere(8);
  BuildOptions options;
  options.on_progress = [](const BuildProgress&) { throw std::runtime_error("from the callback"); };
  const auto result = test::build_one(arrays.primitive(), options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kBuildFailed);
  EXPECT_EQ(result.error().message(), "from the callback");     // no internal error: it is the caller's own
  options.on_progress = [](const BuildProgress&) { throw 7; };  // NOLINT: what no library throws
  const auto odd = test::build_one(arrays.primitive(), options);
  ASSERT_FALSE(odd.ok());
  EXPECT_EQ(odd.error().code, ErrorCode::kBuildFailed);
  EXPECT_EQ(odd.error().message(), "an exception of an unknown type");
  options.on_progress = {};
  options.should_cancel = []() -> bool { throw std::bad_alloc(); };
  const auto at_once = test::build_one(arrays.primitive(), options);
  ASSERT_FALSE(at_once.ok());
  EXPECT_EQ(at_once.error().message(), "out of memory");
}

// METIS draws from the C library's rand(): builds at the same time must not disturb each other (I10).
TEST(ApiBuild, BuildsAtTheSameTimeGiveTheBytesOfBuildsOneAfterTheOther) {
  const Arrays a = sphere(48);
  const Arrays b(lab::make_torus(96, 40));
  const auto a_alone = test::build_one(a.primitive());
  const auto b_alone = test::build_one(b.primitive());
  ASSERT_TRUE(a_alone.ok() && b_alone.ok());
  for (int round = 0; round < 3; ++round) {
    std::array<std::vector<std::uint8_t>, 4> together;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < together.size(); ++i) {
      threads.emplace_back([&, i] {
        auto built = test::build_one(i % 2 == 0 ? a.primitive() : b.primitive());
        if (built) together[i] = std::move(*built);
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < together.size(); ++i) {
      EXPECT_TRUE(together[i] == (i % 2 == 0 ? *a_alone : *b_alone)) << "build " << i << ", round " << round;
    }
  }
}

TEST(ApiBuild, ThreadCountDoesNotReachTheBytes) {
  const Arrays a = sphere(48);
  std::vector<std::uint8_t> first;
  for (const std::uint32_t threads : {1U, 2U, 4U}) {
    BuildOptions options;
    options.thread_count = threads;
    auto built = test::build_one(a.primitive(), options);
    ASSERT_TRUE(built.ok());
    if (first.empty())
      first = std::move(*built);
    else
      EXPECT_TRUE(first == *built) << threads << " threads";
  }
}

TEST(ApiBuild, FilesAppearWholeOrNotAtAll) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "meshlode_api_files";
  std::filesystem::create_directories(folder);
  const auto output = folder / "a.lode";
  std::filesystem::remove(output);
  Arrays bad = sphere(4);
  bad.indices[0] = 0xFFFFFFFFU;
  PrimitiveInput primitive = bad.primitive();
  MeshInput mesh;
  mesh.primitives = {&primitive, 1};
  SceneInput scene;
  scene.meshes = {&mesh, 1};
  EXPECT_FALSE(build_asset_file(scene, output, {}).ok());
  EXPECT_FALSE(std::filesystem::exists(output));
  const Arrays good = sphere(4);
  primitive = good.primitive();
  ASSERT_TRUE(build_asset_file(scene, output, {}).ok());
  EXPECT_TRUE(AssetFile::open(output).ok());
  EXPECT_EQ(build_asset_file(scene, folder / "no" / "such" / "folder.lode", {}).error().code, ErrorCode::kIo);
  EXPECT_EQ(build_file(folder / "missing.glb", output, {}).error().code, ErrorCode::kIo);
  std::ofstream(folder / "broken.glb") << "glTF but not really";
  EXPECT_EQ(build_file(folder / "broken.glb", output, {}).error().code, ErrorCode::kInvalid);
  EXPECT_TRUE(AssetFile::open(output).ok()) << "a failed build leaves the old file alone";
  std::filesystem::copy_file(MESHLODE_SOURCE_DIR "/data/crystal.glb", folder / "scene.glb");
  std::filesystem::create_hard_link(folder / "scene.glb", folder / "alias");
  EXPECT_EQ(build_file(folder / "scene.glb", folder / "alias", {}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(std::filesystem::file_size(folder / "alias"),
            std::filesystem::file_size(MESHLODE_SOURCE_DIR "/data/crystal.glb"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meshlode
