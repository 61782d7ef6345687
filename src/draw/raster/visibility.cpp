// SPDX-License-Identifier: GPL-3.0-or-later
// A cut becomes a visibility buffer: decode, project, snap, draw, in batches of clusters so that memory stays bounded.
#include <algorithm>
#include <optional>

#include "base/parallel.h"
#include "base/try.h"
#include "draw/raster/alpha_cutoff.h"
#include "draw/raster/coverage.h"
#include "draw/raster/cut_pages.h"
#include "draw/raster/projection.h"

namespace meshlode::draw {

namespace {

constexpr std::size_t kBatchClusters = 2048;  ///< about 12 MB of screen triangles

void project_cluster(const run::Asset& asset, const AlphaMasks& masks, const Projection& projection,
                     const CutPages& pages, Sides sides, const run::ClusterInstance& entry, std::uint32_t item,
                     ScreenSoup& out) {
  const format::InstanceRecord& instance = asset.instances()[entry.instance.value];
  if ((instance.flags & format::kInstanceSingular) != 0) return;
  run::DecodedCluster cluster;
  pages.decode(asset, entry.cluster, cluster);
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  const GridToClip to_clip = make_grid_to_clip(projection, mesh, instance);
  std::vector<ClipVertex> clip(cluster.vertex_count);
  std::vector<std::optional<ScreenVertex>> snapped(cluster.vertex_count);
  for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
    clip[v] = to_clip.project(cluster.position(v));
    snapped[v] = snap_vertex(clip[v], projection.size);
  }
  const bool is_mirrored = (instance.flags & format::kInstanceMirrored) != 0;
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    const auto [a, b, c] = cluster.triangles[t];
    const bool is_double_sided =
        sides == Sides::kBoth || asset.materials()[cluster.triangle_material[t]].double_sided != 0;
    const Culling culling = is_double_sided ? Culling::kNone
                            : is_mirrored   ? Culling::kCounterClockwise
                                            : Culling::kClockwise;
    TriangleKey key{item, t};
    const std::size_t drawn = out.triangles.size() + out.polygons.size();
    const auto mask = find_mask(masks, mesh, cluster, t, to_clip);
    if (mask) key.mask = static_cast<std::uint32_t>(out.masked.size());
    if (snapped[a] && snapped[b] && snapped[c]) {
      add_snapped(*snapped[a], *snapped[b], *snapped[c], culling, key, projection.size, out);
    } else {
      add_triangle({clip[a], clip[b], clip[c]}, culling, key, projection.size, out);
    }
    if (mask && out.triangles.size() + out.polygons.size() > drawn) out.masked.push_back(*mask);
  }
}

void append(ScreenSoup& out, const ScreenSoup& part) {
  const auto first_mask = static_cast<std::uint32_t>(out.masked.size());
  const auto add = [&](auto& to, const auto& from) {
    const std::size_t first = to.size();
    to.insert(to.end(), from.begin(), from.end());
    for (std::size_t i = first; first_mask > 0 && i < to.size(); ++i) {
      if (to[i].key.mask != TriangleKey::kOpaque) to[i].key.mask += first_mask;
    }
  };
  add(out.triangles, part.triangles);
  add(out.polygons, part.polygons);
  out.masked.insert(out.masked.end(), part.masked.begin(), part.masked.end());
  out.not_finite += part.not_finite;
}

}  // namespace

VisibilityBuffer make_visibility_buffer(std::uint32_t width, std::uint32_t height) {
  VisibilityBuffer buffer;
  buffer.width = width;
  buffer.height = height;
  const std::size_t pixels = std::size_t{width} * height;
  buffer.depth.assign(pixels, 0);
  buffer.item.assign(pixels, VisibilityBuffer::kNothing);
  buffer.triangle.assign(pixels, VisibilityBuffer::kNothing);
  return buffer;
}

Result<VisibilityBuffer> draw_cut(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                  const run::Camera& camera, const AlphaMasks& masks, Sides sides) {
  TRY_LET(projection, make_projection(camera));
  projection->far_distance = scene_depth(asset, *projection);
  TRY_LET(pages, CutPages::load(asset, cut));

  VisibilityBuffer buffer = make_visibility_buffer(camera.width, camera.height);
  std::vector<ScreenSoup> parts;
  for (std::size_t first = 0; first < cut.size(); first += kBatchClusters) {
    const std::size_t count = std::min(kBatchClusters, cut.size() - first);
    parts.assign(count, {});
    parallel_for_each_index(count, 8, [&](std::size_t i) {
      project_cluster(asset, masks, *projection, *pages, sides, cut[first + i], static_cast<std::uint32_t>(first + i),
                      parts[i]);
    });
    ScreenSoup soup;
    for (const ScreenSoup& part : parts) append(soup, part);
    draw_soup(soup, buffer);
  }
  return buffer;
}

Result<Image> render_cut(const run::Asset& asset, std::span<const run::ClusterInstance> cut, const run::Camera& camera,
                         View view, const AlphaMasks& masks) {
  TRY_LET(visibility, draw_cut(asset, cut, camera, masks));
  return shade_view(asset, cut, camera, *visibility, view);
}

}  // namespace meshlode::draw
