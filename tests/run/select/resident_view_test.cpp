// SPDX-License-Identifier: GPL-3.0-or-later
// What a view asks for: the frustum in world space, priorities by doubles, and that what is asked for suffices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "run/select/residency.h"

namespace meshlode::run {
namespace {

TEST(Resident, AFrustumTakesAwayWhatIsOutsideAndNothingElse) {
  RandomSource random(304);
  std::size_t all_count = 0, inside_count = 0;
  for (int scene = 0; scene < 8; ++scene) {
    TestTables owned = random_tables(random, 2, 80);
    const std::uint32_t pages = deal_pages(random, owned, 4);
    const SelectTables tables = owned.view();
    Selected select(tables);
    for (int n = 0; n < 100; ++n) {
      Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(6)]);
      camera.target = camera.eye + random.direction();
      camera.width = 1 + random.below(4000);
      const double t = random.log_between(1e-3, 1e3);
      const Residency residency = random_residency(random, owned, pages, random.unit(), true);
      const Frustum frustum = frustum_of(camera);
      std::vector<ClusterInstance> expected;
      for (const ClusterInstance& item : select(tables, {camera, t, residency.words, nullptr})) {
        const format::InstanceRecord& instance = owned.instances[item.instance.value];
        const format::MeshRecord& mesh = owned.meshes[instance.mesh];
        ++all_count;
        const format::CullSphere sphere = format::cull_sphere(mesh, owned.clusters[item.cluster.value]);
        if (!is_sphere_outside(frustum, instance, mesh, sphere)) expected.push_back(item);
      }
      inside_count += expected.size();
      ASSERT_EQ(copy_of(select(tables, {camera, t, residency.words, &frustum})), expected)
          << "scene " << scene << ", " << n;
      Frustum scaled = frustum;  // planes may have any length: squares of these are 0 and infinite
      for (std::size_t k = 0; k < scaled.planes.size(); ++k) {
        for (double& x : scaled.planes[k]) x = std::ldexp(x, k % 2 == 0 ? -700 : 700);
      }
      ASSERT_EQ(copy_of(select(tables, {camera, t, residency.words, &scaled})), expected)
          << "scene " << scene << ", " << n;
    }
  }
  EXPECT_GT(inside_count, all_count / 100);
  EXPECT_LT(inside_count, all_count * 9 / 10);
}

// By doubles and from the camera: between what the errors come to at distances a little above and below.
TEST(Resident, PrioritiesAreProjectedErrorsClosedTowardsTheCoarserSide) {
  RandomSource random(305);
  for (int scene = 0; scene < 10; ++scene) {
    TestTables owned = random_tables(random, 2, 40);
    const std::uint32_t pages = deal_pages(random, owned, 3);
    const SelectTables tables = owned.view();
    Selected select(tables);
    for (int n = 0; n < 60; ++n) {
      Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(6)]);
      camera.width = camera.height;
      if (n % 2 == 0) camera.target = camera.eye + random.direction();
      const double t = n % 10 == 0 ? 0.0 : random.log_between(1e-3, 1e3);
      const Frustum frustum = frustum_of(camera);
      const bool is_culled = n % 3 != 0;
      std::vector<double> low(pages, 0.0), high(pages, 0.0);
      for (const format::InstanceRecord& instance : owned.instances) {
        const format::MeshRecord& mesh = owned.meshes[instance.mesh];
        const MetricView view = make_metric_view(camera, t, instance, mesh, mesh_reach(tables, mesh));
        std::vector<double> low_of(owned.groups.size(), 0.0), high_of(owned.groups.size(), 0.0);
        for (std::uint32_t g = mesh.first_group + mesh.group_count; g-- > mesh.first_group;) {
          const format::GroupRecord& group = owned.groups[g];
          bool is_wanted = false;
          for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
            if (owned.clusters[c].coarser_group != g && owned.clusters[c].own_group != g) continue;
            const format::CullSphere sphere = format::cull_sphere(mesh, owned.clusters[c]);
            is_wanted = is_wanted || !is_culled || !is_sphere_outside(frustum, instance, mesh, sphere);
          }
          if ((group.flags & format::kGroupTerminal) == 0 && fails(view, group) && is_wanted) {
            const double* m = instance.transform;
            double d2 = 0.0, size = 0.0;
            for (int row = 0; row < 3; ++row) {
              const double eye[3] = {camera.eye.x, camera.eye.y, camera.eye.z};
              double x = m[4 * row + 3] - eye[row];
              for (int a = 0; a < 3; ++a) x += m[4 * row + a] * (mesh.origin[a] + group.center[a]);
              d2 += x * x;
            }
            for (int a = 0; a < 3; ++a) size += std::abs(group.center[a]);
            const double slack = 1e-5 * (std::sqrt(d2) + instance.scale * (group.radius + size));
            const double near = std::sqrt(d2) - group.radius * instance.scale;
            const double k = camera.is_orthographic ? camera.height / camera.ortho_height
                                                    : camera.height / (2.0 * std::tan(0.5 * camera.fovy));
            const auto error_at = [&](double distance) {
              const double divisor = camera.is_orthographic ? 1.0 : std::max(distance, camera.near_distance);
              return group.error * instance.scale * k / divisor;
            };
            low_of[g] = std::max(low_of[g], error_at(near + slack));
            high_of[g] = std::max(high_of[g], error_at(near - slack));
          }
          for (const format::ClusterRecord& c : owned.clusters) {
            if (c.own_group != g) continue;
            low_of[c.coarser_group] = std::max(low_of[c.coarser_group], low_of[g]);
            high_of[c.coarser_group] = std::max(high_of[c.coarser_group], high_of[g]);
          }
          low[group.page] = std::max(low[group.page], low_of[g]);
          high[group.page] = std::max(high[group.page], high_of[g]);
        }
      }
      const Residency residency = random_residency(random, owned, pages, random.unit(), false);
      (void)select(tables, {camera, t, residency.words, is_culled ? &frustum : nullptr});
      const std::span<const float> priorities = select.selector.page_priorities();
      std::set<std::uint32_t> roots;
      for (const format::GroupRecord& group : owned.groups) {
        if ((group.flags & format::kGroupTerminal) != 0) roots.insert(group.page);
      }
      std::set<std::uint32_t> missing;
      for (std::uint32_t p = 0; p < pages; ++p) {
        if (priorities[p] > 0.0F && !residency.has(p)) missing.insert(p);
        if (roots.contains(p)) {
          ASSERT_EQ(priorities[p], format::kInfiniteError);
        } else if (high[p] == 0.0) {
          ASSERT_EQ(priorities[p], 0.0F) << p;
        } else {
          ASSERT_GE(priorities[p], low[p] * (1.0 - 1e-4)) << "scene " << scene << ", " << n << ", page " << p;
          ASSERT_LE(priorities[p], high[p] * (1.0 + 1e-4)) << "scene " << scene << ", " << n << ", page " << p;
        }
      }
      const std::span<const PageRequest> requests = select.selector.requests();
      ASSERT_EQ(requests.size(), missing.size());
      for (std::size_t r = 0; r < requests.size(); ++r) {
        ASSERT_TRUE(missing.contains(requests[r].page));
        ASSERT_EQ(requests[r].priority, priorities[requests[r].page]);
        if (r == 0) continue;
        const PageRequest &a = requests[r - 1], &b = requests[r];
        ASSERT_TRUE(a.priority > b.priority || (a.priority == b.priority && a.page < b.page));
      }
    }
  }
}

// What is asked for is enough: with it, the next answer is the whole cut of the frustum, and asks for nothing.
TEST(Resident, WhatIsRequestedSuffices) {
  RandomSource random(306);
  for (int scene = 0; scene < 10; ++scene) {
    TestTables owned = random_tables(random, 2, 60);
    const std::uint32_t pages = deal_pages(random, owned, 3);
    const SelectTables tables = owned.view();
    Selected select(tables);
    for (int n = 0; n < 60; ++n) {
      const Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(6)]);
      const double t = random.log_between(1e-3, 1e3);
      const Frustum frustum = frustum_of(camera);
      Residency residency = random_residency(random, owned, pages, random.unit(), n % 2 == 0);
      (void)select(tables, {camera, t, residency.words, &frustum});
      for (const PageRequest& request : select.selector.requests()) residency.add(request.page);
      const auto items = copy_of(select(tables, {camera, t, residency.words, &frustum}));
      ASSERT_TRUE(select.selector.requests().empty());
      ASSERT_EQ(items, select_bvh(tables, camera, t, nullptr, {}, &frustum)) << "scene " << scene << ", " << n;
    }
  }
}

}  // namespace
}  // namespace meshlode::run
