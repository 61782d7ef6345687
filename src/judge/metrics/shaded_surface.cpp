// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/shaded_surface.h"

#include <algorithm>
#include <limits>

#include "base/try.h"
#include "judge/metrics/drawn_triangles.h"
#include "judge/metrics/triangle_area.h"
#include "judge/metrics/triangle_corners.h"

namespace meshlode::judge {
namespace {

// Triangles from `first` on get vertices of their own with the geometric normal; without area it is unknown.
void shade_flat(ShadedSurface& out, std::size_t first_triangle) {
  Surface& s = out.surface;
  for (std::size_t i = first_triangle; i < s.triangles.size(); ++i) {
    const auto corners = s.triangles[i];
    const Vec3d a = s.positions[corners[0]], b = s.positions[corners[1]], c = s.positions[corners[2]];
    const Vec3d n = glm::cross(b - a, c - a);
    const double length = glm::length(n);
    const Vec3f normal = length > 0.0 ? Vec3f(n / length) : Vec3f(std::numeric_limits<float>::quiet_NaN());
    for (std::size_t k = 0; k < 3; ++k) {
      s.triangles[i][k] = static_cast<std::uint32_t>(s.positions.size());
      const Vec3d position = s.positions[corners[k]];
      s.positions.push_back(position);
      out.normals.push_back(normal);
      for (auto& set : out.uvs) {
        if (set.empty()) continue;
        const Vec2f uv = set[corners[k]];
        set.push_back(uv);
      }
    }
  }
}

/// The vertices of all primitives, without triangles; flat normals come with these.
ShadedSurface vertices_of_source(const scene::SourceMesh& mesh) {
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  ShadedSurface out;
  std::array<bool, scene::kMaxUvSets> has_uvs{};
  for (const scene::Primitive& p : mesh.primitives) {
    for (std::size_t n = 0; n < scene::kMaxUvSets; ++n) has_uvs[n] = has_uvs[n] || !p.uvs[n].empty();
  }
  for (const scene::Primitive& p : mesh.primitives) {
    std::vector<Vec3d>& positions = out.surface.positions;
    positions.insert(positions.end(), p.positions.begin(), p.positions.end());
    for (std::size_t n = 0; n < scene::kMaxUvSets; ++n) {
      if (!has_uvs[n]) continue;
      out.uvs[n].insert(out.uvs[n].end(), p.uvs[n].begin(), p.uvs[n].end());
      out.uvs[n].resize(positions.size(), Vec2f(unknown));
    }
    out.normals.insert(out.normals.end(), p.normals.begin(), p.normals.end());
    out.normals.resize(positions.size(), Vec3f(unknown));
  }
  return out;
}

/// Those triangles of all primitives, of which is_wanted(number among all, corners) is true.
template <class Wanted>
void add_triangles(const scene::SourceMesh& mesh, const Wanted& is_wanted, ShadedSurface& out) {
  std::uint32_t base = 0;
  std::size_t number = 0;
  for (const scene::Primitive& p : mesh.primitives) {
    const std::size_t first_triangle = out.surface.triangles.size();
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3, ++number) {
      const std::uint32_t* v = &p.indices[i];
      if (!is_wanted(number, p.positions[v[0]], p.positions[v[1]], p.positions[v[2]])) continue;
      out.surface.triangles.push_back({base + v[0], base + v[1], base + v[2]});
    }
    base += static_cast<std::uint32_t>(p.positions.size());
    if (p.normals.empty()) shade_flat(out, first_triangle);
  }
}

void add_triangles_with_area(const scene::SourceMesh& mesh, ShadedSurface& out) {
  add_triangles(
      mesh, [](std::size_t, const Vec3d& a, const Vec3d& b, const Vec3d& c) { return has_area(a, b, c); }, out);
}

}  // namespace

ShadedSurface shaded_surface_of_source(const scene::SourceMesh& mesh) {
  ShadedSurface out = vertices_of_source(mesh);
  add_triangles_with_area(mesh, out);
  return out;
}

ShadedSurface painted_surface_of_source(const scene::SourceMesh& mesh) {
  std::vector<TriangleCorners::Corners> corners;
  for (const scene::Primitive& p : mesh.primitives) {
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
      const std::uint32_t* v = &p.indices[i];
      corners.push_back({p.positions[v[0]], p.positions[v[1]], p.positions[v[2]]});
    }
  }
  const std::vector<std::uint8_t> is_drawn = find_drawn(corners);
  ShadedSurface out = vertices_of_source(mesh);
  add_triangles_with_area(mesh, out);
  const std::size_t drawn = out.surface.triangles.size();
  add_triangles(
      mesh,
      [&](std::size_t number, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        return is_drawn[number] != 0 && !has_area(a, b, c);
      },
      out);
  out.undrawn = out.surface.triangles.size() - drawn;
  return out;
}

ShadedSurface shaded_surface_of_clusters(const run::Asset& asset, std::span<const run::DecodedCluster> decoded,
                                         MeshId mesh, std::span<const ClusterId> clusters) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  ShadedSurface out;
  out.surface = surface_of_clusters(asset, decoded, mesh, clusters);
  run::ClusterAttributes attributes;
  for (const ClusterId id : clusters) {
    run::decode_attributes(record, decoded[id.value], attributes);
    out.normals.insert(out.normals.end(), attributes.normals.begin(), attributes.normals.end());
    for (std::uint32_t k = 0; k < record.uv_set_count; ++k) {
      auto& set = out.uvs[record.uv_set_source[k] % scene::kMaxUvSets];
      set.insert(set.end(), attributes.uvs[k].begin(), attributes.uvs[k].end());
    }
  }
  if (record.normal_mode == format::NormalMode::kFlat) {
    out.normals.resize(out.surface.positions.size());
    shade_flat(out, 0);
  }
  return out;
}

Result<ShadedSurface> shaded_surface_of_clusters(const run::Asset& asset, MeshId mesh,
                                                 std::span<const ClusterId> clusters) {
  const auto page_of = [&](ClusterId id) { return asset.groups()[asset.clusters()[id.value].coarser_group].page; };
  std::vector<ClusterId> order(clusters.begin(), clusters.end());
  std::stable_sort(order.begin(), order.end(), [&](ClusterId a, ClusterId b) { return page_of(a) < page_of(b); });
  std::vector<run::DecodedCluster> decoded(asset.clusters().size());  // of the cut alone: the others stay empty
  for (std::size_t i = 0; i < order.size();) {
    const std::uint32_t id = page_of(order[i]);
    TRY_LET(page, run::load_page(asset, PageId{id}));
    for (; i < order.size() && page_of(order[i]) == id; ++i) {
      run::decode_cluster(asset, *page, order[i], decoded[order[i].value]);
    }
  }
  return shaded_surface_of_clusters(asset, decoded, mesh, clusters);
}

}  // namespace meshlode::judge
