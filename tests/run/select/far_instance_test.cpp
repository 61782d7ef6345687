// SPDX-License-Identifier: GPL-3.0-or-later
// The far instance's shortcut in the floats as they are: where its bound passes, no group but the terminal one fails.
#include "run/select/far_instance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "run/select/random_dag.h"

namespace meshlode::run {
namespace {

using test::RandomSource;
using test::TransformKind;

bool passes(const MetricView& view, const StoredBound& b) {
  return metric_passes(view, b.center[0], b.center[1], b.center[2], b.radius, b.error);
}

std::vector<float> errors_of(const SelectTables& tables) {
  std::vector<float> out;
  for (const format::GroupRecord& group : tables.groups) out.push_back(group.error);
  return out;
}

test::TestTables make_tables(RandomSource& random, const test::RandomDagOptions& options) {
  const test::RandomDag dag = test::make_random_dag(random, options);
  test::TestTables tables;
  tables.add_mesh(dag.dag, builder::build_hierarchy(dag.dag, dag.mesh),
                  random.chance(0.5) ? Vec3d(0.0) : random.in_cube(1e3));
  return tables;
}

/// Cameras at which the far bound is within a few ulp of passing, behind one of the groups whose error it carries:
/// there that group is nearer than anywhere else.
struct Found {
  std::uint64_t cameras = 0, passing = 0, violations = 0;
};
Found search(std::uint64_t seed, std::uint32_t meshes, bool is_grown) {
  constexpr std::array kKinds{TransformKind::kIdentity, TransformKind::kRigid, TransformKind::kMirrored,
                              TransformKind::kNonUniform, TransformKind::kSheared};
  RandomSource random(seed);
  Found out;
  for (std::uint32_t m = 0; m < meshes; ++m) {
    test::RandomDagOptions options;
    options.leaf_clusters = 4 + random.below(60);
    options.stuck_chance = 0.0;
    const test::TestTables owned = make_tables(random, options);
    const SelectTables tables = owned.view();
    const std::vector<float> errors = errors_of(tables);
    FarBound far = find_far_bound(tables, tables.meshes[0], errors);
    if (far.only_root == format::kNone) continue;
    const float grown = far.bound.error;
    float coarsest = 0.0F;
    const format::GroupRecord* coarse = nullptr;
    for (const format::GroupRecord& group : tables.groups) {
      if (group.error >= format::kInfiniteError) continue;
      EXPECT_TRUE(is_nested(far.bound, bound_of(group))) << "seed " << seed << " mesh " << m;
      if (group.error > coarsest) coarse = &group;
      coarsest = std::max(coarsest, group.error);
    }
    if (coarse == nullptr) continue;
    if (!is_grown) far.bound.error = coarsest;
    const double reach = mesh_reach(tables, tables.meshes[0]);
    for (int i = 0; i < 400; ++i) {
      const TransformKind kind = kKinds[random.below(5)];
      format::InstanceRecord instance =
          test::make_random_instance(random, kind, random.chance(0.3) ? 1e3 * reach : reach);
      const double* row = instance.transform;
      const auto to_world = [&](const float* c) {
        Vec3d w;
        for (int k = 0; k < 3; ++k) {
          double sum = row[4 * k + 3];
          for (int axis = 0; axis < 3; ++axis) sum += row[4 * k + axis] * (c[axis] + tables.meshes[0].origin[axis]);
          w[k] = sum;
        }
        return w;
      };
      const Vec3d root = to_world(far.bound.center), group = to_world(coarse->center);
      const double apart = glm::length(group - root);
      const Vec3d towards = apart > 0.0 && random.chance(0.8) ? (group - root) / apart : random.direction();
      Camera camera;
      camera.fovy = random.between(0.1, 2.0);
      camera.height = 100 + random.below(3000);
      camera.near_distance = 1e-9 * reach * instance.scale;
      const double pixel_error = random.log_between(0.1, 10.0);
      const double k = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
      const double growth = 1.0 + 0x1p-20;
      const double window = random.chance(0.5) ? 3e-7 : 2e-5;  // between the errors as stored and as grown, too
      const double distance = instance.scale * growth *
                              (static_cast<double>(random.chance(0.5) ? grown : coarsest) * k / pixel_error +
                               static_cast<double>(far.bound.radius)) *
                              (1.0 + random.between(-window, window));
      camera.eye = root + towards * distance;
      camera.target = root;
      const MetricView view = make_metric_view(camera, pixel_error, instance, tables.meshes[0], reach);
      ++out.cameras;
      if (!passes(view, far.bound)) continue;
      ++out.passing;
      bool all = true;
      for (const format::GroupRecord& g : tables.groups) {
        all = all && (g.error >= format::kInfiniteError || passes(view, bound_of(g)));
      }
      out.violations += all ? 0 : 1;
    }
  }
  return out;
}

TEST(FarInstance, WhereItsBoundPassesEveryGroupButTheRootPasses) {
  const Found found = search(21, 600, true);
  EXPECT_EQ(found.violations, 0U) << "seed 21";
  EXPECT_GT(found.cameras, 100000U);
  EXPECT_GT(found.passing, found.cameras / 5) << "cameras lie on both sides of the threshold";
  EXPECT_LT(found.passing, found.cameras / 5 * 4);
}

/// The largest error as it is stored is no bound: without the growth the search finds cameras that tell.
TEST(FarInstance, WithoutTheGrowthTheSearchFindsCamerasThatDisagree) {
  EXPECT_GT(search(22, 300, false).violations, 0U) << "seed 22";
}

TEST(FarInstance, NeedsExactlyOneTerminalGroup) {
  RandomSource random(23);
  test::RandomDagOptions options;
  options.leaf_clusters = 40;
  options.stuck_chance = 0.0;
  const test::TestTables owned = make_tables(random, options);
  const SelectTables tables = owned.view();
  std::vector<float> errors = errors_of(tables);
  const FarBound one = find_far_bound(tables, tables.meshes[0], errors);
  ASSERT_NE(one.only_root, format::kNone);
  EXPECT_EQ(errors[one.only_root], format::kInfiniteError);
  errors[one.only_root == 0 ? 1 : 0] = format::kInfiniteError;  // an attribute bound forbids another
  EXPECT_EQ(find_far_bound(tables, tables.meshes[0], errors).only_root, format::kNone);
  format::MeshRecord empty{};
  EXPECT_EQ(find_far_bound(tables, empty, errors).only_root, format::kNone);
}

TEST(FarInstance, ErrorsGrowLikeThoseOfInnerNodes) {
  for (const float error : {0.0F, 0x1p-100F, 1e-6F, 1.0F, 0x1p120F, 3e38F}) {
    EXPECT_TRUE(is_error_nested(coarser_error(error), error)) << error;
    EXPECT_EQ(coarser_error(error) == 0.0F, error == 0.0F);
    EXPECT_LE(static_cast<double>(coarser_error(error)), static_cast<double>(error) * (1.0 + 0x1.1p-18)) << error;
  }
  EXPECT_EQ(coarser_error(std::nextafter(format::kInfiniteError, 0.0F)), format::kInfiniteError);
}

}  // namespace
}  // namespace meshlode::run
