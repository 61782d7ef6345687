// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/satellites.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "base/local_ids.h"
#include "base/parallel.h"
#include "builder/cluster/loose_pieces.h"

namespace meshlode::builder {

namespace {

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

/// Some clusters, ascending, and their triangles in flat rows, ascending.
struct PartRows {
  std::vector<std::uint32_t> parts;
  std::vector<std::uint32_t> first;  ///< of each of them, into triangles; and one more
  std::vector<std::uint32_t> triangles;

  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t row) const {
    return {triangles.data() + first[row], triangles.data() + first[row + 1]};
  }
};

/// Of a cluster that has to be divided: triangles without a host, each followed by its satellites.
using Systems = std::vector<std::vector<std::uint32_t>>;

/// Those clusters that have satellites.
PartRows rows_with_satellites(const Clustering& clustering, const Hosts& hosts) {
  std::vector<std::uint32_t> row(clustering.count, kNoId);
  for (std::size_t t = 0; t < hosts.size(); ++t) {
    if (hosts[t] != kNoId) row[clustering.label[t]] = 0;
  }
  PartRows rows;
  for (std::uint32_t part = 0; part < clustering.count; ++part) {
    if (row[part] == kNoId) continue;
    row[part] = static_cast<std::uint32_t>(rows.parts.size());
    rows.parts.push_back(part);
  }
  rows.first.assign(rows.parts.size() + 1, 0);
  for (const std::uint32_t label : clustering.label) {
    if (row[label] != kNoId) ++rows.first[row[label] + 1];
  }
  for (std::size_t i = 0; i < rows.parts.size(); ++i) rows.first[i + 1] += rows.first[i];
  rows.triangles.resize(rows.first.back());
  std::vector<std::uint32_t> cursor(rows.first.begin(), rows.first.end() - 1);
  for (std::uint32_t t = 0; t < hosts.size(); ++t) {
    if (const std::uint32_t at = row[clustering.label[t]]; at != kNoId) rows.triangles[cursor[at]++] = t;
  }
  return rows;
}

Systems systems_of(std::span<const std::uint32_t> triangles, const Hosts& hosts) {
  Systems systems;
  for (const std::uint32_t t : triangles) {
    if (hosts[t] == kNoId) systems.push_back({t});
  }
  for (const std::uint32_t t : triangles) {
    if (hosts[t] == kNoId) continue;
    const auto own = std::lower_bound(systems.begin(), systems.end(), hosts[t],
                                      [](const auto& system, std::uint32_t host) { return system[0] < host; });
    own->push_back(t);
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

struct Surface {
  std::span<const WedgeTriangle> triangles;
  std::span<const std::uint32_t> wedge_position;
  std::span<const Vec3i> positions;
};

/// Two clusters of whole systems, of which loose ones stay beside what is nearest; a lone system with too many
/// satellites is cut anywhere.
std::pair<Systems, Systems> divide(const Systems& systems, const Surface& surface) {
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
  for (const auto& system : systems)
    corners.push_back(positions_of(surface.triangles[system[0]], surface.wedge_position));
  TriangleLinks links(corners);
  std::vector<std::uint32_t> piece;
  const std::uint32_t piece_count = links.find_pieces(piece);
  if (piece_count > 1) links.add(link_to_nearest(corners, surface.positions, piece, piece_count));
  Graph graph = links.graph();
  for (const auto& system : systems) graph.node_weight.push_back(static_cast<std::int32_t>(system.size()));
  const std::vector<std::uint32_t> half = partition_graph(graph, 2);
  for (std::size_t i = 0; i < systems.size(); ++i) (half[i] == 0 ? halves.first : halves.second).push_back(systems[i]);
  return halves;
}

/// Clusters keep their numbers, and what has to be cut off gets those that follow. Those without satellites are within
/// their caps.
void divide_too_large(const Surface& surface, const Hosts& hosts, const ClusterCaps& caps, Clustering& clustering) {
  const PartRows rows = rows_with_satellites(clustering, hosts);
  std::vector<std::uint8_t> is_large(rows.parts.size(), 0);  // they are few: found side by side, divided in order
  parallel_for_each_chunk(is_large.size(), kChunkOfClusters, [&](std::size_t, std::size_t begin, std::size_t end) {
    LocalIds wedges(2 * std::size_t{caps.max_vertices});
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<const std::uint32_t> members = rows.of(i);
      const auto for_each_triangle = [&](auto&& visit) { std::for_each(members.begin(), members.end(), visit); };
      is_large[i] = is_too_large(surface.triangles, caps, wedges, for_each_triangle) ? 1 : 0;
    }
  });
  LocalIds wedges(2 * std::size_t{caps.max_vertices});
  std::vector<Systems> cut_off;  // their numbers follow those that were there
  const std::uint32_t before = clustering.count;
  const auto settle = [&](std::uint32_t part, Systems systems) {
    const auto for_each_triangle = [&](auto&& visit) {
      for (const auto& system : systems) std::for_each(system.begin(), system.end(), visit);
    };
    while (is_too_large(surface.triangles, caps, wedges, for_each_triangle)) {
      auto [keep, split] = divide(systems, surface);
      systems = std::move(keep);
      cut_off.push_back(std::move(split));
      ++clustering.count;
    }
    for_each_triangle([&](std::uint32_t t) { clustering.label[t] = part; });
  };
  for (std::size_t i = 0; i < is_large.size(); ++i) {
    if (is_large[i] != 0) settle(rows.parts[i], systems_of(rows.of(i), hosts));
  }
  for (std::uint32_t part = before; part < clustering.count; ++part) {
    Systems systems = std::move(cut_off[part - before]);
    settle(part, std::move(systems));
  }
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
                                   std::span<const std::uint32_t> wedge_position, std::span<const Vec3i> positions,
                                   const Hosts& hosts, const ClusterCaps& caps, const ClusterWeighted& cluster) {
  if (std::all_of(hosts.begin(), hosts.end(), [](std::uint32_t host) { return host == kNoId; })) {
    return cluster(triangles, std::vector<std::int32_t>(triangles.size(), 1));
  }
  std::vector<std::uint32_t> place(triangles.size(), kNoId);  // among those without a host
  std::vector<WedgeTriangle> core;
  core.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (hosts[t] != kNoId) continue;
    place[t] = static_cast<std::uint32_t>(core.size());
    core.push_back(triangles[t]);
  }
  std::vector<std::int32_t> weights(core.size(), 1);
  for (const std::uint32_t host : hosts) {
    if (host != kNoId) ++weights[place[host]];
  }
  const Clustering of_core = cluster(core, weights);
  Clustering clustering;
  clustering.count = of_core.count;
  clustering.label.resize(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain, [&](std::size_t t) {
    clustering.label[t] = of_core.label[place[hosts[t] == kNoId ? static_cast<std::uint32_t>(t) : hosts[t]]];
  });
  divide_too_large({triangles, wedge_position, positions}, hosts, caps, clustering);
  return clustering;
}

}  // namespace meshlode::builder
