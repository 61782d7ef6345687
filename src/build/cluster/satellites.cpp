// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/cluster/satellites.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "base/local_ids.h"
#include "base/parallel.h"

namespace meshlode::build {

namespace {

/// Pieces of so many triangles are debris where larger ones lie beside them.
constexpr std::uint32_t kDebris = 8;
constexpr std::size_t kChunkOfClusters = 64;

std::array<std::uint32_t, 3> positions_of(const WedgeTriangle& t, std::span<const std::uint32_t> wedge_position) {
  return {wedge_position[t[0]], wedge_position[t[1]], wedge_position[t[2]]};
}

bool has_three(const std::array<std::uint32_t, 3>& p) {
  return p[0] != p[1] && p[1] != p[2] && p[2] != p[0];
}

/// What visit(t, found) finds for t in [0, count), side by side, in the order of t.
template <class Found, class Visit>
std::vector<Found> find_in_order(std::size_t count, const Visit& visit) {
  std::vector<std::vector<Found>> by_chunk(chunk_count(count, kLoopGrain));
  parallel_for_each_chunk(count, kLoopGrain, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) visit(static_cast<std::uint32_t>(t), by_chunk[chunk]);
  });
  std::vector<Found> all;
  for (const std::vector<Found>& found : by_chunk) all.insert(all.end(), found.begin(), found.end());
  return all;
}

/// Triangles without a host, each followed by its satellites, in flat rows: nearly all of them are alone.
struct SystemRows {
  std::vector<std::uint32_t> first;    ///< of a system, into triangles; system count + 1
  std::vector<std::uint32_t> members;  ///< triangle ids

  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t system) const {
    return {members.data() + first[system], members.data() + first[system + 1]};
  }
};

/// The systems of a cluster that has to be divided.
using Systems = std::vector<std::vector<std::uint32_t>>;

/// Systems by cluster, in flat rows, ascending.
struct PartRows {
  std::vector<std::uint32_t> first;  ///< of a cluster, into systems; cluster count + 1
  std::vector<std::uint32_t> systems;
};

SystemRows rows_of_systems(const std::vector<std::uint32_t>& core, const std::vector<std::uint32_t>& place,
                           const Hosts& hosts) {
  SystemRows rows;
  rows.first.assign(core.size() + 1, 0);
  for (std::uint32_t t = 0; t < hosts.size(); ++t) ++rows.first[place[hosts[t] == kNoId ? t : hosts[t]] + 1];
  for (std::size_t i = 0; i < core.size(); ++i) rows.first[i + 1] += rows.first[i];
  rows.members.resize(hosts.size());
  std::vector<std::uint32_t> cursor(rows.first.begin(), rows.first.end() - 1);
  for (std::size_t i = 0; i < core.size(); ++i) rows.members[cursor[i]++] = core[i];
  for (std::uint32_t t = 0; t < hosts.size(); ++t) {
    if (hosts[t] != kNoId) rows.members[cursor[place[hosts[t]]]++] = t;
  }
  return rows;
}

PartRows rows_of_parts(const Clustering& clustering) {
  PartRows rows;
  rows.first.assign(clustering.count + 1, 0);
  for (const std::uint32_t label : clustering.label) ++rows.first[label + 1];
  for (std::uint32_t part = 0; part < clustering.count; ++part) rows.first[part + 1] += rows.first[part];
  rows.systems.resize(clustering.label.size());
  std::vector<std::uint32_t> cursor(rows.first.begin(), rows.first.end() - 1);
  for (std::uint32_t i = 0; i < clustering.label.size(); ++i) rows.systems[cursor[clustering.label[i]]++] = i;
  return rows;
}

Systems systems_of(const SystemRows& rows, const PartRows& parts, std::uint32_t part) {
  Systems systems;
  for (std::uint32_t i = parts.first[part]; i < parts.first[part + 1]; ++i) {
    const std::span<const std::uint32_t> members = rows.of(parts.systems[i]);
    systems.emplace_back(members.begin(), members.end());
  }
  return systems;
}

/// Whether a cluster is over its caps. `for_each_triangle` visits its triangles.
template <class ForEach>
bool is_too_large(std::span<const WedgeTriangle> triangles, const ClusterCaps& caps, LocalIds& wedges,
                  const ForEach& for_each_triangle) {
  std::size_t count = 0;
  wedges.clear();
  for_each_triangle([&](std::uint32_t t) {
    ++count;
    for (const std::uint32_t wedge : triangles[t]) wedges.add(wedge);
  });
  return count > caps.max_triangles || wedges.size() > caps.max_vertices;
}

/// Two clusters of whole systems; a lone system with too many satellites is cut anywhere.
std::pair<Systems, Systems> divide(const Systems& systems, std::span<const WedgeTriangle> triangles,
                                   std::span<const std::uint32_t> wedge_position) {
  std::pair<Systems, Systems> halves;
  if (systems.size() == 1) {
    const std::vector<std::uint32_t>& all = systems[0];
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    halves.first.push_back({all.begin(), middle});
    halves.second.push_back({middle, all.end()});
    return halves;
  }
  std::vector<std::array<std::uint32_t, 3>> corners;
  corners.reserve(systems.size());
  for (const auto& system : systems) corners.push_back(positions_of(triangles[system[0]], wedge_position));
  Graph graph = triangle_graph(corners);
  for (const auto& system : systems) graph.node_weight.push_back(static_cast<std::int32_t>(system.size()));
  const std::vector<std::uint32_t> half = partition_graph(graph, 2);
  for (std::size_t i = 0; i < systems.size(); ++i) (half[i] == 0 ? halves.first : halves.second).push_back(systems[i]);
  return halves;
}

struct Surface {
  std::span<const WedgeTriangle> triangles;
  std::span<const std::uint32_t> wedge_position;
};

/// Labels of all triangles: clusters keep their numbers, and what has to be cut off gets those that follow.
Clustering divide_too_large(const SystemRows& rows, const PartRows& parts, const Surface& surface,
                            const ClusterCaps& caps) {
  Clustering clustering;
  clustering.count = static_cast<std::uint32_t>(parts.first.size() - 1);
  clustering.label.resize(surface.triangles.size());
  LocalIds wedges(2 * std::size_t{caps.max_vertices});
  std::vector<Systems> cut_off;  // their numbers follow those of `parts`
  const auto settle = [&](std::uint32_t part, Systems systems) {
    const auto for_each_triangle = [&](auto&& visit) {
      for (const auto& system : systems) std::for_each(system.begin(), system.end(), visit);
    };
    while (is_too_large(surface.triangles, caps, wedges, for_each_triangle)) {
      auto [keep, split] = divide(systems, surface.triangles, surface.wedge_position);
      systems = std::move(keep);
      cut_off.push_back(std::move(split));
      ++clustering.count;
    }
    for_each_triangle([&](std::uint32_t t) { clustering.label[t] = part; });
  };
  const std::uint32_t before = clustering.count;
  std::vector<std::uint8_t> is_large(before, 0);  // they are few: found side by side, divided in order
  parallel_for_each_chunk(before, kChunkOfClusters, [&](std::size_t, std::size_t begin, std::size_t end) {
    LocalIds own_wedges(2 * std::size_t{caps.max_vertices});
    for (auto part = static_cast<std::uint32_t>(begin); part < end; ++part) {
      const auto for_each_triangle = [&](auto&& visit) {
        for (std::uint32_t i = parts.first[part]; i < parts.first[part + 1]; ++i) {
          const std::span<const std::uint32_t> members = rows.of(parts.systems[i]);
          std::for_each(members.begin(), members.end(), visit);
        }
      };
      is_large[part] = is_too_large(surface.triangles, caps, own_wedges, for_each_triangle) ? 1 : 0;
      if (is_large[part] == 0) for_each_triangle([&](std::uint32_t t) { clustering.label[t] = part; });
    }
  });
  for (std::uint32_t part = 0; part < before; ++part) {
    if (is_large[part] != 0) settle(part, systems_of(rows, parts, part));
  }
  for (std::uint32_t part = before; part < clustering.count; ++part) {
    Systems systems = std::move(cut_off[part - before]);
    settle(part, std::move(systems));
  }
  return clustering;
}

}  // namespace

Hosts host_collapsed(std::span<const WedgeTriangle> triangles, std::span<const std::uint32_t> wedge_position,
                     std::size_t position_count) {
  const std::vector<std::uint32_t> collapsed =
      find_in_order<std::uint32_t>(triangles.size(), [&](std::uint32_t t, std::vector<std::uint32_t>& found) {
        if (!has_three(positions_of(triangles[t], wedge_position))) found.push_back(t);
      });
  if (collapsed.empty()) return {};
  std::vector<std::uint8_t> is_wanted(position_count, 0);
  for (const std::uint32_t t : collapsed) {
    for (const std::uint32_t position : positions_of(triangles[t], wedge_position)) is_wanted[position] = 1;
  }
  using User = std::pair<std::uint32_t, std::uint32_t>;  // a wanted position, and a triangle there
  std::vector<User> users = find_in_order<User>(triangles.size(), [&](std::uint32_t t, std::vector<User>& found) {
    const auto p = positions_of(triangles[t], wedge_position);
    if (!has_three(p)) return;
    for (const std::uint32_t position : p) {
      if (is_wanted[position] != 0) found.emplace_back(position, t);
    }
  });
  std::sort(users.begin(), users.end());
  Hosts hosts(triangles.size(), kNoId);
  for (const std::uint32_t t : collapsed) {
    const auto own = positions_of(triangles[t], wedge_position);
    const auto users_of = [&](std::uint32_t position) {
      const auto first = std::lower_bound(users.begin(), users.end(), User{position, 0U});
      return std::span<const User>(first, std::lower_bound(first, users.end(), User{position + 1, 0U}));
    };
    // One that covers all of it has all its positions, so that the one with the fewest users will do: a fan of needles
    // around one vertex stays linear.
    std::span<const User> fewest = users_of(own[0]);
    for (const std::uint32_t position : own) {
      const std::span<const User> these = users_of(position);
      if (these.size() < fewest.size()) fewest = these;
      if (hosts[t] == kNoId && !these.empty()) hosts[t] = these[0].second;
    }
    const auto covering = std::find_if(fewest.begin(), fewest.end(), [&](const User& user) {
      const auto theirs = positions_of(triangles[user.second], wedge_position);
      return std::all_of(own.begin(), own.end(), [&](std::uint32_t position) {
        return std::find(theirs.begin(), theirs.end(), position) != theirs.end();
      });
    });
    if (covering != fewest.end()) hosts[t] = covering->second;
  }
  return hosts;
}

Hosts host_debris(const std::vector<std::uint32_t>& piece, std::uint32_t piece_count,
                  std::span<const TriangleLink> links) {
  std::vector<std::uint32_t> size(piece_count, 0);
  for (const std::uint32_t p : piece) ++size[p];
  std::vector<std::uint32_t> host_of_piece(piece_count, kNoId);
  bool any = false;
  for (const auto& [from, to] : links) {
    if (size[piece[from]] > kDebris || size[piece[to]] <= kDebris) continue;
    host_of_piece[piece[from]] = to;
    any = true;
  }
  if (!any) return {};
  Hosts hosts(piece.size());
  for (std::size_t t = 0; t < hosts.size(); ++t) hosts[t] = host_of_piece[piece[t]];
  return hosts;
}

Clustering cluster_with_satellites(std::span<const WedgeTriangle> triangles,
                                   std::span<const std::uint32_t> wedge_position, const Hosts& hosts,
                                   const ClusterCaps& caps, const ClusterWeighted& cluster) {
  if (std::all_of(hosts.begin(), hosts.end(), [](std::uint32_t host) { return host == kNoId; })) {
    return cluster(triangles, std::vector<std::int32_t>(triangles.size(), 1));
  }
  std::vector<std::uint32_t> core;  // ids of triangles without a host
  std::vector<std::uint32_t> place(triangles.size(), kNoId);
  std::vector<WedgeTriangle> core_triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (hosts[t] != kNoId) continue;
    place[t] = static_cast<std::uint32_t>(core.size());
    core.push_back(t);
    core_triangles.push_back(triangles[t]);
  }
  const SystemRows rows = rows_of_systems(core, place, hosts);
  std::vector<std::int32_t> weights(core.size());
  for (std::uint32_t i = 0; i < core.size(); ++i) weights[i] = static_cast<std::int32_t>(rows.of(i).size());
  const Clustering of_core = cluster(core_triangles, weights);
  return divide_too_large(rows, rows_of_parts(of_core), {triangles, wedge_position}, caps);
}

}  // namespace meshlode::build
