// SPDX-License-Identifier: GPL-3.0-or-later
// The frontier rule against its own words, path by path, over random DAGs, instances, cameras and residencies.
#include "run/select/resident.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "run/select/allocation_count.h"
#include "run/select/random_dag.h"
#include "run/select/select.h"

namespace meshlode::run {
namespace {

using test::RandomSource;
using test::TestTables;
using test::TransformKind;

/// Groups in pages of 1 to `most` each, of one mesh.
std::uint32_t deal_pages(RandomSource& random, TestTables& tables, std::uint32_t most) {
  std::uint32_t page = 0, left = 0;
  for (std::size_t g = 0; g < tables.groups.size(); ++g) {
    if (g > 0 && (left == 0 || tables.groups[g].mesh != tables.groups[g - 1].mesh)) {
      ++page;
      left = 0;
    }
    if (left == 0) left = 1 + random.below(most);
    tables.groups[g].page = page;
    --left;
  }
  return page + 1;
}

TestTables random_tables(RandomSource& random, std::uint32_t meshes, std::uint32_t leaf_clusters) {
  TestTables tables;
  for (std::uint32_t mesh = 0; mesh < meshes; ++mesh) {
    test::RandomDagOptions options;
    options.leaf_clusters = leaf_clusters + mesh;
    const test::RandomDag made = test::make_random_dag(random, options);
    tables.add_mesh(made.dag, builder::build_hierarchy(made.dag, made.mesh), random.in_cube(10.0));
    for (const TransformKind kind : {TransformKind::kIdentity, TransformKind::kMirrored, TransformKind::kSheared}) {
      tables.instances.push_back(test::make_random_instance(random, kind, 10.0));
      tables.instances.back().mesh = mesh;
    }
  }
  return tables;
}

struct Residency {
  std::vector<std::uint32_t> words;
  explicit Residency(std::uint32_t pages) : words((pages + 31) / 32) {}
  [[nodiscard]] bool has(std::uint32_t page) const { return (words[page / 32] >> page % 32 & 1U) != 0; }
  void add(std::uint32_t page) { words[page / 32] |= 1U << page % 32; }
};

Residency random_residency(RandomSource& random, const TestTables& tables, std::uint32_t pages, double chance,
                           bool has_roots) {
  Residency out(pages);
  for (std::uint32_t p = 0; p < pages; ++p) {
    if (random.chance(chance)) out.add(p);
  }
  for (const format::GroupRecord& group : tables.groups) {
    if (has_roots && (group.flags & format::kGroupTerminal) != 0) out.add(group.page);
  }
  return out;
}

bool fails(const MetricView& view, const format::GroupRecord& group) {
  return !metric_passes(view, group.center[0], group.center[1], group.center[2], group.radius, group.error);
}

/// What the words of the rule say of one instance, group by group.
std::vector<bool> reached_of(const TestTables& tables, const MetricView& view, const format::MeshRecord& mesh,
                             const Residency& residency) {
  std::vector<bool> reached(tables.groups.size());
  for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {  // coarse to fine
    const format::GroupRecord& group = tables.groups[g];
    bool answer = fails(view, group) && residency.has(group.page);
    for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
      const format::ClusterRecord& cluster = tables.clusters[c];
      if (cluster.own_group == g && !reached[cluster.coarser_group]) answer = false;
    }
    reached[g] = answer;
  }
  return reached;
}

std::vector<ClusterInstance> cut_of(const TestTables& tables, std::uint32_t instance,
                                    const std::vector<bool>& reached) {
  std::vector<ClusterInstance> out;
  const format::MeshRecord& mesh = tables.meshes[tables.instances[instance].mesh];
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    const format::ClusterRecord& cluster = tables.clusters[c];
    if (!reached[cluster.coarser_group]) continue;
    if (cluster.own_group != format::kNone && reached[cluster.own_group]) continue;
    out.push_back({InstanceId(instance), ClusterId(c)});
  }
  return out;
}

/// The least and the largest number of drawn clusters on a path from level 0 to a root, over all paths of a mesh.
struct Coverage {
  std::uint32_t least, most;
};
Coverage coverage_of(const TestTables& tables, const format::MeshRecord& mesh, const std::vector<std::uint8_t>& drawn) {
  // Of the paths from a group's replacements up; 0 of a group that nothing replaces.
  std::vector<Coverage> above(tables.groups.size(), {UINT32_MAX, 0});
  Coverage all{UINT32_MAX, 0};
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {  // coarse to fine
    const format::ClusterRecord& cluster = tables.clusters[c];
    Coverage from = above[cluster.coarser_group];
    if (from.least == UINT32_MAX) from = {0, 0};
    Coverage& to = cluster.own_group == format::kNone ? all : above[cluster.own_group];
    to.least = std::min(to.least, from.least + drawn[c]);
    to.most = std::max(to.most, from.most + drawn[c]);
  }
  return all;
}

class Selected {
 public:
  explicit Selected(const SelectTables& tables) : selector(tables), items_(1) {}
  std::span<const ClusterInstance> operator()(const SelectTables& tables, const ResidentQuery& query) {
    std::size_t count = selector.select(tables, query, items_);
    if (count > items_.size()) {
      items_.resize(count);
      count = selector.select(tables, query, items_);
    }
    return std::span(items_).first(count);
  }
  ResidentSelector selector;

 private:
  std::vector<ClusterInstance> items_;
};

std::vector<ClusterInstance> copy_of(std::span<const ClusterInstance> items) {
  return {items.begin(), items.end()};
}

TEST(Resident, DrawsWhatTheWordsOfTheRuleSay) {
  RandomSource random(301);
  for (int scene = 0; scene < 12; ++scene) {
    TestTables owned = random_tables(random, 2, scene % 2 == 0 ? 8 : 60);
    const std::uint32_t pages = deal_pages(random, owned, 1 + random.below(5));
    const SelectTables tables = owned.view();
    Selected select(tables);
    for (int n = 0; n < 60; ++n) {
      const Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(6)]);
      const double t = n % 10 == 0 ? 0.0 : random.log_between(1e-3, 1e4);
      const Residency residency = random_residency(random, owned, pages, random.unit(), n % 3 != 0);
      std::vector<ClusterInstance> expected;
      for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        const format::MeshRecord& mesh = owned.meshes[owned.instances[i].mesh];
        const MetricView view = make_metric_view(camera, t, owned.instances[i], mesh, mesh_reach(tables, mesh));
        const auto cut = cut_of(owned, i, reached_of(owned, view, mesh, residency));
        expected.insert(expected.end(), cut.begin(), cut.end());
      }
      ASSERT_EQ(copy_of(select(tables, {camera, t, residency.words, nullptr})), expected)
          << "scene " << scene << ", " << n;
    }
  }
}

TEST(Resident, WithAllPagesIsTheCutOfTheView) {
  RandomSource random(302);
  for (int scene = 0; scene < 6; ++scene) {
    TestTables owned = random_tables(random, 2, scene % 2 == 0 ? 10 : 150);
    const std::uint32_t pages = deal_pages(random, owned, 6);
    const SelectTables tables = owned.view();
    Selected select(tables);
    const Residency all = random_residency(random, owned, pages, 1.0, true);
    for (int n = 0; n < 200; ++n) {
      const Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(6)]);
      const double t = n % 10 == 0 ? 0.0 : random.log_between(1e-3, 1e4);
      ASSERT_EQ(copy_of(select(tables, {camera, t, all.words, nullptr})), select_bvh(tables, camera, t)) << n;
      ASSERT_TRUE(select.selector.requests().empty());
      const Frustum frustum = frustum_of(camera);
      ASSERT_EQ(copy_of(select(tables, {camera, t, all.words, &frustum})),
                select_bvh(tables, camera, t, nullptr, {}, &frustum))
          << n;
    }
  }
}

// 100,000 residencies: no path is left open or drawn twice, and nothing is drawn that is not there or coarser than it
// has to be. The rule that looks at a group's own page alone opens most of them.
TEST(Resident, CoversEveryPathOnceWhateverIsThere) {
  RandomSource random(303);
  std::uint32_t tried = 0, naive_open = 0;
  for (int scene = 0; scene < 100; ++scene) {
    TestTables owned = random_tables(random, 1, scene % 4 == 3 ? 150 : 20 + random.below(40));
    const std::uint32_t pages = deal_pages(random, owned, 1 + random.below(4));
    const SelectTables tables = owned.view();
    const format::MeshRecord& mesh = owned.meshes[0];
    Selected select(tables);
    std::vector<std::uint8_t> drawn(owned.clusters.size());
    for (int view_number = 0; view_number < 20; ++view_number) {
      const std::uint32_t i = random.below(3);
      const TestTables one{owned.meshes, {owned.instances[i]}, owned.groups, owned.clusters, owned.nodes};
      const SelectTables seen = one.view();
      const Camera camera = test::make_random_camera(random, seen, one.instances[0]);
      const double t = random.log_between(1e-3, 1e1);
      const MetricView view = make_metric_view(camera, t, one.instances[0], mesh, mesh_reach(seen, mesh));
      for (int n = 0; n < 55; ++n) {
        const bool has_roots = n < 50;
        const Residency residency = random_residency(random, one, pages, random.between(0.5, 0.95), has_roots);
        const auto items = select(seen, {camera, t, residency.words, nullptr});
        std::fill(drawn.begin(), drawn.end(), std::uint8_t{0});
        for (const ClusterInstance& item : items) {
          drawn[item.cluster.value] = 1;
          ASSERT_TRUE(residency.has(one.groups[one.clusters[item.cluster.value].coarser_group].page));
        }
        const Coverage coverage = coverage_of(one, mesh, drawn);
        ASSERT_LE(coverage.most, 1U) << "seed 303, scene " << scene << ", view " << view_number << ", " << n;
        if (!has_roots) continue;
        ++tried;
        ASSERT_EQ(coverage.least, 1U) << "seed 303, scene " << scene << ", view " << view_number << ", " << n;
        // As fine as possible: a group that fails and is not reached lacks its page, or one of a coarser group does.
        std::vector<bool> lacks(one.groups.size());
        for (std::uint32_t g = 0; g < mesh.group_count; ++g) lacks[g] = !residency.has(one.groups[g].page);
        for (const format::ClusterRecord& c : one.clusters) {
          if (c.own_group != format::kNone && lacks[c.coarser_group]) lacks[c.own_group] = true;
        }
        for (std::uint32_t c = 0; c < drawn.size(); ++c) {
          const std::uint32_t own = one.clusters[c].own_group;
          ASSERT_FALSE(drawn[c] != 0 && own != format::kNone && fails(view, one.groups[own]) && !lacks[own]) << c;
        }
        for (std::uint32_t c = 0; c < drawn.size(); ++c) {
          const auto is_open = [&](std::uint32_t g) {
            return fails(view, one.groups[g]) && residency.has(one.groups[g].page);
          };
          const format::ClusterRecord& cluster = one.clusters[c];
          drawn[c] =
              is_open(cluster.coarser_group) && (cluster.own_group == format::kNone || !is_open(cluster.own_group));
        }
        const Coverage naive = coverage_of(one, mesh, drawn);
        naive_open += naive.least == 1 && naive.most == 1 ? 0 : 1;
      }
    }
  }
  EXPECT_EQ(tried, 100000U);
  EXPECT_GT(naive_open, tried / 2) << "of " << tried;
  RecordProperty("naive_open", static_cast<int>(naive_open));
  RecordProperty("tried", static_cast<int>(tried));
}

/// In world space, by the words of it.
bool is_sphere_outside(const Frustum& frustum, const format::InstanceRecord& instance, const format::MeshRecord& mesh,
                       const format::CullSphere& sphere) {
  const double* m = instance.transform;
  for (const auto& plane : frustum.planes) {
    double at = plane[3], reach2 = 0.0;
    for (int row = 0; row < 3; ++row) at += plane[row] * m[4 * row + 3];
    for (int axis = 0; axis < 3; ++axis) {
      const double n = plane[0] * m[axis] + plane[1] * m[4 + axis] + plane[2] * m[8 + axis];
      at += n * (mesh.origin[axis] + sphere.center[axis]);
      reach2 += n * n;
    }
    if (at < -sphere.radius * std::sqrt(reach2)) return true;
  }
  return false;
}

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

TEST(Resident, TakesNoMemoryAfterItWasMade) {
  RandomSource random(307);
  TestTables owned = random_tables(random, 3, 150);
  const std::uint32_t pages = deal_pages(random, owned, 4);
  const SelectTables tables = owned.view();
  ResidentSelector selector(tables);
  std::vector<ClusterInstance> items(owned.clusters.size() * owned.instances.size());
  for (int n = 0; n < 300; ++n) {
    const Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(9)]);
    const double t = random.log_between(1e-3, 1e3);
    const Residency residency = random_residency(random, owned, pages, random.unit(), n % 2 == 0);
    const Frustum frustum = frustum_of(camera);
    const std::uint64_t before = test::allocation_count();
    (void)selector.select(tables, {camera, t, residency.words, n % 3 == 0 ? nullptr : &frustum}, items);
    ASSERT_EQ(test::allocation_count(), before) << n;
  }
  const std::uint64_t before = test::allocation_count();
  std::vector<int> counted(1);
  ASSERT_GT(test::allocation_count(), before);  // the count counts
}

TEST(Resident, WithoutGroupsOrPagesNothingIsDrawn) {
  const TestTables none;
  ResidentSelector selector(none.view());
  EXPECT_EQ(selector.select(none.view(), {}, {}), 0U);
  EXPECT_TRUE(selector.requests().empty());
  RandomSource random(308);
  TestTables owned = random_tables(random, 2, 20);
  const std::uint32_t pages = deal_pages(random, owned, 2);
  ResidentSelector two(owned.view());
  EXPECT_EQ(two.select(owned.view(), {}, {}), 0U);
  std::set<std::uint32_t> roots;
  for (const format::GroupRecord& group : owned.groups) {
    if ((group.flags & format::kGroupTerminal) != 0) roots.insert(group.page);
  }
  ASSERT_GE(two.requests().size(), roots.size());
  EXPECT_LE(two.requests().size(), pages);
  for (std::size_t r = 0; r < two.requests().size(); ++r) {
    EXPECT_EQ(r < roots.size(), two.requests()[r].priority == format::kInfiniteError);
  }
}

}  // namespace
}  // namespace meshlode::run
