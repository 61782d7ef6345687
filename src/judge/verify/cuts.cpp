// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/cuts.h"

#include <algorithm>
#include <numeric>

namespace meshlode::judge {

MeshJudge make_mesh_judge(const run::Asset& asset, MeshId mesh, std::span<const run::DecodedCluster> clusters) {
  MeshJudge judge;
  judge.surface = build_surface(asset, mesh, clusters);
  judge.border = prove_borders(asset, judge.surface).border;
  judge.group_order.resize(judge.surface.group_count);
  std::iota(judge.group_order.begin(), judge.group_order.end(), 0U);
  const auto groups = asset.groups().subspan(judge.surface.first_group, judge.surface.group_count);
  std::stable_sort(judge.group_order.begin(), judge.group_order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return groups[a].level < groups[b].level; });
  return judge;
}

std::string find_coverage_fault(const run::Asset& asset, const MeshJudge& judge, std::span<const std::uint8_t> drawn) {
  const MeshSurface& surface = judge.surface;
  struct Range {
    std::uint32_t least = 0, most = 0;
  };
  std::vector<Range> of_group(surface.group_count);  // drawn on paths up to and with a member
  for (const std::uint32_t k : judge.group_order) {
    const format::GroupRecord& group = asset.groups()[surface.first_group + k];
    Range range{0xFFFFFFFFU, 0};
    for (std::uint32_t i = 0; i < group.cluster_count; ++i) {
      const std::uint32_t c = group.first_cluster + i;
      const format::ClusterRecord& cluster = asset.clusters()[c];
      Range member;
      if (cluster.own_group != format::kNone) member = of_group[cluster.own_group - surface.first_group];
      const std::uint32_t here = drawn[c - surface.first_cluster];
      range.least = std::min(range.least, member.least + here);
      range.most = std::max(range.most, member.most + here);
    }
    of_group[k] = range;
    if (range.most > 1) return place("group", surface.first_group + k) + ": a piece of surface is drawn twice";
    if ((group.flags & format::kGroupTerminal) != 0 && range.least != 1) {
      return place("group", surface.first_group + k) + ": a piece of surface below it is not drawn";
    }
  }
  return {};
}

std::string find_border_fault(const MeshJudge& judge, std::span<const std::uint8_t> drawn) {
  const MeshSurface& surface = judge.surface;
  std::vector<std::int32_t> net(surface.edges.size(), 0);
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    if (drawn[c] == 0) continue;
    for (const EdgeUse& use : surface.chain(c)) net[use.edge] += use.net;
  }
  for (std::uint32_t edge = 0; edge < net.size(); ++edge) {
    if (net[edge] != 0 && !judge.border.allows(edge, net[edge])) {
      return "edge " + edge_text(surface, edge) + " is left open, " + std::to_string(net[edge]) + " uses";
    }
  }
  return {};
}

}  // namespace meshlode::judge
