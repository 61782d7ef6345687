// SPDX-License-Identifier: GPL-3.0-or-later
// Real models, built whole: the root alone is still the thing, and the BVH agrees with the flat rule on real DAGs.
// MESHLODE_MODELS names the folder of the models.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "import/import.h"
#include "metrics/metrics.h"
#include "pipeline/build.h"
#include "select/random_scene.h"

namespace meshlode {
namespace {

std::filesystem::path find_model(const std::string& name) {
  const char* folder = std::getenv("MESHLODE_MODELS");
  const std::filesystem::path path = folder == nullptr ? std::filesystem::path() : std::filesystem::path(folder) / name;
  return !path.empty() && std::filesystem::exists(path) ? path : std::filesystem::path();
}

bool are_models_required() {
  const char* value = std::getenv("MESHLODE_REQUIRE_MODELS");
  return value != nullptr && std::string(value) == "1";
}

void expect_sound_model(const std::filesystem::path& path, double root_limit) {
  const Result<Scene> scene = import_scene(path, {});
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  PipelineReport report;
  Result<std::vector<std::uint8_t>> bytes = build_lode(*scene, {}, {}, report);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const Result<Asset> asset = Asset::from_vector(std::move(*bytes));
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  const Result<std::vector<DecodedCluster>> decoded = decode_all(*asset);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message();
  const double diagonal = asset->meshes()[0].diagonal;
  const Surface source = surface_of_source(scene->meshes[0]);

  const UniformCut roots = select_uniform(*asset, MeshId(0U), HUGE_VAL);
  EXPECT_EQ(roots.clusters.size(), 1U);
  const double root = measure_deviation(source, surface_of_clusters(*asset, *decoded, MeshId(0U), roots.clusters), {})
                          .max() / diagonal;
  EXPECT_LE(root, root_limit);
  const UniformCut finest = select_uniform(*asset, MeshId(0U), 0.0);
  const double level0 =
      measure_deviation(source, surface_of_clusters(*asset, *decoded, MeshId(0U), finest.clusters), {}).max();
  EXPECT_LE(level0, finest.stored_error * (1.0 + 1e-6)) << "quantization alone";
  std::printf("root deviates by %.3f%% of the diagonal, level 0 by %.5f%%\n", 100.0 * root, 100.0 * level0 / diagonal);

  test::RandomSource random(61);
  const SelectTables tables = tables_of(*asset);
  for (int n = 0; n < 200; ++n) {
    const Camera camera = test::make_random_camera(random, tables, asset->instances()[0]);
    const double t = random.log_between(1e-2, 1e2);
    ASSERT_EQ(select_flat(*asset, camera, t), select_bvh(*asset, camera, t)) << "seed 61, camera " << n;
  }
}

void run_model(const std::string& name, double root_limit) {
  const std::filesystem::path path = find_model(name);
  if (path.empty() && are_models_required()) FAIL() << name << " is not below MESHLODE_MODELS";
  if (path.empty()) GTEST_SKIP() << "MESHLODE_MODELS names no folder with " << name;
  expect_sound_model(path, root_limit);
}

TEST(MetricsOnModels, BunnysRootIsWithinEightPercentOfTheDiagonal) { run_model("bunny.glb", 0.08); }
TEST(MetricsOnModels, DragonsRootIsWithinTenPercentOfTheDiagonal) { run_model("dragon.glb", 0.10); }

}  // namespace
}  // namespace meshlode
