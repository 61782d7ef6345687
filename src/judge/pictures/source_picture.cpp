// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/source_picture.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "draw/raster/coverage.h"
#include "draw/raster/screen.h"
#include "judge/metrics/shaded_surface.h"

namespace meshlode::judge {

namespace {

constexpr std::size_t kChunkTriangles = 4096;
constexpr std::size_t kBatchChunks = 64;  ///< about 13 MB of screen triangles

struct Chunk {
  std::uint32_t instance = 0;
  std::size_t first = 0, count = 0;
};

void project_chunk(const run::Asset& asset, const SourceSurface& source, const draw::Projection& projection,
                   const Chunk& chunk, draw::ScreenSoup& out) {
  const format::InstanceRecord& instance = asset.instances()[chunk.instance];
  const bool is_mirrored = (instance.flags & format::kInstanceMirrored) != 0;
  for (std::size_t t = chunk.first; t < chunk.first + chunk.count; ++t) {
    const bool is_double_sided = !source.double_sided.empty() && source.double_sided[t] != 0;
    const draw::Culling culling = is_double_sided ? draw::Culling::kNone
                                  : is_mirrored   ? draw::Culling::kCounterClockwise
                                                  : draw::Culling::kClockwise;
    const auto& [a, b, c] = source.surface.triangles[t];
    draw::add_triangle({project_source(projection, instance, source.surface.positions[a]),
                        project_source(projection, instance, source.surface.positions[b]),
                        project_source(projection, instance, source.surface.positions[c])},
                       culling, {chunk.instance, static_cast<std::uint32_t>(t)}, projection.size, out);
  }
}

}  // namespace

std::vector<SourceSurface> source_surfaces(const scene::Scene& scene, bool have_trees) {
  std::vector<SourceSurface> out;
  out.reserve(scene.meshes.size());
  for (const scene::SourceMesh& mesh : scene.meshes) {
    std::vector<std::uint32_t> primitives;
    SourceSurface& part = out.emplace_back(surface_of_source(mesh, &primitives), have_trees);
    for (const std::uint32_t primitive : primitives) {
      const std::uint32_t material = mesh.primitives[primitive].material.value;
      part.material.push_back(material);
      part.double_sided.push_back(material < scene.materials.size() && scene.materials[material].double_sided ? 1 : 0);
    }
  }
  return out;
}

std::vector<PaintedSurface> painted_surfaces(const run::Asset& asset, const scene::Scene& scene) {
  std::vector<PaintedSurface> out;
  if (asset.chosen_promise() == format::Promise::kPosition) return out;
  const std::size_t count = std::min(asset.meshes().size(), scene.meshes.size());
  out.reserve(count);
  for (std::size_t m = 0; m < count; ++m) {
    const ProductScales scales = scales_of(asset, MeshId(m), asset.chosen_promise());
    const ShadedSurface truth = painted_surface_of_source(scene.meshes[m]);
    out.push_back({scales, ProductSurface(truth, scales), rounding_of(truth, scales)});
  }
  return out;
}

draw::ClipVertex project_source(const draw::Projection& projection, const format::InstanceRecord& instance,
                                const Vec3d& position) {
  const double* m = instance.transform;
  Vec3d p(0.0);
  for (int row = 0; row < 3; ++row) {
    const double* r = m + 4 * row;
    p[row] = ((r[0] * position.x + r[1] * position.y) + r[2] * position.z) + (r[3] - projection.eye[row]);
  }
  draw::ClipVertex out;
  out.x = glm::dot(projection.right, p) * projection.pixels_per_unit;
  out.y = -glm::dot(projection.up, p) * projection.pixels_per_unit;
  const double distance = glm::dot(projection.forward, p);
  if (projection.is_orthographic) {
    const double range = projection.far_distance - projection.near_distance;
    out.w = 1.0;
    out.z = (projection.far_distance - distance) / range;
  } else {
    out.w = distance;
    out.z = projection.near_distance;
  }
  return out;
}

draw::VisibilityBuffer draw_source(const run::Asset& asset, std::span<const SourceSurface> source,
                                   const draw::Projection& projection) {
  std::vector<Chunk> chunks;
  for (std::size_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    if ((instance.flags & format::kInstanceSingular) != 0 || instance.mesh >= source.size()) continue;
    const std::size_t count = source[instance.mesh].surface.triangles.size();
    for (std::size_t first = 0; first < count; first += kChunkTriangles) {
      chunks.push_back({static_cast<std::uint32_t>(i), first, std::min(kChunkTriangles, count - first)});
    }
  }
  draw::VisibilityBuffer out = draw::make_visibility_buffer(projection.size.width, projection.size.height);
  for (std::size_t first = 0; first < chunks.size(); first += kBatchChunks) {
    std::vector<draw::ScreenSoup> parts(std::min(kBatchChunks, chunks.size() - first));
    parallel_for_each_index(parts.size(), 1, [&](std::size_t i) {
      const Chunk& chunk = chunks[first + i];
      project_chunk(asset, source[asset.instances()[chunk.instance].mesh], projection, chunk, parts[i]);
    });
    for (const draw::ScreenSoup& part : parts) draw::draw_soup(part, out);
  }
  return out;
}

}  // namespace meshlode::judge
