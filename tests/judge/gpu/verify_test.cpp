// SPDX-License-Identifier: GPL-3.0-or-later
// The whole of verify --gpu, against a source that is not the asset's: what the GPU draws is the CPU's, and the picture
// is not the source's.
#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "draw/gpu/gpu_support.h"
#include "judge/gpu/verify_gpu.h"
#include "judge/painted_ball.h"
#include "scene/import/import.h"
#include "support/mask_scene.h"
#include "support/plate_scene.h"

namespace meshlode::judge::test {
namespace {

using meshlode::test::build_promised;
using meshlode::test::Built;
using meshlode::test::painted_scene;

using VerifyGpu = draw::test::GpuTest;

struct Failures {
  std::uint64_t items = 0, failures = 0;
  bool is_skipped = false;
  std::string first;
};

/// Of all checks of a rule; V409 has one for each path.
Failures failures_of(const GpuVerifyReport& report, const std::string& id) {
  Failures out{0, 0, true, {}};
  for (const GpuCheck& check : report.checks) {
    if (info_of(check.rule).id != id) continue;
    EXPECT_TRUE(check.items > 0 || check.is_skipped) << id;
    out.items += check.items;
    out.failures += check.failures;
    out.is_skipped = out.is_skipped && check.is_skipped;
    if (out.first.empty()) out.first = check.first;
  }
  EXPECT_TRUE(out.items > 0 || out.is_skipped) << id;
  return out;
}

/// A built asset against what it was built from, from the adversarial cameras too: nothing is displaced by more than a
/// pixel, and nothing shows through.
TEST_F(VerifyGpu, ABuiltAssetHoldsItsPromise) {
  const auto asset = run::Asset::from_vector(draw::test::build_file(MESHLODE_DATA "/rock.glb"));
  const auto scene = scene::import_scene(MESHLODE_DATA "/rock.glb", {});
  ASSERT_TRUE(asset && scene);
  GpuVerifyOptions options;
  options.orbits = 1;
  options.sizes = {{160, 90}, {81, 61}};
  const auto report = verify_on_gpu(*asset, *scene, options);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->cameras.size(), 2U * (10U + 1U)) << "the adversarial ones are judged by the source";
  for (const char* id : {"V401", "V402", "V403", "V404", "V405", "V406", "V409", "V211"}) {
    const Failures found = failures_of(*report, id);
    EXPECT_EQ(found.failures, 0U) << id << ": " << found.first;
    EXPECT_FALSE(found.is_skipped) << id;
  }
  EXPECT_GT(failures_of(*report, "V405").items, 50000U);
  EXPECT_GT(report->largest_share, 0.1) << "a cut at one pixel does move something";
  EXPECT_LE(report->largest_share, 1.05);
}

/// What is painted, seen from cameras: a picture that lies elsewhere on the ball is no matter of positions, normals
/// that turned are one of appearance alone.
TEST_F(VerifyGpu, EachPromiseIsJudgedByWhatItSpeaksOf) {
  const Built ball = build_promised(painted_scene(), format::Promise::kAppearance);
  scene::Scene swum = ball.scene, turned = ball.scene;
  for (Vec2f& uv : swum.meshes[0].primitives[0].uvs[0]) uv.x += 0.05F;
  for (Vec3f& n : turned.meshes[0].primitives[0].normals) n.x += 0.5F;
  GpuVerifyOptions options;
  options.orbits = 0;
  options.sizes = {{96, 72}};
  for (const auto promise : {format::Promise::kPosition, format::Promise::kTexels, format::Promise::kAppearance}) {
    SCOPED_TRACE(static_cast<int>(promise));
    const auto opened = run::Asset::from_vector(ball.bytes);
    ASSERT_TRUE(opened);
    const auto asset = opened->with_promise(promise);
    ASSERT_TRUE(asset);
    const auto judge = [&](const scene::Scene& scene) {
      const auto report = verify_on_gpu(*asset, scene, options);
      EXPECT_TRUE(report) << report.error().message();
      if (!report) return Failures{};
      for (const char* id : {"V402", "V403", "V404"}) EXPECT_EQ(failures_of(*report, id).failures, 0U) << id;
      return failures_of(*report, "V405");
    };
    const Failures own = judge(ball.scene);
    EXPECT_EQ(own.failures, 0U) << own.first;
    EXPECT_GT(own.items, 5000U);
    const bool has_texels = promise != format::Promise::kPosition;
    const bool has_normals = promise == format::Promise::kAppearance;
    const std::uint64_t of_swum = judge(swum).failures, of_turned = judge(turned).failures;
    EXPECT_EQ(of_swum > own.items / 4, has_texels) << of_swum << " of " << own.items;
    EXPECT_EQ(of_swum > 0, has_texels);
    EXPECT_EQ(of_turned > own.items / 4, has_normals) << of_turned << " of " << own.items;
    EXPECT_EQ(of_turned > 0, has_normals);
  }
}

/// The plate of the source is behind the floor of its recess in the asset: at eight pixels nothing is displaced by more
/// than is allowed, and another surface is seen.
TEST_F(VerifyGpu, APlateThatSankIsFoundByWhatPixelsShowAlone) {
  const auto asset =
      run::Asset::from_vector(meshlode::test::built(meshlode::test::plate_scene({.plate_moved = {0.0, 0.0, -1.25}})));
  ASSERT_TRUE(asset);
  GpuVerifyOptions options;
  options.orbits = 0;
  options.pixel_error = 8.0;
  options.sizes = {{320, 240}};
  const auto report = verify_on_gpu(*asset, meshlode::test::plate_scene(), options);
  ASSERT_TRUE(report) << report.error().message();
  for (const char* id : {"V401", "V402", "V403", "V404", "V409"}) {
    EXPECT_EQ(failures_of(*report, id).failures, 0U) << id;
  }
  const Failures found = failures_of(*report, "V211");
  EXPECT_GT(found.failures, 0U);
  EXPECT_FALSE(found.first.empty());
  EXPECT_EQ(found.failures, report->surfaces.beyond_limit);
}

TEST_F(VerifyGpu, AnotherSourceIsToldFromAnotherDrawing) {
  const std::vector<std::uint8_t> bytes = draw::test::build_file(MESHLODE_DATA "/crystal.glb");
  const auto asset = run::Asset::from_vector(bytes);
  const auto scene = scene::import_scene(MESHLODE_DATA "/crystal.glb", {});
  ASSERT_TRUE(asset && scene);
  scene::Scene larger = *scene;
  for (scene::SourceMesh& mesh : larger.meshes) {
    for (scene::Primitive& primitive : mesh.primitives) {
      for (Vec3d& p : primitive.positions) p *= 1.1;
    }
  }
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "verify_gpu_maps";
  std::filesystem::create_directories(folder);
  GpuVerifyOptions options;
  options.orbits = 1;
  options.sizes = {{81, 61}};
  options.out_folder = folder.string();
  const auto report = verify_on_gpu(*asset, larger, options);
  ASSERT_TRUE(report) << report.error().message();
  for (const char* id : {"V401", "V402", "V403", "V404", "V409"}) {
    EXPECT_EQ(failures_of(*report, id).failures, 0U) << id;
  }
  EXPECT_GT(failures_of(*report, "V405").failures, 0U) << "a tenth of the size is many pixels";
  EXPECT_FALSE(report->cameras.empty());
  std::size_t maps = 0;
  for (const JudgedCamera& judged : report->cameras) {
    for (const std::string& map : judged.maps) {
      ++maps;
      EXPECT_TRUE(std::filesystem::exists(folder / map)) << map;
    }
  }
  EXPECT_GT(maps, 0U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meshlode::judge::test
