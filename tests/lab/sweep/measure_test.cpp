// SPDX-License-Identifier: GPL-3.0-or-later
// A point's figures are those that judge and info have.
#include "lab/sweep/source_measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <glm/trigonometric.hpp>

#include "builder/builder.h"
#include "judge/metrics/cut_judge.h"
#include "judge/metrics/cut_search.h"
#include "lab/samples/samples.h"
#include "lab/sweep/draw_views.h"
#include "lab/sweep/metrics.h"
#include "run/decode/decode.h"

namespace meshlode::lab {
namespace {

struct Sample {
  scene::Scene scene;
  run::Asset asset;
};

Sample make_sample() {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_torus(100, 50)));
  for (Vec3d& p : scene.meshes[0].primitives[0].positions) p += 0.01 * glm::sin(p * 17.0);  // not too smooth
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, {}, {}, report);
  EXPECT_TRUE(bytes.ok());
  auto asset = run::Asset::from_vector(std::move(*bytes));
  EXPECT_TRUE(asset.ok());
  return {std::move(scene), std::move(*asset)};
}

constexpr std::uint64_t kSamples = 10000;

TEST(SweepMeasure, FiguresAreThoseOfTheJudge) {
  const Sample s = make_sample();
  Measurement m;
  ASSERT_TRUE(SourceMeasure(s.scene, kSamples).measure(s.asset, m));
  const double diagonal = s.asset.meshes()[0].diagonal;
  const judge::Surface source = judge::surface_of_source(s.scene.meshes[0]);
  const auto decoded = run::decode_all(s.asset);
  ASSERT_TRUE(decoded);
  const auto finest = run::select_uniform(s.asset, MeshId(0U), 0.0);
  const auto expected = judge::DeviationFrom(source, {.samples = kSamples})
                            .measure(judge::surface_of_clusters(s.asset, *decoded, MeshId(0U), finest.clusters));
  EXPECT_NEAR(m.figures.at("deviation"), expected.max() / diagonal, 0.3 * expected.max() / diagonal) << "other samples";
  EXPECT_NEAR(m.figures.at("deviation_rms"), expected.rms() / diagonal, 0.05 * expected.rms() / diagonal);
  judge::CutJudge judge(source, s.asset, *decoded, MeshId(0U), kSamples);
  judge::CutSearch search;
  search.x = kAtMax * diagonal;
  const auto found = judge::find_fewest_triangles(judge, s.asset, MeshId(0U), search);
  ASSERT_TRUE(found);
  EXPECT_EQ(m.figures.at("triangles_at_max"), static_cast<double>(found->figures.triangles));
  EXPECT_EQ(m.figures.at("file_bytes"), static_cast<double>(s.asset.bytes().size()));
  EXPECT_EQ(m.asset.clusters, s.asset.clusters().size());
  std::uint64_t triangles = 0;
  for (const std::uint64_t level : m.asset.level_triangles) triangles += level;
  EXPECT_EQ(triangles, m.asset.stored_triangles);
  // Coarser cuts have fewer triangles, and no less error stored.
  ASSERT_GE(m.cuts.size(), 3U);
  for (std::size_t i = 1; i < m.cuts.size(); ++i) {
    EXPECT_LE(m.cuts[i].triangles, m.cuts[i - 1].triangles);
    EXPECT_GE(m.cuts[i].stored, m.cuts[i - 1].stored);
  }
  EXPECT_EQ(m.cuts[0].max, m.figures.at("deviation"));
  for (const auto& [key, value] : m.figures) {
    EXPECT_NE(find_metric(key), nullptr) << key;
    EXPECT_TRUE(std::isfinite(value)) << key;
  }
}

TEST(SweepMeasure, FewSearchesHaveTheSameFiguresAndFewerRows) {
  const Sample s = make_sample();
  Measurement all, few;
  ASSERT_TRUE(SourceMeasure(s.scene, kSamples).measure(s.asset, all));
  ASSERT_TRUE(SourceMeasure(s.scene, kSamples, Searches::kFew).measure(s.asset, few));
  EXPECT_EQ(all.equal.size(), 4U);
  ASSERT_EQ(few.equal.size(), 1U);
  EXPECT_EQ(few.equal[0].x, kAtMax);
  EXPECT_FALSE(few.figures.contains("triangles_at_rms"));
  all.figures.erase("triangles_at_rms");
  EXPECT_EQ(few.figures, all.figures);
}

TEST(SweepMeasure, ASceneWithOtherMeshesIsRefused) {
  const Sample s = make_sample();
  scene::Scene other = s.scene;
  other.meshes.push_back(other.meshes[0]);
  Measurement m;
  const Status refused = SourceMeasure(other, kSamples).measure(s.asset, m);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalid);
}

run::Camera framing() {
  run::Camera camera;
  camera.eye = {2.0, 2.0, 4.0};
  camera.width = 160;
  camera.height = 90;
  camera.near_distance = 0.01;
  return camera;
}

TEST(SweepMeasure, TheFullResolutionDiffersFromItselfInNothing) {
  const Sample s = make_sample();
  ViewSet set{make_views(framing()), {}, {}, std::uint64_t{64} << 20U};
  ASSERT_TRUE(draw_full(s.asset, set));
  ASSERT_EQ(set.full.size(), set.views.size());
  std::vector<std::string> written;
  const WritePicture write = [&](const std::string& path, const draw::Image& image) -> Status {
    written.push_back(path);
    EXPECT_EQ(image.rgba.size(), std::size_t{4} * image.width * image.height);
    return Ok{};
  };
  Measurement same, coarse;
  ASSERT_TRUE(draw_point(s.asset, set, 0.0, "same", write, same));
  EXPECT_EQ(same.figures.at("flip"), 0.0);
  EXPECT_EQ(same.figures.at("flip_max"), 0.0);
  EXPECT_FALSE(same.figures.contains("psnr")) << "it is infinite";
  ASSERT_TRUE(draw_point(s.asset, set, 8.0, "coarse", write, coarse));
  EXPECT_GT(coarse.figures.at("flip"), 0.0);
  EXPECT_GT(coarse.figures.at("psnr"), 10.0);
  EXPECT_LT(coarse.figures.at("cut_triangles"), same.figures.at("cut_triangles"));
  EXPECT_EQ(written.size(), 4 * set.views.size());
}

TEST(SweepMeasure, FramesAreTimed) {
  const Sample s = make_sample();
  ViewSet set{make_views(framing()), {}, {}, std::uint64_t{64} << 20U};
  Measurement m;
  ASSERT_TRUE(time_frames(s.asset, set, 1.0, false, m));
  EXPECT_GT(m.figures.at("frame_cpu_seconds"), 0.0);
  EXPECT_FALSE(m.figures.contains("frame_vulkan_seconds"));
}

}  // namespace
}  // namespace meshlode::lab
