// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/source_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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

constexpr int kMaskUvLog2 = -16;  ///< a sixteenth of a texel where a texture has 4096
constexpr float kMostMaskUv = 32767.0F;

bool stores_uvs(const format::MeshRecord& mesh, std::uint32_t set) {
  const auto* end = mesh.uv_set_source + mesh.uv_set_count;
  return std::find(mesh.uv_set_source, end, set) != end;
}

/// As find_mask(), of a triangle of the source. What the asset does not store it cannot be masked by, and the source
/// is not either.
std::optional<draw::MaskedTriangle> find_source_mask(const draw::AlphaMasks& masks, const format::MeshRecord& mesh,
                                                     const SourceSurface& source, std::size_t triangle,
                                                     const std::array<draw::ClipVertex, 3>& clip) {
  if (masks.is_empty() || source.alpha.empty() || source.material[triangle] >= masks.of_material.size()) return {};
  const std::uint32_t index = masks.of_material[source.material[triangle]];
  if (index == format::kNone) return {};
  draw::MaskedTriangle out;
  out.mask = &masks.masks[index];
  const std::uint32_t set = out.mask->uv_set;
  const bool has_image = out.mask->image != format::kNone && set < scene::kMaxUvSets && stores_uvs(mesh, set);
  if (has_image) {
    out.image = &masks.images[out.mask->image];
    out.uv_log2 = kMaskUvLog2;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = source.surface.triangles[triangle][k];
    out.x[k] = clip[k].x;
    out.y[k] = clip[k].y;
    out.w[k] = clip[k].w;
    if (mesh.has_color != 0) {
      out.alpha[k] = static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(source.alpha[vertex], 0.0F, 1.0F)));
    }
    if (!has_image) continue;
    const Vec2f uv = source.uvs[set][vertex];
    const auto on_grid = [](float value) {
      if (!(std::abs(value) <= kMostMaskUv)) return 0;
      return static_cast<std::int32_t>(std::lround(std::ldexp(static_cast<double>(value), -kMaskUvLog2)));
    };
    out.u[k] = on_grid(uv.x);
    out.v[k] = on_grid(uv.y);
  }
  return out;
}

void project_chunk(const run::Asset& asset, const SourceSurface& source, const draw::Projection& projection,
                   const draw::AlphaMasks& masks, const SourceDrawing& drawing, const Chunk& chunk,
                   draw::ScreenSoup& out) {
  const format::InstanceRecord& instance = asset.instances()[chunk.instance];
  const bool is_mirrored = (instance.flags & format::kInstanceMirrored) != 0;
  for (std::size_t t = chunk.first; t < chunk.first + chunk.count; ++t) {
    if (drawing.material && *drawing.material != (source.material.empty() ? 0 : source.material[t])) continue;
    const bool is_double_sided =
        drawing.sides == draw::Sides::kBoth || (!source.double_sided.empty() && source.double_sided[t] != 0);
    const draw::Culling culling = is_double_sided ? draw::Culling::kNone
                                  : is_mirrored   ? draw::Culling::kCounterClockwise
                                                  : draw::Culling::kClockwise;
    std::array<draw::ClipVertex, 3> clip;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& position = source.surface.positions[source.surface.triangles[t][k]];
      clip[k] = project_source(projection, instance, position);
    }
    draw::TriangleKey key{chunk.instance, static_cast<std::uint32_t>(t)};
    if (const auto mask = find_source_mask(masks, asset.meshes()[instance.mesh], source, t, clip)) {
      key.mask = static_cast<std::uint32_t>(out.masked.size());
      out.masked.push_back(*mask);
    }
    draw::add_triangle(clip, culling, key, projection.size, out);
  }
}

/// What masks read: attributes of each vertex of surface_of_source(), where some material of the mesh is masked.
void add_mask_attributes(const scene::Scene& scene, const scene::SourceMesh& mesh, SourceSurface& out) {
  const bool is_masked =
      std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const scene::Primitive& primitive) {
        const std::uint32_t material = primitive.material.value;
        return material < scene.materials.size() && scene.materials[material].alpha_mode == scene::AlphaMode::kMask;
      });
  if (!is_masked) return;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const std::size_t end = out.alpha.size() + primitive.positions.size();
    for (const Vec4f& color : primitive.colors) out.alpha.push_back(color.w);
    out.alpha.resize(end, 1.0F);
    for (std::size_t set = 0; set < scene::kMaxUvSets; ++set) {
      out.uvs[set].insert(out.uvs[set].end(), primitive.uvs[set].begin(), primitive.uvs[set].end());
      out.uvs[set].resize(end, Vec2f(0.0F));
    }
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
    add_mask_attributes(scene, mesh, part);
  }
  return out;
}

std::vector<PaintedSurface> painted_surfaces(const run::Asset& asset, const scene::Scene& scene) {
  std::vector<PaintedSurface> out;
  if (asset.promise() == format::Promise::kPosition) return out;
  const std::size_t count = std::min(asset.meshes().size(), scene.meshes.size());
  out.reserve(count);
  for (std::size_t m = 0; m < count; ++m) {
    const ProductScales scales = scales_of(asset, MeshId(m), asset.promise());
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
                                   const draw::Projection& projection, const draw::AlphaMasks& masks,
                                   const SourceDrawing& drawing) {
  std::vector<Chunk> chunks;
  for (std::size_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    if ((instance.flags & format::kInstanceSingular) != 0 || instance.mesh >= source.size()) continue;
    if (drawing.mesh && *drawing.mesh != instance.mesh) continue;
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
      project_chunk(asset, source[asset.instances()[chunk.instance].mesh], projection, masks, drawing, chunk, parts[i]);
    });
    for (const draw::ScreenSoup& part : parts) draw::draw_soup(part, out);
  }
  return out;
}

}  // namespace meshlode::judge
