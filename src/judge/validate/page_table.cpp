// SPDX-License-Identifier: GPL-3.0-or-later
// The page table: partition of groups and clusters, places in the file, dependencies (L201, L202, L213),
// hints (L217).
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "judge/validate/page_rules.h"

namespace meshlode::judge {

namespace {

using format::PageRecord;

bool check_ranges(const FileTables& file, RuleLog& log) {
  std::uint64_t group = 0;
  std::uint64_t cluster = 0;
  std::uint64_t dependency = 0;
  bool sound = true;
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const PageRecord& page = file.pages[p];
    const auto at = [&] { return place("page", p); };
    const bool groups_fit =
        page.first_group == group && page.group_count > 0 && page.group_count <= file.groups.size() - group;
    const bool clusters_fit =
        page.first_cluster == cluster && page.cluster_count > 0 && page.cluster_count <= file.clusters.size() - cluster;
    sound &=
        log.expect(groups_fit, Rule::kL201, at, [&] { return "groups do not follow on " + std::to_string(group); });
    sound &= log.expect(clusters_fit, Rule::kL201, at,
                        [&] { return "clusters do not follow on " + std::to_string(cluster); });
    const bool deps_fit =
        page.first_dependency == dependency && page.dependency_count <= file.page_dependencies.size() - dependency;
    sound &= log.expect(deps_fit, Rule::kL213, at,
                        [&] { return "dependencies do not follow on " + std::to_string(dependency); });
    log.expect(page.reserved == 0, Rule::kL103, at, [] { return std::string("reserved is not zero"); });
    if (!groups_fit || !clusters_fit || !deps_fit) return false;
    std::uint64_t members = 0;
    for (std::uint32_t k = 0; k < page.group_count; ++k) {
      const format::GroupRecord& record = file.groups[page.first_group + k];
      members += record.cluster_count;
      sound &= log.expect(record.page == p, Rule::kL201, at, [&] {
        return place("group", page.first_group + k) + " names page " + std::to_string(record.page);
      });
      sound &= log.expect(record.mesh == file.groups[page.first_group].mesh, Rule::kL201, at,
                          [] { return std::string("holds groups of two meshes"); });
    }
    sound &= log.expect(members == page.cluster_count, Rule::kL201, at, [&] {
      return differs("clusters", std::uint64_t{page.cluster_count}, "members of its groups", members);
    });
    group += page.group_count;
    cluster += page.cluster_count;
    dependency += page.dependency_count;
  }
  sound &= log.expect(
      group == file.groups.size() && cluster == file.clusters.size(), Rule::kL201, [] { return std::string("pages"); },
      [] { return std::string("do not hold every group and cluster"); });
  sound &= log.expect(
      dependency == file.page_dependencies.size(), Rule::kL213, [] { return std::string("PDEP"); },
      [] { return std::string("holds entries that no page names"); });
  return sound;
}

bool check_places(const FileTables& file, RuleLog& log) {
  const std::uint64_t begin = file.page_data.offset;
  const std::uint64_t limit = begin + file.page_data.bytes;
  std::uint64_t next = begin;
  bool sound = true;
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const PageRecord& page = file.pages[p];
    const auto at = [&] { return place("page", p); };
    const std::uint64_t start =
        (next + format::kSectionAlignment - 1) / format::kSectionAlignment * format::kSectionAlignment;
    const bool inside = page.offset == start && start <= limit && page.stored_bytes <= limit - start;
    if (!log.expect(inside, Rule::kL202, at,
                    [] { return std::string("does not follow the page before it inside the section"); }))
      return false;
    for (std::uint64_t i = next; i < page.offset; ++i) {
      if (!log.expect(file.bytes[i] == 0, Rule::kL214, at,
                      [] { return std::string("padding before the page is not zero"); }))
        break;
    }
    next = page.offset + page.stored_bytes;
    sound &= log.expect(static_cast<std::uint32_t>(page.codec) <= 4, Rule::kL102, at,
                        [&] { return "codec " + std::to_string(static_cast<std::uint32_t>(page.codec)); });
  }
  sound &= log.expect(
      next == limit, Rule::kL202, [] { return std::string("section PAGE"); },
      [] { return std::string("does not end with the last page"); });
  return sound;
}

void check_dependencies(const FileTables& file, RuleLog& log) {
  std::vector<std::set<std::uint32_t>> needed(file.pages.size());
  for (const format::ClusterRecord& cluster : file.clusters) {
    if (cluster.own_group == format::kNone) continue;
    const std::uint32_t from = file.groups[cluster.own_group].page;
    const std::uint32_t to = file.groups[cluster.coarser_group].page;
    if (from != to) needed[from].insert(to);
  }
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const PageRecord& page = file.pages[p];
    const auto first = file.page_dependencies.begin() + page.first_dependency;
    log.expect(
        std::equal(needed[p].begin(), needed[p].end(), first, first + page.dependency_count), Rule::kL213,
        [&] { return place("page", p); },
        [&] {
          return differs("dependencies", std::uint64_t{page.dependency_count}, "needed",
                         std::uint64_t{needed[p].size()}) +
                 ", or they differ or are not ascending";
        });
  }
}

void check_hint(const FileTables& file, std::size_t p, RuleLog& log) {
  const format::PageHintRecord& hint = file.page_hints[p];
  const auto at = [&] { return place("PHNT, page", p); };
  log.expect(hint.reserved[0] == 0 && hint.reserved[1] == 0, Rule::kL103, at,
             [] { return std::string("reserved is not zero"); });
  float most = 0.0F, least = format::kInfiniteError;
  bool contains = true;
  for (std::uint32_t k = 0; k < file.pages[p].group_count; ++k) {
    const format::GroupRecord& group = file.groups[file.pages[p].first_group + k];
    most = std::max(most, group.error);
    least = std::min(least, group.error);
    const double x = double{group.center[0]} - double{hint.center[0]};
    const double y = double{group.center[1]} - double{hint.center[1]};
    const double z = double{group.center[2]} - double{hint.center[2]};
    contains &= std::sqrt(x * x + y * y + z * z) + double{group.radius} <= double{hint.radius};
  }
  log.expect(contains || hint.radius == format::kInfiniteError, Rule::kL217, at,
             [] { return std::string("the sphere does not contain those of its groups"); });
  log.expect(hint.largest_error == most, Rule::kL217, at, [&] {
    return differs("largest_error", double{hint.largest_error}, "largest of its groups", double{most});
  });
  log.expect(hint.smallest_error == least, Rule::kL217, at, [&] {
    return differs("smallest_error", double{hint.smallest_error}, "smallest of its groups", double{least});
  });
}

/// \pre check_ranges()
void check_hints(const FileTables& file, RuleLog& log) {
  if (!file.has_page_hints) return;
  const bool is_whole = log.expect(
      file.page_hints.size() == file.pages.size(), Rule::kL217, [] { return std::string("PHNT"); },
      [] { return std::string("has not one record for each page"); });
  for (std::size_t p = 0; is_whole && p < file.page_hints.size(); ++p) check_hint(file, p, log);
}

}  // namespace

bool check_page_table(const FileTables& file, RuleLog& log) {
  for (const Rule rule : {Rule::kL201, Rule::kL202, Rule::kL213, Rule::kL217}) log.check(rule);
  const bool ranges = check_ranges(file, log);
  const bool places = check_places(file, log);
  if (ranges) check_dependencies(file, log);
  if (ranges) check_hints(file, log);
  return ranges && places;
}

}  // namespace meshlode::judge
