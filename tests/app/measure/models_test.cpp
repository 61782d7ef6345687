// SPDX-License-Identifier: GPL-3.0-or-later
// Real models measured by every tier are what builds with these write. MESHLODE_MODELS names their folder.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/measure/measure_asset.h"
#include "builder/builder.h"
#include "scene/import/import.h"

namespace meshlode::app {
namespace {

namespace fs = std::filesystem;
using format::ErrorTier;
using Bytes = std::vector<std::uint8_t>;

class Models : public testing::TestWithParam<const char*> {};

TEST_P(Models, MeasuredAsBuilt) {
  const char* const folder = std::getenv("MESHLODE_MODELS");
  const fs::path path = fs::path(folder == nullptr ? "" : folder) / GetParam();
  if (!fs::exists(path)) GTEST_SKIP() << "set MESHLODE_MODELS to the folder of models: it has no " << GetParam();
  const Result<scene::Scene> scene = scene::import_scene(path, {});
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  const auto built = [&](ErrorTier tier) {
    builder::PipelineOptions options;
    options.error_tier = tier;
    options.codec = format::Codec::kStrips;
    builder::PipelineReport report;
    Result<Bytes> bytes = builder::build_lode(*scene, options, {}, report);
    return bytes ? std::move(*bytes) : Bytes();
  };
  const Result<run::Asset> from = run::Asset::from_vector(built(ErrorTier::kQem));
  ASSERT_TRUE(from.ok());
  for (const ErrorTier tier : {ErrorTier::kQem, ErrorTier::kMeasured, ErrorTier::kCertified}) {
    const Result<Bytes> out = measure_asset(*from, *scene, tier);
    ASSERT_TRUE(out.ok()) << out.error().message();
    EXPECT_TRUE(*out == built(tier)) << static_cast<int>(tier);
  }
}

#ifdef MESHLODE_LARGE_MODELS
INSTANTIATE_TEST_SUITE_P(More, Models, testing::Values("bunny-three-materials.glb"));
#else
INSTANTIATE_TEST_SUITE_P(All, Models,
                         testing::Values("bunny.glb", "FlightHelmet/FlightHelmet.gltf", "spot.glb", "fandisk.glb"));
#endif

}  // namespace
}  // namespace meshlode::app
