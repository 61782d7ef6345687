// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/measure.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "base/random.h"
#include "builder/encode/attribute_steps.h"
#include "built.h"
#include "lab/samples/samples.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

using format::ErrorTier;
using test::build;
using test::Built;

LodDag measured(const Built& built, ErrorTier tier) {
  LodDag dag = built.dag;
  EXPECT_TRUE(measure(built.mesh, tier, dag));
  return dag;
}

double as_stored(double quadric_error) {
  return std::isinf(quadric_error) ? quadric_error : double{static_cast<float>(quadric_error)};
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
      EXPECT_EQ(dag.groups[g].quadric_error, as_stored(built.dag.groups[g].quadric_error));
      EXPECT_EQ(dag.groups[g].first_cluster, built.dag.groups[g].first_cluster);
      if (tier == ErrorTier::kQem) {
        EXPECT_EQ(dag.groups[g].error, as_stored(built.dag.groups[g].error));
      }
    }
  }
}

// That nothing was measured is said of all groups of a mesh or of none (L312).
TEST(Measure, TextureCoordinatesAsLargeAsFloatsHaveAFiniteDeviation) {
  scene::Primitive shape = lab::make_rock(12);
  for (std::size_t v = 0; v < shape.uvs[0].size(); ++v) shape.uvs[0][v].x = v % 2 == 0 ? 3e38F : -3e38F;
  const LodDag dag = measured(build(shape), ErrorTier::kMeasured);
  double largest = 0.0;
  for (const DagGroup& group : dag.groups) {
    if (!group.is_terminal) largest = std::max(largest, group.uv_deviation);
  }
  EXPECT_GT(largest, 1e38);
  EXPECT_LT(largest, double{format::kInfiniteError});
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

/// Vertices and triangles of each cluster in another order, triangles turned.
void shuffle(std::size_t stride, SplitMix64& random, LodDag& dag) {
  const auto shuffled = [&](std::uint32_t count) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    for (std::uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    return order;
  };
  const LodDag old = dag;
  for (const DagCluster& cluster : old.clusters) {
    const std::vector<std::uint32_t> to = shuffled(cluster.vertex_count), triangle = shuffled(cluster.triangle_count);
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const std::size_t from = cluster.first_vertex + v, there = cluster.first_vertex + to[v];
      dag.vertex_position[there] = old.vertex_position[from];
      std::copy_n(old.vertex_attributes.data() + from * stride, stride, dag.vertex_attributes.data() + there * stride);
    }
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      const std::size_t turn = random.below(3);
      dag.triangle_material[cluster.first_triangle + triangle[t]] = old.triangle_material[cluster.first_triangle + t];
      for (std::size_t k = 0; k < 3; ++k) {
        dag.triangles[cluster.first_triangle + triangle[t]][(k + turn) % 3] =
            static_cast<std::uint8_t>(to[old.triangles[cluster.first_triangle + t][k]]);
      }
    }
  }
}

TEST(Measure, SameForAnyOrderWithinClusters) {
  SplitMix64 random(20261128);
  const scene::SourceMesh mixed = test::in_two_materials(
      lab::make_rock(16), [](std::size_t triangle, const Vec3d&) { return triangle / 7 % 3 == 0; });
  // A scale so coarse that vertices of one place become equal.
  for (const double normal_error : {0.1, 20.0}) {
    for (const scene::SourceMesh& source :
         {lab::as_mesh(lab::make_rock(16)), lab::as_mesh(lab::make_loose_pieces(300)), mixed}) {
      Built built = build(source);
      snap_attributes(built.mesh.layout, {.normal_error = normal_error}, built.dag);
      for (const ErrorTier tier : {ErrorTier::kMeasured, ErrorTier::kCertified}) {
        const LodDag first = measured(built, tier);
        Built other = built;
        shuffle(built.mesh.layout.stride(), random, other.dag);
        const LodDag second = measured(other, tier);
        ASSERT_EQ(first.groups.size(), second.groups.size());
        for (std::size_t g = 0; g < first.groups.size(); ++g) {
          EXPECT_EQ(first.groups[g].error, second.groups[g].error);
          EXPECT_EQ(first.groups[g].deviation, second.groups[g].deviation);
          EXPECT_EQ(first.groups[g].normal_deviation, second.groups[g].normal_deviation);
          EXPECT_EQ(first.groups[g].uv_deviation, second.groups[g].uv_deviation);
        }
        EXPECT_EQ(second.triangles, other.dag.triangles);
        EXPECT_EQ(second.triangle_material, other.dag.triangle_material);
      }
    }
  }
}

/// A corner of one triangle elsewhere on the grid, one triangle less, another one twice.
TEST(Measure, RefusesAnotherSource) {
  const Built built = build(lab::make_rock(9));
  const auto code_of = [&](const PreparedMesh& mesh) {
    LodDag dag = built.dag;
    const Status status = measure(mesh, ErrorTier::kMeasured, dag);
    return status ? ErrorCode{} : status.error().code;
  };
  EXPECT_EQ(code_of(built.mesh), ErrorCode{});
  PreparedMesh moved = built.mesh, fewer = built.mesh, twice = built.mesh;
  moved.exact_on_grid.back().x += 1;
  fewer.exact_triangles.pop_back();
  twice.exact_triangles.back() = twice.exact_triangles.front();
  EXPECT_EQ(code_of(moved), ErrorCode::kCheckFailed);
  EXPECT_EQ(code_of(fewer), ErrorCode::kCheckFailed);
  EXPECT_EQ(code_of(twice), ErrorCode::kCheckFailed);
}

TEST(Measure, AnEmptyDagAndAMeshOfOneClusterHaveNothingToMeasure) {
  LodDag empty;
  EXPECT_TRUE(measure(PreparedMesh(), ErrorTier::kMeasured, empty));
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
         {lab::make_rock(9), lab::make_loose_pieces(meshlode::test::kIsSanitized ? 300 : 600)}) {
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
