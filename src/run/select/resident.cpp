// SPDX-License-Identifier: MIT
#include "run/select/resident.h"

#include <algorithm>
#include <cmath>

#include "run/read/check_tables.h"

namespace meshlode::run {
namespace {

// Finite priorities: above 0, which is none, and below that of a terminal group.
constexpr double kLeastPriority = 0x1p-126, kLargestPriority = 0x1p126;

/// How many times the allowed error a group's is, at the nearest point of its sphere: the quotient that metric_passes()
/// compares with 1, less its cap, for doubles do not overflow here.
double projected_error(const MetricView& view, const format::GroupRecord& group) {
  const float* c = group.center;
  const float x = ((view.row0.x * c[0] + view.row0.y * c[1]) + view.row0.z * c[2]) + view.row0.w;
  const float y = ((view.row1.x * c[0] + view.row1.y * c[1]) + view.row1.z * c[2]) + view.row1.w;
  const float z = ((view.row2.x * c[0] + view.row2.y * c[1]) + view.row2.z * c[2]) + view.row2.w;
  const float distance = std::sqrt((x * x + y * y) + z * z) - group.radius * view.scale;
  return double{group.error} * double{view.error_scale} / double{std::max(distance, view.near_distance)};
}

}  // namespace

ResidentSelector::ResidentSelector(const SelectTables& tables)
    : is_mesh_drawn_(tables.meshes.size()), states_(tables.groups.size()), priorities_(tables.groups.size()) {
  // Pairs (group, group of a cluster made from it) sorted into lists without double entries. Clusters ascend with the
  // group that they are members of, so that each list ascends as it is filled.
  std::vector<std::uint32_t> last(tables.groups.size(), format::kNone);
  first_coarser_.assign(tables.groups.size() + 1, 0);
  const auto for_each_link = [&](const auto& use) {
    std::fill(last.begin(), last.end(), format::kNone);
    for (const format::ClusterRecord& cluster : tables.clusters) {
      if (cluster.own_group == format::kNone || last[cluster.own_group] == cluster.coarser_group) continue;
      last[cluster.own_group] = cluster.coarser_group;
      use(cluster.own_group, cluster.coarser_group);
    }
  };
  for_each_link([&](std::uint32_t own, std::uint32_t) { ++first_coarser_[own + 1]; });
  for (std::size_t g = 0; g < tables.groups.size(); ++g) first_coarser_[g + 1] += first_coarser_[g];
  coarser_.resize(first_coarser_.back());
  std::vector<std::uint32_t> next(first_coarser_.begin(), first_coarser_.end() - 1);
  for_each_link([&](std::uint32_t own, std::uint32_t coarser) { coarser_[next[own]++] = coarser; });

  std::uint32_t page_count = 0, most_nodes = 0;
  for (const format::MeshRecord& mesh : tables.meshes) {
    first_root_.push_back(static_cast<std::uint32_t>(root_pages_.size()));
    most_nodes = std::max(most_nodes, mesh.node_count);
    for (const format::GroupRecord& group : tables.groups.subspan(mesh.first_group, mesh.group_count)) {
      page_count = std::max(page_count, group.page + 1);
      if ((group.flags & format::kGroupTerminal) == 0) continue;
      if (root_pages_.size() > first_root_.back() && root_pages_.back() == group.page) continue;
      root_pages_.push_back(group.page);
    }
  }
  first_root_.push_back(static_cast<std::uint32_t>(root_pages_.size()));
  page_priorities_.resize(page_count);
  requests_.reserve(page_count);
  open_.groups.reserve(most_nodes);
  open_.stack.reserve(std::size_t{kMaxBvhDepth} * format::kBvhWidth);
}

void ResidentSelector::mark_roots(std::uint32_t mesh) {
  if (is_mesh_drawn_[mesh] != 0) return;
  is_mesh_drawn_[mesh] = 1;
  for (std::uint32_t r = first_root_[mesh]; r < first_root_[mesh + 1]; ++r) {
    page_priorities_[root_pages_[r]] = format::kInfiniteError;
  }
}

template <class IsResident>
void ResidentSelector::mark_groups(const SelectTables& tables, const InstanceView& view,
                                   const IsResident& is_resident) {
  for (const OpenGroup& open : open_.groups) states_[open.group] = kOpen;
  for (const OpenGroup& open : open_.groups) {  // coarse to fine
    const format::GroupRecord& group = tables.groups[open.group];
    bool is_reached = is_resident(group.page);
    for (const std::uint32_t coarser : coarser_than(open.group)) is_reached = is_reached && has(coarser, kReached);
    if (is_reached) states_[open.group] |= kReached;
    if (open.crossed == 0) {
      states_[open.group] |= kWanted;  // and so are, by themselves, the groups that its members were made from
      continue;
    }
    for (const format::ClusterRecord& cluster : tables.clusters.subspan(group.first_cluster, group.cluster_count)) {
      if (is_outside(view, open.crossed, cluster)) continue;
      states_[open.group] |= kWanted;
      // Where this cluster is seen although its own group does not pass, that group is what would take its place.
      if (cluster.own_group != format::kNone && has(cluster.own_group, kOpen)) states_[cluster.own_group] |= kWanted;
    }
  }
}

void ResidentSelector::rank_pages(const SelectTables& tables, const InstanceView& view, double pixel_error) {
  // From fine to coarse: a group hands on what is lost without it.
  for (std::size_t i = open_.groups.size(); i-- > 0;) {
    const std::uint32_t g = open_.groups[i].group;
    const format::GroupRecord& group = tables.groups[g];
    // Terminal groups are marked, not weighed; one that merely never passes is weighed.
    if (has(g, kWanted) && (group.flags & format::kGroupTerminal) == 0) {
      const double error_px = projected_error(view.metric, group) * pixel_error;
      priorities_[g] =
          std::max(priorities_[g], static_cast<float>(std::clamp(error_px, kLeastPriority, kLargestPriority)));
    }
    for (const std::uint32_t coarser : coarser_than(g)) {
      if (has(coarser, kOpen)) priorities_[coarser] = std::max(priorities_[coarser], priorities_[g]);
    }
    page_priorities_[group.page] = std::max(page_priorities_[group.page], priorities_[g]);
    priorities_[g] = 0.0F;
  }
}

std::size_t ResidentSelector::select(const SelectTables& tables, const ResidentQuery& query,
                                     std::span<ClusterInstance> items) {
  const auto is_resident = [&](std::uint32_t page) {
    return page / 32 < query.resident.size() && (query.resident[page / 32] >> page % 32 & 1U) != 0;
  };
  std::fill(page_priorities_.begin(), page_priorities_.end(), 0.0F);
  std::fill(is_mesh_drawn_.begin(), is_mesh_drawn_.end(), std::uint8_t{0});
  std::size_t count = 0;
  for (std::size_t i = 0; i < tables.instances.size(); ++i) {
    const format::InstanceRecord& instance = tables.instances[i];
    if (!is_drawable(tables, instance)) continue;
    mark_roots(instance.mesh);
    const format::MeshRecord& mesh = tables.meshes[instance.mesh];
    const double reach = mesh_reach(tables, mesh);
    InstanceView view{mesh, make_metric_view(query.camera, query.pixel_error, instance, mesh, reach),
                      frustum_of_mesh(query.frustum, instance, mesh)};
    find_open_groups(tables, view, open_);
    mark_groups(tables, view, is_resident);
    for (const OpenGroup& open : open_.groups) {
      if (!has(open.group, kReached)) continue;
      const format::GroupRecord& group = tables.groups[open.group];
      for (std::uint32_t id = group.first_cluster; id < group.first_cluster + group.cluster_count; ++id) {
        const format::ClusterRecord& cluster = tables.clusters[id];
        if (cluster.own_group != format::kNone && has(cluster.own_group, kReached)) continue;
        if (is_outside(view, open.crossed, cluster)) continue;
        if (count < items.size()) items[count] = {InstanceId(i), ClusterId(id)};
        ++count;
      }
    }
    // At an error of 0 pixels the view knows no distance.
    if (!(query.pixel_error > 0.0)) view.metric = make_metric_view(query.camera, 1.0, instance, mesh, reach);
    rank_pages(tables, view, query.pixel_error > 0.0 ? query.pixel_error : 1.0);
    for (const OpenGroup& open : open_.groups) states_[open.group] = 0;
  }
  requests_.clear();
  for (std::uint32_t page = 0; page < page_priorities_.size(); ++page) {
    if (page_priorities_[page] > 0.0F && !is_resident(page)) requests_.push_back({page, page_priorities_[page]});
  }
  std::sort(requests_.begin(), requests_.end(), [](const PageRequest& a, const PageRequest& b) {
    return a.priority != b.priority ? a.priority > b.priority : a.page < b.page;
  });
  return count;
}

}  // namespace meshlode::run
