// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/surface.h"

#include <algorithm>
#include <compare>
#include <string>
#include <utility>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/release.h"

namespace meshlode::judge {

namespace {

struct KeyUse {
  std::uint64_t key;
  std::int32_t net;
};

/// `positions`: of the cluster's vertices.
std::vector<KeyUse> cluster_chain(std::span<const std::array<std::uint8_t, 3>> triangles,
                                  std::span<const std::uint32_t> positions) {
  std::vector<KeyUse> uses;
  uses.reserve(triangles.size() * 3);
  for (const auto& triangle : triangles) {
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
  uses.resize(kept);
  return uses;
}

}  // namespace

SurfaceBuilder::SurfaceBuilder(const run::Asset& asset, MeshId mesh) : asset_(asset) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  surface_.mesh = mesh;
  surface_.first_cluster = record.first_cluster;
  surface_.cluster_count = record.cluster_count;
  surface_.first_group = record.first_group;
  surface_.group_count = record.group_count;
  surface_.first_vertex.assign(1, 0);
  surface_.first_triangle.assign(1, 0);
  std::size_t vertices = 0, triangles = 0;
  for (const format::ClusterRecord& cluster : asset.clusters().subspan(record.first_cluster, record.cluster_count)) {
    vertices += std::size_t{cluster.vertices_less_1} + 1;
    triangles += std::size_t{cluster.triangles_less_1} + 1;
  }
  keys_.reserve(vertices);
  surface_.vertex_attributes.reserve(vertices);
  surface_.triangle_vertices.reserve(triangles);
}

void SurfaceBuilder::add(const run::DecodedCluster& cluster) {
  for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
    const Vec3i p = cluster.position(v);
    keys_.push_back({p.x, p.y, p.z, static_cast<std::uint32_t>(keys_.size())});
    const std::int32_t* channels = &cluster.channels[std::size_t{v} * cluster.channel_count];
    const std::span attributes(channels + 3, cluster.channel_count - 3);
    surface_.vertex_attributes.push_back(
        hash64({reinterpret_cast<const std::uint8_t*>(attributes.data()), attributes.size_bytes()}));
  }
  surface_.triangle_vertices.insert(surface_.triangle_vertices.end(), cluster.triangles.begin(),
                                    cluster.triangles.end());
  surface_.first_vertex.push_back(static_cast<std::uint32_t>(keys_.size()));
  surface_.first_triangle.push_back(static_cast<std::uint32_t>(surface_.triangle_vertices.size()));
}

void SurfaceBuilder::name_positions() {
  std::sort(keys_.begin(), keys_.end());
  surface_.vertex_position.resize(keys_.size());
  for (const PositionKey& key : keys_) {
    const Vec3i p{key.x, key.y, key.z};
    if (surface_.positions.empty() || surface_.positions.back() != p) surface_.positions.push_back(p);
    surface_.vertex_position[key.vertex] = static_cast<std::uint32_t>(surface_.positions.size() - 1);
  }
  release(keys_);
}

void SurfaceBuilder::add_chains() {
  constexpr std::size_t kAtOnce = 4096;  // clusters
  MeshSurface& out = surface_;
  std::vector<KeyUse> uses;
  out.first_use.assign(1, 0);
  for (std::size_t first = 0; first < out.cluster_count; first += kAtOnce) {
    std::vector<std::vector<KeyUse>> chains(std::min<std::size_t>(kAtOnce, out.cluster_count - first));
    parallel_for_each_index(chains.size(), 16, [&](std::size_t i) {
      const std::size_t c = first + i;
      chains[i] = cluster_chain(out.triangles(static_cast<std::uint32_t>(c)),
                                std::span(out.vertex_position).subspan(out.first_vertex[c]));
    });
    for (const std::vector<KeyUse>& chain : chains) {
      uses.insert(uses.end(), chain.begin(), chain.end());
      out.first_use.push_back(static_cast<std::uint32_t>(uses.size()));
    }
  }
  std::vector<std::uint64_t> keys(uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) keys[i] = uses[i].key;
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  out.edges.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    out.edges.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key & 0xFFFFFFFFU)});
  }
  out.uses.resize(uses.size());
  parallel_for_each_index(uses.size(), kLoopGrain, [&](std::size_t i) {
    const auto found = std::lower_bound(keys.begin(), keys.end(), uses[i].key);
    out.uses[i] = {static_cast<std::uint32_t>(found - keys.begin()), uses[i].net};
  });
}

MeshSurface SurfaceBuilder::finish() {
  name_positions();
  add_chains();
  surface_.made.resize(surface_.group_count);
  for (std::uint32_t c = 0; c < surface_.cluster_count; ++c) {
    const std::uint32_t own = asset_.clusters()[surface_.first_cluster + c].own_group;
    if (own != format::kNone) surface_.made[own - surface_.first_group].push_back(c);
  }
  return std::move(surface_);
}

MeshSurface build_surface(const run::Asset& asset, MeshId mesh, std::span<const run::DecodedCluster> clusters) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  SurfaceBuilder builder(asset, mesh);
  for (const run::DecodedCluster& cluster : clusters.subspan(record.first_cluster, record.cluster_count)) {
    builder.add(cluster);
  }
  return builder.finish();
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
