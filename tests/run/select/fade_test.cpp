// SPDX-License-Identifier: GPL-3.0-or-later
// Fading: on every path from level 0 to a root the weights sum to one, and each step is a cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "run/select/fade.h"
#include "run/select/random_dag.h"
#include "run/select/select.h"

namespace meshlode::run {
namespace {

using test::RandomSource;
using test::TestTables;
using test::TransformKind;

std::uint32_t steps_of(const MetricView& view, const format::GroupRecord& group) {
  return fade_steps(view, group.center[0], group.center[1], group.center[2], group.radius, group.error);
}

bool passes_at(const MetricView& view, const format::GroupRecord& group, std::uint32_t step) {
  return metric_passes(fade_view(view, step), group.center[0], group.center[1], group.center[2], group.radius,
                       group.error);
}

TestTables make_tables(RandomSource& random) {
  TestTables tables;
  test::RandomDagOptions options;
  options.leaf_clusters = 200;
  const test::RandomDag made = test::make_random_dag(random, options);
  tables.add_mesh(made.dag, builder::build_hierarchy(made.dag, made.mesh), random.in_cube(1e3));
  for (const TransformKind kind : {TransformKind::kIdentity, TransformKind::kRigid, TransformKind::kMirrored,
                                   TransformKind::kNonUniform, TransformKind::kSheared}) {
    tables.instances.push_back(test::make_random_instance(random, kind, random.chance(0.5) ? 0.0 : 100.0));
  }
  return tables;
}

TEST(Fade, WeightsOfMembersAndReplacementsSumToOneForRandomCameras) {
  RandomSource random(41);
  std::uint64_t fading = 0, paths = 0;
  for (int round = 0; round < 20; ++round) {
    const TestTables owned = make_tables(random);
    const SelectTables tables = owned.view();
    const format::MeshRecord& mesh = tables.meshes[0];
    std::vector<std::vector<std::uint32_t>> made(mesh.group_count);
    for (std::uint32_t c = 0; c < mesh.cluster_count; ++c) {
      const std::uint32_t own = tables.clusters[c].own_group;
      if (own != format::kNone) made[own].push_back(c);
    }
    for (const format::InstanceRecord& instance : tables.instances) {
      const Camera camera = test::make_random_camera(random, tables, instance);
      const double pixel_error = random.log_between(1e-3, 1e4);
      const MetricView view = make_metric_view(camera, pixel_error, instance, mesh, mesh_reach(tables, mesh));
      std::vector<std::uint32_t> steps;
      for (std::uint32_t g = 0; g < mesh.group_count; ++g) {
        steps.push_back(steps_of(view, tables.groups[g]));
        for (std::uint32_t step = 0; step < FADE_STEPS; ++step) {
          ASSERT_EQ(passes_at(view, tables.groups[g], step), step < steps.back());
        }
      }
      for (std::uint32_t c = 0; c < mesh.cluster_count; ++c) {
        if (tables.clusters[c].own_group != format::kNone) continue;
        std::uint32_t drawn = 0, at = c;
        float weight = 0.0F;
        std::vector<std::uint32_t> of_step(FADE_STEPS, 0);
        while (true) {
          const std::uint32_t own = tables.clusters[at].own_group;
          const std::uint32_t own_steps = own == format::kNone ? FADE_STEPS : steps[own];
          const std::uint32_t coarser_steps = steps[tables.clusters[at].coarser_group];
          ASSERT_GE(own_steps, coarser_steps) << "a coarser group passes where a finer one does not";
          const float own_weight = fade_weight(own_steps, coarser_steps);
          weight += own_weight;
          fading += own_weight > 0.0F && own_weight < 1.0F ? 1 : 0;
          for (std::uint32_t step = 0; step < FADE_STEPS; ++step) {
            if (fade_is_drawn(own_steps, coarser_steps, step)) ++of_step[step], ++drawn;
          }
          const auto& coarser = made[tables.clusters[at].coarser_group];
          if (coarser.empty()) break;
          at = coarser[random.below(static_cast<std::uint32_t>(coarser.size()))];
        }
        ++paths;
        ASSERT_EQ(weight, 1.0F);
        ASSERT_EQ(drawn, FADE_STEPS);
        ASSERT_EQ(std::count(of_step.begin(), of_step.end(), 1U), FADE_STEPS) << "a pixel shows one whole cut";
      }
    }
  }
  EXPECT_GT(fading, paths / 50) << "nothing was in between: nothing was tried";
}

TEST(Fade, TheFirstStepIsTheRuleItself) {
  RandomSource random(42);
  const TestTables owned = make_tables(random);
  const SelectTables tables = owned.view();
  for (int round = 0; round < 50; ++round) {
    const Camera camera = test::make_random_camera(random, tables, tables.instances[1]);
    const double pixel_error = random.log_between(1e-3, 1e4);
    std::vector<ClusterInstance> drawn;
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
      const MetricView view = make_metric_view(camera, pixel_error, tables.instances[i], tables.meshes[0],
                                               mesh_reach(tables, tables.meshes[0]));
      for (std::uint32_t c = 0; c < tables.clusters.size(); ++c) {
        const format::ClusterRecord& cluster = tables.clusters[c];
        const std::uint32_t own =
            cluster.own_group == format::kNone ? FADE_STEPS : steps_of(view, tables.groups[cluster.own_group]);
        if (fade_is_drawn(own, steps_of(view, tables.groups[cluster.coarser_group]), 0)) {
          drawn.push_back({InstanceId(i), ClusterId(c)});
        }
      }
    }
    EXPECT_EQ(drawn, select_flat(tables, camera, pixel_error));
  }
}

TEST(Fade, GoesFromThePixelErrorToNearlyHalfOfIt) {
  // A group whose error covers x pixels where t are allowed passes at the steps whose threshold is not below x.
  Camera camera;
  camera.eye = {0.0, 0.0, 100.0};
  camera.height = 1000;
  format::InstanceRecord instance{};
  for (int k = 0; k < 3; ++k) instance.transform[5 * k] = 1.0;
  instance.scale = 1.0;
  const MetricView view = make_metric_view(camera, 1.0, instance, format::MeshRecord{}, 2.0);
  const double pixels_a_unit = camera.height / (2.0 * std::tan(0.5 * camera.fovy)) / 100.0;
  std::uint32_t before = FADE_STEPS;
  for (double pixels = 0.4; pixels < 1.2; pixels += 0.005) {
    const std::uint32_t steps = fade_steps(view, 0.0F, 0.0F, 0.0F, 0.0F, static_cast<float>(pixels / pixels_a_unit));
    EXPECT_LE(steps, before);
    if (pixels < 0.51) {
      EXPECT_EQ(steps, FADE_STEPS) << pixels;
    }
    if (pixels > 1.01) {
      EXPECT_EQ(steps, 0U) << pixels;
    }
    before = steps;
  }
  EXPECT_EQ(fade_steps(view, 0.0F, 0.0F, 0.0F, 0.0F, format::kInfiniteError), 0U) << "a root's coarser group";
}

}  // namespace
}  // namespace meshlode::run
