// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/metrics.h"

#include <cmath>

#include "judge/metrics/triangle_area.h"

namespace meshlode::judge {

Surface surface_of_clusters(const run::Asset& asset, std::span<const run::DecodedCluster> decoded, MeshId mesh,
                            std::span<const ClusterId> clusters) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const Vec3d origin(record.origin[0], record.origin[1], record.origin[2]);
  const double step = std::ldexp(static_cast<double>(record.grid.mantissa), record.grid.log2);
  Surface surface;
  for (const ClusterId id : clusters) {
    const run::DecodedCluster& cluster = decoded[id.value];
    const std::uint32_t base = static_cast<std::uint32_t>(surface.positions.size());
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      surface.positions.push_back(origin + Vec3d(cluster.position(v)) * step);
    }
    for (const auto& t : cluster.triangles) surface.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
  return surface;
}

Surface surface_of_source(const scene::SourceMesh& mesh) {
  Surface surface;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const auto base = static_cast<std::uint32_t>(surface.positions.size());
    surface.positions.insert(surface.positions.end(), primitive.positions.begin(), primitive.positions.end());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      const std::uint32_t* corner = &primitive.indices[i];
      const Vec3d* at = primitive.positions.data();
      if (!has_area(at[corner[0]], at[corner[1]], at[corner[2]])) continue;
      surface.triangles.push_back({base + corner[0], base + corner[1], base + corner[2]});
    }
  }
  return surface;
}

}  // namespace meshlode::judge
