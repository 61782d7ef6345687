// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/borders.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "judge/validate/border_exchange.h"

namespace meshlode::judge {

namespace {

using format::GroupRecord;

std::vector<std::uint32_t> members_of(const MeshSurface& surface, const GroupRecord& group) {
  std::vector<std::uint32_t> members(group.cluster_count);
  std::iota(members.begin(), members.end(), group.first_cluster - surface.first_cluster);
  return members;
}

ClusterSet set_of(const MeshSurface& surface, std::span<const std::uint32_t> members) {
  ClusterSet set;
  set.chain = sum_chains(surface, members);
  for (const std::uint32_t c : members) {
    const std::uint32_t* position = surface.vertex_position.data() + surface.first_vertex[c];
    for (const auto& t : surface.triangles(c)) {
      set.triangles.push_back({position[t[0]], position[t[1]], position[t[2]]});
    }
  }
  return set;
}

std::vector<std::uint32_t> groups_from_fine_to_coarse(const run::Asset& asset, const MeshSurface& surface) {
  std::vector<std::uint32_t> order(surface.group_count);
  std::iota(order.begin(), order.end(), surface.first_group);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return asset.groups()[a].level < asset.groups()[b].level; });
  return order;
}

/// Per edge: whether a cluster has it on its border that neither goes into an aggregate's group nor was made from one.
std::vector<std::uint8_t> edges_outside_aggregates(const run::Asset& asset, const MeshSurface& surface) {
  std::vector<std::uint8_t> outside(surface.edges.size(), 0);
  const auto is_aggregate = [&](std::uint32_t group) {
    return group != format::kNone && (asset.groups()[group].flags & format::kGroupAggregate) != 0;
  };
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[surface.first_cluster + c];
    if (is_aggregate(cluster.own_group) || is_aggregate(cluster.coarser_group)) continue;
    for (const EdgeUse& use : surface.chain(c)) outside[use.edge] = 1;
  }
  return outside;
}

/// What an aggregate's group may do: pieces go, and others come. Of nothing that goes or comes may anybody else have an
/// edge, and what goes must have been a border.
std::string refuse_new_pieces(const MeshSurface& surface, const BorderSet& border, std::span<const Exchange> exchanges,
                              std::span<const std::uint8_t> outside) {
  for (const Exchange& exchange : exchanges) {
    if (outside[exchange.edge] != 0) {
      return "changes the border edge " + edge_text(surface, exchange.edge) + " that is not an aggregate's alone";
    }
    if (exchange.removed != 0 && !border.allows(exchange.edge, exchange.removed)) {
      return "takes away the border edge " + edge_text(surface, exchange.edge) + " that others lean on";
    }
  }
  return {};
}

}  // namespace

BorderProof prove_borders(const run::Asset& asset, const MeshSurface& surface) {
  BorderProof proof;
  BorderSet& border = proof.border;
  border.plus.assign(surface.edges.size(), 0);
  border.minus.assign(surface.edges.size(), 0);
  std::vector<std::uint32_t> level0;
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    if (asset.clusters()[surface.first_cluster + c].own_group == format::kNone) level0.push_back(c);
  }
  for (const EdgeUse& use : sum_chains(surface, level0)) {
    (use.net > 0 ? border.plus : border.minus)[use.edge] = std::abs(use.net);
    border.is_closed = false;
  }

  const std::vector<std::uint8_t> outside = edges_outside_aggregates(asset, surface);
  for (const std::uint32_t g : groups_from_fine_to_coarse(asset, surface)) {
    const GroupRecord& group = asset.groups()[g];
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    ++proof.groups;
    const std::vector<std::uint32_t> members = members_of(surface, group);
    const std::vector<std::uint32_t>& made = surface.made[g - surface.first_group];
    const std::vector<Exchange> exchanges = exchanges_of(sum_chains(surface, members), sum_chains(surface, made));
    if (exchanges.empty()) continue;
    const bool is_aggregate = (group.flags & format::kGroupAggregate) != 0;
    std::string reason =
        is_aggregate ? refuse_new_pieces(surface, border, exchanges, outside)
                     : refuse_exchange(surface, border, exchanges, set_of(surface, members), set_of(surface, made));
    if (!reason.empty()) {
      proof.violations.push_back({g, std::move(reason)});
      continue;  // what a broken group adds is no border of the source
    }
    for (const Exchange& exchange : exchanges) {
      if (exchange.added > 0) border.plus[exchange.edge] += exchange.added;
      if (exchange.added < 0) border.minus[exchange.edge] -= exchange.added;
    }
  }
  std::sort(proof.violations.begin(), proof.violations.end(),
            [](const BorderViolation& a, const BorderViolation& b) { return a.group < b.group; });
  return proof;
}

namespace {

/// A position with one set of attributes.
struct Wedge {
  std::uint32_t position;
  std::uint64_t attributes;
  auto operator<=>(const Wedge&) const = default;
};

/// The wedges of clusters at the given positions (ascending), ascending and distinct.
std::vector<Wedge> wedges_at(const MeshSurface& surface, std::span<const std::uint32_t> clusters,
                             std::span<const std::uint32_t> positions) {
  std::vector<Wedge> out;
  for (const std::uint32_t c : clusters) {
    for (std::uint32_t v = surface.first_vertex[c]; v < surface.first_vertex[c + 1]; ++v) {
      if (std::binary_search(positions.begin(), positions.end(), surface.vertex_position[v])) {
        out.push_back({surface.vertex_position[v], surface.vertex_attributes[v]});
      }
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Calls visit(edge, lower vertex, higher vertex) for each use of one of `edges` (ascending) by a triangle of the
/// clusters.
template <class Visit>
void for_each_use(const MeshSurface& surface, std::span<const std::uint32_t> members,
                  std::span<const std::uint32_t> edges, const Visit& visit) {
  for (const std::uint32_t c : members) {
    const std::uint32_t base = surface.first_vertex[c];
    for (const auto& triangle : surface.triangles(c)) {
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t v = base + triangle[k];
        std::uint32_t w = base + triangle[(k + 1) % 3];
        if (surface.vertex_position[v] > surface.vertex_position[w]) std::swap(v, w);
        // Edges of the surface are ascending, so `edges` are ascending by their positions too.
        const std::array<std::uint32_t, 2> key{surface.vertex_position[v], surface.vertex_position[w]};
        const auto found = std::lower_bound(edges.begin(), edges.end(), key,
                                            [&](std::uint32_t e, const auto& k2) { return surface.edges[e] < k2; });
        if (found != edges.end() && surface.edges[*found] == key) visit(*found, v, w);
      }
    }
  }
}

}  // namespace

std::vector<BorderViolation> check_shared_attributes(const run::Asset& asset, const MeshSurface& surface,
                                                     const BorderSet& border) {
  std::vector<BorderViolation> out;
  std::vector<std::uint32_t> kept;
  std::vector<std::uint32_t> ends;
  struct Use {
    std::uint32_t edge, lower, higher;
    auto operator<=>(const Use&) const = default;
  };
  std::vector<Use> uses;
  for (std::uint32_t k = 0; k < surface.group_count; ++k) {
    const std::uint32_t g = surface.first_group + k;
    const GroupRecord& group = asset.groups()[g];
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    const std::vector<std::uint32_t> members = members_of(surface, group);
    kept.clear();
    ends.clear();
    for_each_edge(sum_chains(surface, members), sum_chains(surface, surface.made[k]),
                  [&](std::uint32_t edge, std::int32_t f, std::int32_t c) {
                    // The source's own border is nobody's to share.
                    if (f != c || border.plus[edge] != 0 || border.minus[edge] != 0) return;
                    kept.push_back(edge);
                    ends.insert(ends.end(), surface.edges[edge].begin(), surface.edges[edge].end());
                  });
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    const std::vector<Wedge> finer = wedges_at(surface, members, ends);
    uses.clear();
    for_each_use(surface, surface.made[k], kept, [&](std::uint32_t edge, std::uint32_t v, std::uint32_t w) {
      uses.push_back({edge, v, w});
    });
    std::sort(uses.begin(), uses.end());
    std::uint64_t changed = 0;
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < uses.size(); ++i) {
      // Where sheets of the same set meet on the edge too, which use is the border's cannot be told.
      const bool is_alone =
          (i == 0 || uses[i - 1].edge != uses[i].edge) && (i + 1 == uses.size() || uses[i + 1].edge != uses[i].edge);
      if (!is_alone) continue;
      for (const std::uint32_t vertex : {uses[i].lower, uses[i].higher}) {
        const Wedge wedge{surface.vertex_position[vertex], surface.vertex_attributes[vertex]};
        if (!std::binary_search(finer.begin(), finer.end(), wedge) && changed++ == 0) first = wedge.position;
      }
    }
    if (changed > 0) {
      out.push_back({g, std::to_string(changed) +
                            " corners of shared border edges have attributes that the finer set has not in their "
                            "place, such as at " +
                            position_text(surface, first)});
    }
  }
  return out;
}

}  // namespace meshlode::judge
