// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/try.h"
#include "judge/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "judge/metrics/triangle_area.h"

namespace meshlode::judge {

namespace {

/// Where each of the clusters goes in their surface; one more at the end.
struct Place {
  std::uint32_t vertex = 0, triangle = 0;
};

std::vector<Place> places_of(const run::Asset& asset, std::span<const ClusterId> clusters) {
  std::vector<Place> places(clusters.size() + 1);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const format::ClusterRecord& record = asset.clusters()[clusters[i].value];
    places[i + 1] = {places[i].vertex + record.vertices_less_1 + 1U, places[i].triangle + record.triangles_less_1 + 1U};
  }
  return places;
}

Surface surface_with_room(const Place& end) {
  Surface surface;
  surface.positions.resize(end.vertex);
  surface.triangles.resize(end.triangle);
  return surface;
}

void put_cluster(const format::MeshRecord& mesh, const run::DecodedCluster& cluster, const Place& place, Surface& out) {
  const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
  const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
  for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
    out.positions[place.vertex + v] = origin + Vec3d(cluster.position(v)) * step;
  }
  for (std::size_t t = 0; t < cluster.triangles.size(); ++t) {
    const auto& corners = cluster.triangles[t];
    out.triangles[place.triangle + t] = {place.vertex + corners[0], place.vertex + corners[1],
                                         place.vertex + corners[2]};
  }
}

}  // namespace

Surface surface_of_clusters(const run::Asset& asset, std::span<const run::DecodedCluster> decoded, MeshId mesh,
                            std::span<const ClusterId> clusters) {
  const std::vector<Place> places = places_of(asset, clusters);
  Surface surface = surface_with_room(places.back());
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    put_cluster(asset.meshes()[mesh.value], decoded[clusters[i].value], places[i], surface);
  }
  return surface;
}

Result<Surface> surface_of_clusters(const run::Asset& asset, MeshId mesh, std::span<const ClusterId> clusters) {
  const std::vector<Place> places = places_of(asset, clusters);
  Surface surface = surface_with_room(places.back());
  const auto page_of = [&](std::size_t i) {
    return asset.groups()[asset.clusters()[clusters[i].value].coarser_group].page;
  };
  std::vector<std::uint32_t> order(clusters.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return page_of(a) < page_of(b); });
  run::DecodedCluster cluster;
  for (std::size_t i = 0; i < order.size();) {
    const std::uint32_t id = page_of(order[i]);
    TRY_LET(page, run::load_page(asset, PageId{id}));
    for (; i < order.size() && page_of(order[i]) == id; ++i) {
      run::decode_cluster(asset, *page, clusters[order[i]], cluster);
      put_cluster(asset.meshes()[mesh.value], cluster, places[order[i]], surface);
    }
  }
  return surface;
}

Surface surface_of_source(const scene::SourceMesh& mesh, std::vector<std::uint32_t>* primitives) {
  Surface surface;
  std::size_t vertices = 0, corners = 0;
  for (const scene::Primitive& primitive : mesh.primitives) {
    vertices += primitive.positions.size();
    corners += primitive.indices.size();
  }
  surface.positions.reserve(vertices);
  surface.triangles.reserve(corners / 3);
  for (const scene::Primitive& primitive : mesh.primitives) {
    const auto base = static_cast<std::uint32_t>(surface.positions.size());
    surface.positions.insert(surface.positions.end(), primitive.positions.begin(), primitive.positions.end());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      const std::uint32_t* corner = &primitive.indices[i];
      const Vec3d* at = primitive.positions.data();
      if (!has_area(at[corner[0]], at[corner[1]], at[corner[2]])) continue;
      surface.triangles.push_back({base + corner[0], base + corner[1], base + corner[2]});
      if (primitives != nullptr) primitives->push_back(static_cast<std::uint32_t>(&primitive - mesh.primitives.data()));
    }
  }
  return surface;
}

}  // namespace meshlode::judge
