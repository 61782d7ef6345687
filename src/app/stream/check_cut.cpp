// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/check_cut.h"

#include <algorithm>

#include "run/select/metric.h"

namespace meshlode::app {

namespace {

constexpr std::uint8_t kUnknownAbove = 255;

std::string name_cluster(std::uint32_t instance, std::uint32_t cluster) {
  return "instance " + std::to_string(instance) + ", cluster " + std::to_string(cluster);
}

}  // namespace

CutCheck::CutCheck(const StreamScene& scene)
    : scene_(scene), is_drawn_(scene.clusters.size()), above_(scene.groups.size()), is_blocked_(scene.groups.size()) {}

/// From coarse to fine. Paths come to a group through the clusters made from it, and each must bring the same count.
std::optional<std::string> CutCheck::check_paths(const format::MeshRecord& mesh, std::uint32_t instance) {
  const std::uint32_t end = mesh.first_cluster + mesh.cluster_count;
  std::fill_n(above_.begin() + mesh.first_group, mesh.group_count, kUnknownAbove);
  for (std::uint32_t c = mesh.first_cluster; c < end; ++c) {
    const format::ClusterRecord& cluster = scene_.clusters[c];
    std::uint8_t& above = above_[cluster.coarser_group];
    if (above == kUnknownAbove) above = 0;  // nothing coarser was made from its group: it is terminal
    const auto count = static_cast<std::uint8_t>(above + is_drawn_[c]);
    if (count > 1) return name_cluster(instance, c) + " is drawn twice on a path";
    if (cluster.own_group == format::kNone) {
      if (count == 0) return "nothing is drawn for " + name_cluster(instance, c);
      continue;
    }
    std::uint8_t& handed_on = above_[cluster.own_group];
    if (handed_on != kUnknownAbove && handed_on != count) {
      return "the cut is open at group " + std::to_string(cluster.own_group) + " of instance " +
             std::to_string(instance);
    }
    handed_on = count;
  }
  return std::nullopt;
}

std::optional<std::string> CutCheck::find_fault(const run::Camera& camera, double pixel_error,
                                                std::span<const std::uint8_t> is_resident,
                                                std::span<const run::ClusterInstance> items) {
  std::fill(is_drawn_.begin(), is_drawn_.end(), std::uint8_t{0});
  for (std::size_t g = 0; g < scene_.groups.size(); ++g) is_blocked_[g] = is_resident[scene_.groups[g].page] == 0;
  for (const format::ClusterRecord& cluster : scene_.clusters) {
    if (cluster.own_group == format::kNone) continue;
    is_blocked_[cluster.own_group] |= is_blocked_[cluster.coarser_group];
  }
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const format::InstanceRecord& instance = scene_.instances[i];
    const format::MeshRecord& mesh = scene_.meshes[instance.mesh];
    const std::size_t begin = at;
    while (at < items.size() && items[at].instance.value == i) ++at;
    const auto own = items.subspan(begin, at - begin);
    const bool is_drawable = (instance.flags & format::kInstanceSingular) == 0 && mesh.cluster_count > 0;
    if (!is_drawable) {
      if (!own.empty()) return "instance " + std::to_string(i) + " cannot be drawn";
      continue;
    }
    const run::MetricView view =
        run::make_metric_view(camera, pixel_error, instance, mesh, run::mesh_reach(scene_.tables(), mesh));
    for (const run::ClusterInstance& item : own) {
      const std::uint32_t c = item.cluster.value;
      const format::ClusterRecord& cluster = scene_.clusters[c];
      const std::uint32_t page = scene_.groups[cluster.coarser_group].page;
      is_drawn_[c] = 1;
      if (is_resident[page] == 0) return "page " + std::to_string(page) + " is drawn and not there";
      if (cluster.own_group == format::kNone || is_blocked_[cluster.own_group] != 0) continue;
      const format::GroupRecord& group = scene_.groups[cluster.own_group];
      if (!run::metric_passes(view, group.center[0], group.center[1], group.center[2], group.radius, group.error)) {
        return name_cluster(i, c) + " could be finer";
      }
    }
    auto fault = check_paths(mesh, i);
    for (const run::ClusterInstance& item : own) is_drawn_[item.cluster.value] = 0;
    if (fault) return fault;
  }
  return at == items.size() ? std::nullopt : std::optional<std::string>("items are not ascending");
}

}  // namespace meshlode::app
