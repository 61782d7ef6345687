// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/surface.h"

#include <algorithm>
#include <compare>
#include <string>

#include "base/hash.h"
#include "base/parallel.h"

namespace meshlode::judge {

namespace {

struct PositionKey {
  std::int32_t x, y, z;
  std::uint32_t vertex;
  auto operator<=>(const PositionKey&) const = default;
};

struct KeyUse {
  std::uint64_t key;
  std::int32_t net;
};

void name_positions(std::span<const run::DecodedCluster> clusters, MeshSurface& out) {
  out.first_vertex.assign(1, 0);
  for (const run::DecodedCluster& cluster : clusters)
    out.first_vertex.push_back(out.first_vertex.back() + cluster.vertex_count);
  std::vector<PositionKey> keys(out.first_vertex.back());
  out.vertex_position.resize(keys.size());
  out.vertex_attributes.resize(keys.size());
  parallel_for_each_index(clusters.size(), 16, [&](std::size_t c) {
    const run::DecodedCluster& cluster = clusters[c];
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const std::uint32_t vertex = out.first_vertex[c] + v;
      const Vec3i p = cluster.position(v);
      keys[vertex] = {p.x, p.y, p.z, vertex};
      const std::int32_t* channels = &cluster.channels[std::size_t{v} * cluster.channel_count];
      const std::span attributes(channels + 3, cluster.channel_count - 3);
      out.vertex_attributes[vertex] =
          hash64({reinterpret_cast<const std::uint8_t*>(attributes.data()), attributes.size_bytes()});
    }
  });
  std::sort(keys.begin(), keys.end());
  for (const PositionKey& key : keys) {
    const Vec3i p{key.x, key.y, key.z};
    if (out.positions.empty() || out.positions.back() != p) out.positions.push_back(p);
    out.vertex_position[key.vertex] = static_cast<std::uint32_t>(out.positions.size() - 1);
  }
}

std::vector<KeyUse> cluster_chain(const run::DecodedCluster& cluster, std::span<const std::uint32_t> positions) {
  std::vector<KeyUse> uses;
  uses.reserve(cluster.triangles.size() * 3);
  for (const auto& triangle : cluster.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = positions[triangle[k]];
      const std::uint64_t b = positions[triangle[(k + 1) % 3]];
      if (a == b) continue;
      uses.push_back({std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const KeyUse& a, const KeyUse& b) { return a.key < b.key; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < uses.size();) {
    KeyUse sum = uses[i++];
    while (i < uses.size() && uses[i].key == sum.key) sum.net += uses[i++].net;
    if (sum.net != 0) uses[kept++] = sum;
  }
  return {uses.begin(), uses.begin() + static_cast<std::ptrdiff_t>(kept)};  // a sixth of the room, all chains stay
}

}  // namespace

MeshSurface build_surface(const run::Asset& asset, MeshId mesh, std::span<const run::DecodedCluster> all_clusters) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  MeshSurface out;
  out.mesh = mesh;
  out.first_cluster = record.first_cluster;
  out.cluster_count = record.cluster_count;
  out.first_group = record.first_group;
  out.group_count = record.group_count;
  const auto clusters = all_clusters.subspan(record.first_cluster, record.cluster_count);
  name_positions(clusters, out);

  std::vector<std::vector<KeyUse>> chains(clusters.size());
  parallel_for_each_index(clusters.size(), 16, [&](std::size_t c) {
    chains[c] = cluster_chain(clusters[c], std::span(out.vertex_position).subspan(out.first_vertex[c]));
  });
  std::vector<std::uint64_t> keys;
  for (const auto& chain : chains) {
    for (const KeyUse& use : chain) keys.push_back(use.key);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  out.edges.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    out.edges.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key & 0xFFFFFFFFU)});
  }
  out.first_use.assign(1, 0);
  for (const auto& chain : chains)
    out.first_use.push_back(out.first_use.back() + static_cast<std::uint32_t>(chain.size()));
  out.uses.resize(out.first_use.back());
  parallel_for_each_index(clusters.size(), 64, [&](std::size_t c) {
    std::size_t slot = out.first_use[c];
    for (const KeyUse& use : chains[c]) {
      const auto found = std::lower_bound(keys.begin(), keys.end(), use.key);
      out.uses[slot++] = {static_cast<std::uint32_t>(found - keys.begin()), use.net};
    }
  });

  out.made.resize(record.group_count);
  for (std::uint32_t c = 0; c < record.cluster_count; ++c) {
    const std::uint32_t own = asset.clusters()[record.first_cluster + c].own_group;
    if (own != format::kNone) out.made[own - record.first_group].push_back(c);
  }
  return out;
}

std::vector<EdgeUse> sum_chains(const MeshSurface& surface, std::span<const std::uint32_t> clusters) {
  std::vector<EdgeUse> uses;
  for (const std::uint32_t c : clusters) {
    const auto chain = surface.chain(c);
    uses.insert(uses.end(), chain.begin(), chain.end());
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) { return a.edge < b.edge; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < uses.size();) {
    EdgeUse sum = uses[i++];
    while (i < uses.size() && uses[i].edge == sum.edge) sum.net += uses[i++].net;
    if (sum.net != 0) uses[kept++] = sum;
  }
  uses.resize(kept);
  return uses;
}

std::string position_text(const MeshSurface& surface, std::uint32_t position) {
  const Vec3i& p = surface.positions[position];
  return "(" + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + ")";
}

std::string edge_text(const MeshSurface& surface, std::uint32_t edge) {
  return position_text(surface, surface.edges[edge][0]) + "-" + position_text(surface, surface.edges[edge][1]);
}

}  // namespace meshlode::judge
