// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/cut_geometry.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/try.h"
#include "run/unpack/unpack.h"

namespace meshlode::app {
namespace {

/// All vertices of the cut one after another, cluster by cluster, and its triangles as indices into them.
struct Soup {
  std::uint32_t channel_count = 0;
  std::vector<std::int32_t> channels;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> triangle_material;

  [[nodiscard]] std::size_t vertex_count() const { return channel_count == 0 ? 0 : channels.size() / channel_count; }
  [[nodiscard]] std::span<const std::int32_t> vertex(std::size_t i) const {
    return std::span(channels).subspan(i * channel_count, channel_count);
  }
};

Result<Soup> decode_cut(const run::Asset& asset, std::uint32_t channel_count, std::span<const ClusterId> cut) {
  Soup soup;
  soup.channel_count = channel_count;
  std::uint32_t loaded = format::kNone;  // pages hold contiguous clusters: in ascending order each is loaded once
  std::optional<run::PageBytes> page;
  run::DecodedCluster cluster;
  for (const ClusterId id : cut) {
    const format::ClusterRecord& record = asset.clusters()[id.value];
    const std::uint32_t page_id = asset.groups()[record.coarser_group].page;
    if (page_id != loaded) {
      TRY_LET(bytes, run::load_page(asset, PageId(page_id)));
      page.emplace(std::move(*bytes));
      loaded = page_id;
    }
    run::decode_cluster(asset, *page, id, cluster);
    const auto base = static_cast<std::uint32_t>(soup.vertex_count());
    soup.channels.insert(soup.channels.end(), cluster.channels.begin(), cluster.channels.end());
    for (const auto& t : cluster.triangles) soup.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    soup.triangle_material.insert(soup.triangle_material.end(), cluster.triangle_material.begin(),
                                  cluster.triangle_material.end());
  }
  return soup;
}

/// For every vertex the first vertex with the same integers.
std::vector<std::uint32_t> find_representatives(const Soup& soup) {
  std::vector<std::uint32_t> order(soup.vertex_count());
  std::iota(order.begin(), order.end(), 0U);
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    const auto va = soup.vertex(a);
    const auto vb = soup.vertex(b);
    return std::lexicographical_compare_three_way(va.begin(), va.end(), vb.begin(), vb.end());
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto c = compare(a, b);
    return c != 0 ? c < 0 : a < b;
  });
  std::vector<std::uint32_t> representative(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && compare(order[i - 1], order[i]) == 0;
    representative[order[i]] = is_same ? representative[order[i - 1]] : order[i];
  }
  return representative;
}

}  // namespace

Result<std::vector<CutPrimitive>> gather_cut(const run::Asset& asset, MeshId mesh, std::span<const ClusterId> cut) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<ClusterId> clusters(cut.begin(), cut.end());
  std::sort(clusters.begin(), clusters.end());
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const std::uint32_t id = clusters[i].value;
    const bool is_member = id >= record.first_cluster && id - record.first_cluster < record.cluster_count;
    if (!is_member || (i > 0 && clusters[i] == clusters[i - 1])) {
      return Error{ErrorCode::kUsage, "mesh " + std::to_string(mesh.value),
                   "cluster " + std::to_string(id) + (is_member ? " is in the cut twice" : " is not of this mesh")};
    }
  }
  TRY_LET(decoded, decode_cut(asset, format::channel_count(record), clusters));
  const Soup& soup = *decoded;
  const std::vector<std::uint32_t> representative = find_representatives(soup);

  std::vector<std::uint32_t> triangles(soup.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0U);
  std::stable_sort(triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
    return soup.triangle_material[a] < soup.triangle_material[b];
  });

  std::vector<CutPrimitive> primitives;
  // Which primitive numbered a representative last, and as what: no clearing between primitives.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> numbered(soup.vertex_count(), {format::kNone, 0U});
  for (const std::uint32_t t : triangles) {
    const MaterialId material(soup.triangle_material[t]);
    if (primitives.empty() || primitives.back().material != material) {
      primitives.emplace_back().material = material;
      primitives.back().vertices.channel_count = soup.channel_count;
    }
    CutPrimitive& primitive = primitives.back();
    const auto primitive_index = static_cast<std::uint32_t>(primitives.size() - 1);
    for (const std::uint32_t corner : soup.triangles[t]) {
      const std::uint32_t vertex = representative[corner];
      auto& [owner, index] = numbered[vertex];
      if (owner != primitive_index) {
        owner = primitive_index;
        index = primitive.vertices.vertex_count++;
        const auto channels = soup.vertex(vertex);
        primitive.vertices.channels.insert(primitive.vertices.channels.end(), channels.begin(), channels.end());
      }
      primitive.indices.push_back(index);
    }
  }
  return primitives;
}

}  // namespace meshlode::app
