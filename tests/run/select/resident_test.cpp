// SPDX-License-Identifier: GPL-3.0-or-later
// The frontier rule against its own words, path by path, over random DAGs, instances, cameras and residencies.
#include "run/select/resident.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "run/select/allocation_count.h"
#include "run/select/residency.h"

namespace meshlode::run {
namespace {

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
