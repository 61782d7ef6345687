// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/measure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/dag/build_dag.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

using format::ErrorTier;

struct Built {
  PreparedMesh mesh;
  LodDag dag;
};

/// Not measured yet.
Built build(const scene::Primitive& shape) {
  const scene::SourceMesh source = lab::as_mesh(shape);
  const MeshPlan plan = plan_mesh(source, {}, {AttributeChoice::kAll}, "m");
  Built built{*prepare_mesh(source, plan.layout, {}), {}};
  Result<LodDag> dag = build_dag(built.mesh, {});
  EXPECT_TRUE(dag.ok());
  if (dag.ok()) built.dag = std::move(*dag);
  return built;
}

LodDag measured(const Built& built, ErrorTier tier) {
  LodDag dag = built.dag;
  measure(built.mesh, tier, dag);
  return dag;
}

TEST(Measure, ChangesErrorsAlone) {
  const Built built = build(lab::make_rock(12));
  for (const ErrorTier tier : {ErrorTier::kQem, ErrorTier::kMeasured, ErrorTier::kCertified}) {
    const LodDag dag = measured(built, tier);
    EXPECT_EQ(dag.vertex_position, built.dag.vertex_position);
    EXPECT_EQ(dag.vertex_attributes, built.dag.vertex_attributes);
    EXPECT_EQ(dag.triangles, built.dag.triangles);
    ASSERT_EQ(dag.groups.size(), built.dag.groups.size());
    for (std::size_t g = 0; g < dag.groups.size(); ++g) {
      EXPECT_EQ(dag.groups[g].quadric_error, built.dag.groups[g].quadric_error);
      EXPECT_EQ(dag.groups[g].first_cluster, built.dag.groups[g].first_cluster);
      if (tier == ErrorTier::kQem) {
        EXPECT_EQ(dag.groups[g].error, built.dag.groups[g].error);
      }
    }
  }
}

TEST(Measure, SameForAnyThreadCount) {
  const Built built = build(lab::make_rock(20));
  for (const ErrorTier tier : {ErrorTier::kMeasured, ErrorTier::kCertified}) {
    const LodDag first = measured(built, tier);
    LodDag second;
    tbb::task_arena(1).execute([&] { second = measured(built, tier); });
    ASSERT_EQ(first.groups.size(), second.groups.size());
    for (std::size_t g = 0; g < first.groups.size(); ++g) {
      EXPECT_EQ(first.groups[g].error, second.groups[g].error);
      EXPECT_EQ(first.groups[g].normal_deviation, second.groups[g].normal_deviation);
      EXPECT_EQ(first.groups[g].uv_deviation, second.groups[g].uv_deviation);
    }
  }
}

TEST(Measure, AnEmptyDagAndAMeshOfOneClusterHaveNothingToMeasure) {
  LodDag empty;
  measure(PreparedMesh(), ErrorTier::kMeasured, empty);
  EXPECT_TRUE(empty.groups.empty());
  const Built one = build(lab::make_plane(3));
  const LodDag dag = measured(one, ErrorTier::kMeasured);
  ASSERT_EQ(dag.groups.size(), 1U);
  EXPECT_TRUE(dag.groups[0].is_terminal);
  EXPECT_TRUE(std::isinf(dag.groups[0].error));
}

/// The error of every group is the largest of what was found for it, times the margin, and of the errors below it; what
/// was found is stored as it is. So it is known whether an error is a group's own or another's.
TEST(Measure, AnErrorIsTheDeviationWithTheMarginAndTheLargestBelow) {
  for (const ErrorTier tier : {ErrorTier::kMeasured, ErrorTier::kCertified}) {
    const double margin = tier == ErrorTier::kMeasured ? kMeasuredMargin : 1.0;
    for (const scene::Primitive& shape :
         {lab::make_rock(9), lab::make_loose_pieces(test::kIsSanitized ? 300 : 600)}) {
      const Built built = build(shape);
      const LodDag dag = measured(built, tier);
      std::size_t replaced = 0;
      for (const DagGroup& group : dag.groups) {
        if (group.is_terminal) continue;
        ++replaced;
        double expected = std::max(built.mesh.level0_deviation, margin * group.deviation);
        for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
          if (!dag.clusters[c].own_group.is_valid()) continue;
          expected = std::max(expected, dag.groups[dag.clusters[c].own_group.value].error);
        }
        EXPECT_EQ(group.error, expected);
      }
      EXPECT_GE(replaced, 2U);
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
