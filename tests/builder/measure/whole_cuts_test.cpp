// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of groups held to whole cuts: true ones stay, too small ones are raised to the truth, and so is what is
// coarser.
#include "builder/measure/whole_cuts.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/dag/build_dag.h"
#include "builder/measure/measure.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

struct Built {
  PreparedMesh mesh;
  LodDag dag;
};

Built build(const scene::Primitive& shape) {
  const scene::SourceMesh source = lab::as_mesh(shape);
  const MeshPlan plan = plan_mesh(source, {}, {AttributeChoice::kNone}, "m");
  Built built{*prepare_mesh(source, plan.layout, {}), {}};
  Result<LodDag> dag = build_dag(built.mesh, {});
  EXPECT_TRUE(dag.ok());
  if (!dag.ok()) return built;
  built.dag = std::move(*dag);
  EXPECT_TRUE(measure(built.mesh, format::ErrorTier::kMeasured, built.dag));
  return built;
}

std::vector<double> errors_of(const LodDag& dag) {
  std::vector<double> errors;
  for (const DagGroup& group : dag.groups) errors.push_back(group.error);
  return errors;
}

void expect_growing(const LodDag& dag) {
  for (const DagCluster& cluster : dag.clusters) {
    if (!cluster.own_group.is_valid()) continue;
    EXPECT_LE(dag.groups[cluster.own_group.value].error, dag.groups[cluster.coarser_group.value].error);
  }
}

/// The coarsest group with an error: what is made from it is a root.
std::size_t coarsest(const LodDag& dag) {
  for (std::size_t g = 0; g < dag.groups.size(); ++g) {
    if (!dag.groups[g].is_terminal) return g;
  }
  return dag.groups.size();
}

TEST(WholeCuts, TrueErrorsStayAsTheyAre) {
  for (const scene::Primitive& shape :
       {lab::make_rock(16), lab::make_terrain(48, 48), lab::make_foliage(600), lab::make_box_soup(150)}) {
    Built built = build(shape);
    const std::vector<double> before = errors_of(built.dag);
    EXPECT_EQ(hold_to_whole_cuts(built.mesh, kMeasuredMargin, built.dag), 0U);
    EXPECT_EQ(errors_of(built.dag), before);
  }
}

TEST(WholeCuts, AnErrorThatSaysTooLittleIsRaisedToTheTruth) {
  for (const scene::Primitive& shape : {lab::make_rock(16), lab::make_foliage(600), lab::make_box_soup(150)}) {
    Built built = build(shape);
    const std::size_t group = coarsest(built.dag);
    ASSERT_LT(group, built.dag.groups.size());
    const double truth = built.dag.groups[group].error;
    // As small as what it replaces lets it be.
    double floor = 0.0;
    for (const DagCluster& cluster : built.dag.clusters) {
      if (cluster.coarser_group.value != group || !cluster.own_group.is_valid()) continue;
      floor = std::max(floor, built.dag.groups[cluster.own_group.value].error);
    }
    ASSERT_LT(floor, truth);
    built.dag.groups[group].error = built.dag.groups[group].deviation = floor + 0.01 * (truth - floor);
    EXPECT_GT(hold_to_whole_cuts(built.mesh, kMeasuredMargin, built.dag), 0U);
    // Samples find a maximum from below: most of the way back.
    EXPECT_GT(built.dag.groups[group].error, floor + 0.8 * (truth - floor));
    EXPECT_LT(built.dag.groups[group].error, 1.05 * truth);
    expect_growing(built.dag);
  }
}

TEST(WholeCuts, WhatIsCoarserIsRaisedToo) {
  Built built = build(lab::make_rock(24));
  // Everything says a hundredth: errors still grow along the DAG, and none is true.
  const std::vector<double> truth = errors_of(built.dag);
  for (DagGroup& group : built.dag.groups) {
    if (!group.is_terminal) group.error = group.deviation = 0.01 * group.error;
  }
  EXPECT_GT(hold_to_whole_cuts(built.mesh, kMeasuredMargin, built.dag), 0U);
  expect_growing(built.dag);
  const std::size_t group = coarsest(built.dag);
  EXPECT_GT(built.dag.groups[group].error, 0.8 * truth[group]);
}

TEST(WholeCuts, AnErrorOfNothingIsRaisedWhereThereIsOneAndStaysOnAPlane) {
  Built rock = build(lab::make_rock(16));
  Built plane = build(lab::make_plane(40));
  const double truth = rock.dag.groups[coarsest(rock.dag)].error;
  for (LodDag* dag : {&rock.dag, &plane.dag}) {
    for (DagGroup& group : dag->groups) {
      if (!group.is_terminal) group.error = group.deviation = 0.0;
    }
  }
  EXPECT_GT(hold_to_whole_cuts(rock.mesh, kMeasuredMargin, rock.dag), 0U);
  EXPECT_GT(rock.dag.groups[coarsest(rock.dag)].error, 0.8 * truth);
  expect_growing(rock.dag);
  ASSERT_LT(coarsest(plane.dag), plane.dag.groups.size());
  EXPECT_EQ(hold_to_whole_cuts(plane.mesh, kMeasuredMargin, plane.dag), 0U);
}

TEST(WholeCuts, DoesNotDependOnTheNumberOfThreads) {
  const Built built = build(lab::make_foliage(800));
  std::vector<double> errors[2];
  for (const int threads : {1, 2}) {
    LodDag dag = built.dag;
    for (DagGroup& group : dag.groups) {
      if (!group.is_terminal) group.error = group.deviation = 0.3 * group.error;
    }
    tbb::task_arena(threads).execute([&] { (void)hold_to_whole_cuts(built.mesh, kMeasuredMargin, dag); });
    errors[threads - 1] = errors_of(dag);
  }
  EXPECT_EQ(errors[0], errors[1]);
}

}  // namespace
}  // namespace meshlode::builder
