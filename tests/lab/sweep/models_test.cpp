// SPDX-License-Identifier: GPL-3.0-or-later
// A real model whose charts overlap and whose sheets are thinner than the grid: what its finest cut is off by is
// quantization, and damage is still found.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "builder/builder.h"
#include "lab/sweep/source_measure.h"
#include "scene/import/import.h"

namespace meshlode::lab {
namespace {

std::map<std::string, double> figures_of(const scene::Scene& source, const run::Asset& asset) {
  Measurement m;
  const Status measured = SourceMeasure(source, 1000, Searches::kFew).measure(asset, m);
  EXPECT_TRUE(measured) << measured.error().message();
  return m.figures;
}

/// Moves the UVs of everything that triangles connect with the first vertex.
void shift_first_chart(scene::Primitive& p, const Vec2f& by) {
  std::vector<std::uint8_t> is_in(p.positions.size(), 0);
  is_in[p.indices[0]] = 1;
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
      const std::uint32_t* t = &p.indices[i];
      const int inside = is_in[t[0]] + is_in[t[1]] + is_in[t[2]];
      if (inside == 0 || inside == 3) continue;
      for (int k = 0; k < 3; ++k) is_in[t[k]] = 1;
      has_grown = true;
    }
  }
  for (std::size_t v = 0; v < is_in.size(); ++v) p.uvs[0][v] += is_in[v] != 0 ? by : Vec2f(0.0F);
}

TEST(SweepModels, TheFinestCutOfFlightHelmetIsOffByQuantizationAlone) {
  const char* folder = std::getenv("MESHLODE_MODELS");
  if (folder == nullptr) {
    const char* required = std::getenv("MESHLODE_REQUIRE_MODELS");
    if (required != nullptr && std::string(required) == "1") FAIL() << "MESHLODE_MODELS is not set";
    GTEST_SKIP() << "MESHLODE_MODELS is not set";
  }
  scene::ImportOptions import;
  import.may_lack_images = true;
  auto source = scene::import_scene(std::filesystem::path(folder) / "FlightHelmet/FlightHelmet.gltf", import);
  ASSERT_TRUE(source.ok()) << source.error().message();
  builder::PipelineReport report;
  auto bytes = builder::build_lode(*source, {}, {}, report);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const auto asset = run::Asset::from_vector(std::move(*bytes));
  ASSERT_TRUE(asset.ok()) << asset.error().message();

  auto sound = figures_of(*source, *asset);
  EXPECT_LT(sound.at("uv_max"), 2e-4) << "two steps of the UVs' grid";
  EXPECT_LT(sound.at("normal_rms"), 0.15) << "the budget is 0.1 degrees";
  EXPECT_LT(sound.at("normal_max"), 8.0) << "on rims of 0.2 mm normals turn by 80 degrees: a slide by the grid's step";

  scene::Primitive& p = source->meshes[0].primitives[0];
  shift_first_chart(p, {0.0F, 0.01F});
  EXPECT_NEAR(figures_of(*source, *asset).at("uv_max"), 0.01, 5e-4);
  shift_first_chart(p, {0.0F, -0.01F});
  p.normals[p.indices[0]] *= -1.0F;
  auto flipped = figures_of(*source, *asset);
  EXPECT_GT(flipped.at("normal_max"), 150.0);
  EXPECT_LT(flipped.at("uv_max"), 2e-4);
}

}  // namespace
}  // namespace meshlode::lab
