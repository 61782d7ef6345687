// SPDX-License-Identifier: GPL-3.0-or-later
// Whole DAGs: no point of the source is farther from a cut than the cut says, nor the other way round.
#include "builder/measure/measure_levels.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/dag/build_dag.h"
#include "builder/measure/measure.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "hand_made.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

struct Built {
  PreparedMesh mesh;
  LodDag dag;

  void measure() { EXPECT_TRUE(builder::measure(mesh, format::ErrorTier::kMeasured, dag)); }
};

Built build(const scene::Primitive& shape) {
  const scene::SourceMesh source = lab::as_mesh(shape);
  const MeshPlan plan = plan_mesh(source, {}, {}, "m");
  Built built{*prepare_mesh(source, plan.layout, {}), {}};
  Result<LodDag> dag = build_dag(built.mesh, {});
  EXPECT_TRUE(dag.ok());
  if (dag.ok()) built.dag = std::move(*dag);
  return built;
}

std::vector<double> errors_of(const LodDag& dag) {
  std::vector<double> errors;
  for (const DagGroup& group : dag.groups) {
    errors.insert(errors.end(), {group.error, group.deviation, group.normal_deviation, group.uv_deviation});
  }
  return errors;
}

std::vector<scene::Primitive> shapes() {
  return {lab::make_rock(12), lab::make_terrain(24, 24), lab::make_foliage(150), lab::make_box_soup(40)};
}

TEST(MeasureLevels, CutsAreAsTrueAsTheySay) {
  for (const scene::Primitive& shape : shapes()) {
    Built built = build(shape);
    built.measure();
    const test::Soup source = test::source_of(built.mesh);
    for (const DagGroup& group : built.dag.groups) {
      if (group.is_terminal) continue;
      const test::Soup cut = test::cut_of(built.mesh, built.dag, group.error);
      const double known = test::sampled_distance(source, cut, 6, group.error);
      EXPECT_LE(test::sampled_distance(cut, source, 6, known), group.error * (1.0 + 1e-6));
    }
  }
}

TEST(MeasureLevels, ErrorsGrowFromFineToCoarse) {
  for (const scene::Primitive& shape : shapes()) {
    Built built = build(shape);
    built.measure();
    for (const DagCluster& c : built.dag.clusters) {
      if (!c.own_group.is_valid()) continue;
      const DagGroup &fine = built.dag.groups[c.own_group.value], &coarse = built.dag.groups[c.coarser_group.value];
      EXPECT_LE(fine.error, coarse.error);
      EXPECT_LE(fine.normal_deviation, coarse.normal_deviation);
      EXPECT_LE(fine.uv_deviation, coarse.uv_deviation);
    }
  }
}

TEST(MeasureLevels, ThreadsDoNotMatter) {
  Built one = build(lab::make_terrain(96, 96));
  Built many = one;
  tbb::task_arena(1).execute([&] { one.measure(); });
  tbb::task_arena(4).execute([&] { many.measure(); });
  EXPECT_EQ(errors_of(one.dag), errors_of(many.dag));
}

TEST(MeasureLevels, AFrameOfAnotherSizeMeasuresTheSame) {
  Built usual = build(lab::make_rock(12));
  for (const int log2 : {-90, 80}) {
    Built scaled = usual;
    const double scale = std::ldexp(1.0, log2);
    scaled.mesh.grid.log2 += log2;
    scaled.mesh.diagonal *= scale;
    scaled.mesh.level0_deviation *= scale;
    for (Vec3d& p : scaled.mesh.exact_positions) p *= scale;
    usual.measure();
    scaled.measure();
    for (std::size_t g = 0; g < usual.dag.groups.size(); ++g) {
      if (usual.dag.groups[g].is_terminal) continue;
      EXPECT_NEAR(scaled.dag.groups[g].error / scale / usual.dag.groups[g].error, 1.0, 1e-6);
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
