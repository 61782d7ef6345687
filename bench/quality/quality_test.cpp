// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of cuts against metrics' own measure, and the search against all cuts one by one.
#include <gtest/gtest.h>

#include <cmath>

#include <glm/trigonometric.hpp>

#include "builder/builder.h"
#include "judge/metrics/cut_judge.h"
#include "judge/metrics/cut_search.h"
#include "lab/samples/samples.h"
#include "reference.h"

namespace meshlode::bench {
namespace {

using judge::cut_thresholds;
using judge::CutFigures;
using judge::CutJudge;
using judge::Figure;
using judge::find_fewest_triangles;

struct Sample {
  judge::Surface source;
  run::Asset asset;
  std::vector<run::DecodedCluster> decoded;
};

Sample make_sample() {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_torus(130, 66)));
  for (Vec3d& p : scene.meshes[0].primitives[0].positions) p += 0.01 * glm::sin(p * 17.0);  // not too smooth
  const scene::Primitive& primitive = scene.meshes[0].primitives[0];
  judge::Surface source{primitive.positions, {}};
  for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
    source.triangles.push_back({primitive.indices[i], primitive.indices[i + 1], primitive.indices[i + 2]});
  }
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, {}, {}, report);
  EXPECT_TRUE(bytes.ok());
  auto asset = run::Asset::from_vector(std::move(*bytes));
  EXPECT_TRUE(asset.ok());
  auto decoded = run::decode_all(*asset);
  EXPECT_TRUE(decoded.ok());
  return {std::move(source), std::move(*asset), std::move(*decoded)};
}

TEST(QualityBench, JudgesCutsAsMetricsDoes) {
  const Sample s = make_sample();
  CutJudge judge(s.source, s.asset, s.decoded, MeshId(0U), 50000);
  const auto thresholds = cut_thresholds(s.asset, MeshId(0U), run::CutError::kSelection);
  ASSERT_GT(thresholds.size(), 4U);
  for (std::size_t i = 0; i < thresholds.size(); i += 3) {
    const run::UniformCut cut = run::select_uniform(s.asset, MeshId(0U), thresholds[i]);
    const judge::Surface surface = judge::surface_of_clusters(s.asset, s.decoded, MeshId(0U), cut.clusters);
    const CutFigures figures = judge.measure(cut.clusters);
    const judge::DeviationReport expected = judge::DeviationFrom(s.source, {.samples = 50000}).measure(surface);
    EXPECT_EQ(figures.triangles, surface.triangles.size());
    EXPECT_DOUBLE_EQ(figures.max_to_cut, expected.a_to_b.max) << "the same samples";
    EXPECT_NEAR(figures.rms_to_cut, expected.a_to_b.rms, 1e-12 + 1e-9 * expected.a_to_b.rms);
    EXPECT_NEAR(figures.max_to_source, expected.b_to_a.max, 0.3 * expected.b_to_a.max) << "other samples";
    EXPECT_NEAR(figures.rms_to_source, expected.b_to_a.rms, 0.05 * expected.b_to_a.rms);
    const CutFigures whole = judge.measure(surface);
    EXPECT_DOUBLE_EQ(whole.max_to_cut, figures.max_to_cut);
    EXPECT_NEAR(whole.rms_to_source, figures.rms_to_source, 0.05 * figures.rms_to_source);
    // Refused exactly where the maximum is above the limit, whatever was measured before.
    EXPECT_TRUE(judge.measure_within(cut.clusters, {.max = figures.max() * (1.0 + 1e-9)}).has_value());
    EXPECT_TRUE(judge.measure_within(cut.clusters, {.rms = figures.rms() * (1.0 + 1e-9)}).has_value());
    EXPECT_FALSE(judge.measure_within(cut.clusters, {.rms = figures.rms() * (1.0 - 1e-9)}).has_value());
    EXPECT_FALSE(judge.measure_within(cut.clusters, {.max = figures.max() * (1.0 - 1e-9)}).has_value());
  }
}

TEST(QualityBench, FindsTheFewestTrianglesOverAllCuts) {
  const Sample s = make_sample();
  for (const Figure figure : {Figure::kMax, Figure::kRms}) {
    const run::CutError by = figure == Figure::kMax ? run::CutError::kSelection : run::CutError::kQuadric;
    CutJudge judge(s.source, s.asset, s.decoded, MeshId(0U), 5000);
    struct One {
      double true_figure;
      std::uint64_t triangles;
    };
    std::vector<One> all;
    for (const double t : cut_thresholds(s.asset, MeshId(0U), by)) {
      const CutFigures f = judge.measure(run::select_uniform(s.asset, MeshId(0U), t, by).clusters);
      all.push_back({figure == Figure::kMax ? f.max() : f.rms(), f.triangles});
    }
    for (const double x :
         {1e-9, all[all.size() / 4].true_figure * 1.0001, all[all.size() / 2].true_figure * 1.01, 1e3}) {
      std::optional<std::uint64_t> expected;
      for (const One& one : all) {
        if (one.true_figure <= x && (!expected || one.triangles < *expected)) expected = one.triangles;
      }
      for (const std::size_t few_cuts : {std::size_t{0}, std::size_t{32}}) {
        CutJudge fresh(s.source, s.asset, s.decoded, MeshId(0U), 5000);
        const auto found = find_fewest_triangles(fresh, s.asset, MeshId(0U), {by, figure, x, few_cuts});
        ASSERT_EQ(found.has_value(), expected.has_value()) << x;
        if (!found) continue;
        EXPECT_EQ(found->figures.triangles, *expected) << x;
        EXPECT_LE(figure == Figure::kMax ? found->figures.max() : found->figures.rms(), x);
      }
    }
  }
}

TEST(QualityBench, TheReferenceSimplifiesAndSaysWhatItLeftOut) {
  const scene::Primitive shape = lab::make_torus(60, 30);
  judge::Surface source{shape.positions, {}};
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    source.triangles.push_back({shape.indices[i], shape.indices[i + 1], shape.indices[i + 2]});
  }
  const std::size_t sound = source.triangles.size();
  source.triangles.push_back({0, 0, 1});                                               // no area
  source.triangles.push_back({source.triangles[0][0], source.triangles[0][1], 1000});  // a third face on an edge
  ReferenceSimplifier reference(source);
  EXPECT_EQ(reference.degenerate_count(), 1U);
  EXPECT_EQ(reference.refused_count(), 1U);
  EXPECT_EQ(reference.face_count(), sound);
  source.triangles.resize(sound);
  EXPECT_LT(judge::DeviationFrom(source, {.samples = 5000}).measure(reference.surface()).max(), 1e-12);
  double before = 0.0;
  for (const std::size_t faces : {sound / 2, sound / 4, sound / 16}) {
    EXPECT_TRUE(reference.decimate_to(faces));
    EXPECT_LE(reference.face_count(), faces);
    EXPECT_GE(reference.face_count(), faces - 2);
    const double deviation = judge::DeviationFrom(source, {.samples = 5000}).measure(reference.surface()).rms();
    EXPECT_GT(deviation, before);
    before = deviation;
  }
  EXPECT_LT(before, 0.05);
}

}  // namespace
}  // namespace meshlode::bench
