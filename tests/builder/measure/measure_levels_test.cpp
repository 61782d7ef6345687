// SPDX-License-Identifier: GPL-3.0-or-later
// Whole DAGs: no point of the source is farther from a cut than the cut says, nor the other way round.
#include "builder/measure/measure_levels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/dag/build_dag.h"
#include "builder/measure/measure.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "hand_made.h"
#include "judge/metrics/surface_bracket.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

struct Built {
  PreparedMesh mesh;
  LodDag dag;

  void measure(format::ErrorTier tier = format::ErrorTier::kMeasured) {
    EXPECT_TRUE(builder::measure(mesh, tier, dag));
  }
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

judge::Surface surface_of(const test::Soup& soup) {
  judge::Surface surface;
  for (const TriangleCorners& t : soup) {
    const auto first = static_cast<std::uint32_t>(surface.positions.size());
    surface.positions.insert(surface.positions.end(), t.begin(), t.end());
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  return surface;
}

/// A distance that some point of one surface has from the other: the largest, but for what the search leaves open.
double met_distance(const judge::Surface& from, const judge::Surface& to, double enough) {
  const judge::TriangleTree tree(to);
  std::vector<std::uint32_t> all(from.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  judge::BracketOptions options;
  options.enough = enough;
  options.budget = 16 * (from.triangles.size() + to.triangles.size());
  return judge::bracket_one_way(from, all, {to, tree}, options).lower;
}

/// So many clusters that their units are divided in several blocks, and so many levels that groups are off by more than
/// the size of a unit. Without samples.
TEST(MeasureLevels, CutsOfManyClustersAreAsTrueAsTheySay) {
  for (const scene::Primitive& shape : {lab::make_rock(52), lab::make_terrain(128, 128)}) {
    Built built = build(shape);
    built.measure();
    ASSERT_GT(built.mesh.triangles.size() / 128, 192U);
    const judge::Surface source = surface_of(test::source_of(built.mesh));
    std::vector<double> errors;
    for (const DagGroup& group : built.dag.groups) {
      if (!group.is_terminal) errors.push_back(group.error);
    }
    std::sort(errors.begin(), errors.end());
    for (const std::size_t part : {2, 8, 13, 15, 16}) {
      const double error = errors[(errors.size() - 1) * part / 16];
      const judge::Surface cut = surface_of(test::cut_of(built.mesh, built.dag, error));
      EXPECT_LE(met_distance(source, cut, error), error * (1.0 + 1e-6)) << part;
      EXPECT_LE(met_distance(cut, source, error), error * (1.0 + 1e-6)) << part;
    }
  }
}

void expect_errors_grow(const LodDag& dag) {
  for (const DagCluster& c : dag.clusters) {
    if (!c.own_group.is_valid()) continue;
    const DagGroup &fine = dag.groups[c.own_group.value], &coarse = dag.groups[c.coarser_group.value];
    EXPECT_LE(fine.error, coarse.error);
    EXPECT_LE(fine.normal_deviation, coarse.normal_deviation);
    EXPECT_LE(fine.uv_deviation, coarse.uv_deviation);
  }
}

TEST(MeasureLevels, ErrorsGrowFromFineToCoarse) {
  for (const scene::Primitive& shape : shapes()) {
    Built built = build(shape);
    for (const format::ErrorTier tier : {format::ErrorTier::kMeasured, format::ErrorTier::kCertified}) {
      built.measure(tier);
      expect_errors_grow(built.dag);
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
