// SPDX-License-Identifier: GPL-3.0-or-later
// Colours a visibility buffer. Pixels are gathered by item, so that each visible cluster is decoded once and its pixels
// belong to one task.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/try.h"
#include "draw/raster/cut_pages.h"
#include "draw/raster/legend.h"
#include "draw/raster/pixel_surface.h"
#include "draw/raster/projection.h"

namespace meshlode::draw {

namespace {

constexpr Rgb kBackground{0.80, 0.83, 0.87};

/// The pixels of item i are pixels[first[i] … first[i + 1]).
struct ItemPixels {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> pixels;
};

ItemPixels gather_pixels(const VisibilityBuffer& visibility, std::size_t item_count) {
  ItemPixels out;
  out.first.assign(item_count + 1, 0);
  for (const std::uint32_t item : visibility.item) {
    if (item != VisibilityBuffer::kNothing) ++out.first[item + 1];
  }
  for (std::size_t i = 0; i < item_count; ++i) out.first[i + 1] += out.first[i];
  out.pixels.resize(out.first.back());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  for (std::size_t pixel = 0; pixel < visibility.item.size(); ++pixel) {
    const std::uint32_t item = visibility.item[pixel];
    if (item != VisibilityBuffer::kNothing) out.pixels[next[item]++] = static_cast<std::uint32_t>(pixel);
  }
  return out;
}

/// Takes normals of mesh space to world space up to their length: the cofactors of the 3×3 part, turned outwards again
/// where the instance is mirrored.
struct NormalTransform {
  Vec3d rows[3];

  explicit NormalTransform(const format::InstanceRecord& instance) {
    const double* m = instance.transform;
    const Vec3d r0(m[0], m[1], m[2]), r1(m[4], m[5], m[6]), r2(m[8], m[9], m[10]);
    const double sign = (instance.flags & format::kInstanceMirrored) != 0 ? -1.0 : 1.0;
    rows[0] = glm::cross(r1, r2) * sign;
    rows[1] = glm::cross(r2, r0) * sign;
    rows[2] = glm::cross(r0, r1) * sign;
  }
  [[nodiscard]] Vec3d apply(const Vec3d& n) const {
    const Vec3d w(glm::dot(rows[0], n), glm::dot(rows[1], n), glm::dot(rows[2], n));
    const double largest = std::max({std::abs(w.x), std::abs(w.y), std::abs(w.z)});
    if (!(largest > 0.0 && largest < 1e300)) return {0.0, 0.0, 0.0};
    const Vec3d s = w / largest;
    return s / std::sqrt(glm::dot(s, s));
  }
};

/// How a triangle's point changes along `change` of its weights, world, in units of the grid's step.
Vec3d surface_change(const format::InstanceRecord& instance, const run::DecodedCluster& cluster,
                     const std::array<std::uint8_t, 3>& triangle, const Vec3d& change) {
  const Vec3d a(cluster.position(triangle[0]));
  const Vec3d moved = (Vec3d(cluster.position(triangle[1])) - a) * change[1] +
                      (Vec3d(cluster.position(triangle[2])) - a) * change[2];  // changes sum up to 0
  const double* m = instance.transform;
  return {m[0] * moved.x + m[1] * moved.y + m[2] * moved.z, m[4] * moved.x + m[5] * moved.y + m[6] * moved.z,
          m[8] * moved.x + m[9] * moved.y + m[10] * moved.z};
}

Vec3d geometric_normal(const run::DecodedCluster& cluster, const std::array<std::uint8_t, 3>& triangle) {
  const Vec3d a(cluster.position(triangle[0]));
  return glm::cross(Vec3d(cluster.position(triangle[1])) - a, Vec3d(cluster.position(triangle[2])) - a);
}

/// How much light a white surface with this normal sends back, at most 0.9.
double lighting(const Projection& projection, const Vec3d& normal) {
  // From the upper left, behind the viewer; (-2, 3, 6) has length 7.
  const Vec3d light = (projection.right * -2.0 + projection.up * 3.0 - projection.forward * 6.0) / 7.0;
  return 0.16 + 0.07 * normal.y + 0.67 * std::max(0.0, glm::dot(normal, light));
}

struct ShadeContext {
  const run::Asset& asset;
  const Projection& projection;
  const VisibilityBuffer& visibility;
  View view;
  std::uint32_t level_count;
  const TextureSet& textures;
};

void shade_item(const ShadeContext& context, const CutPages& pages, const run::ClusterInstance& entry,
                std::span<const std::uint32_t> pixels, Image& image) {
  const run::Asset& asset = context.asset;
  const format::InstanceRecord& instance = asset.instances()[entry.instance.value];
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  run::DecodedCluster cluster;
  pages.decode(asset, entry.cluster, cluster);
  run::ClusterAttributes attributes;
  if (context.view == View::kShaded) run::decode_attributes(mesh, cluster, attributes);
  const GridToClip to_clip = make_grid_to_clip(context.projection, mesh, instance);
  const NormalTransform to_world(instance);
  const PixelTextures textures(context.textures, mesh, attributes);
  for (const std::uint32_t pixel : pixels) {
    const std::uint32_t triangle_index = context.visibility.triangle[pixel];
    const auto& triangle = cluster.triangles[triangle_index];
    const std::uint32_t x = pixel % image.width, y = pixel / image.width;
    const double px = x + 0.5 - 0.5 * image.width, py = y + 0.5 - 0.5 * image.height;
    const Vec3d to_viewer = direction_to_viewer(context.projection, px, py);
    const Vec3d face = to_world.apply(geometric_normal(cluster, triangle));
    const bool is_back = glm::dot(face, to_viewer) < 0.0;
    Vec3d normal = face;
    Rgb color{};
    switch (context.view) {
      case View::kClusters: color = hash_color(entry.cluster.value, 0x636C); break;
      case View::kTriangles: color = hash_color(entry.cluster.value, 0x10000 + triangle_index); break;
      case View::kLevels: color = level_color(asset.clusters()[entry.cluster.value].level, context.level_count); break;
      case View::kShaded: {
        const std::uint32_t material = cluster.triangle_material[triangle_index];
        for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<double>(asset.materials()[material].base_color[k]);
        const PixelWeights weights = find_pixel_weights(to_clip.project(cluster.position(triangle[0])),
                                                        to_clip.project(cluster.position(triangle[1])),
                                                        to_clip.project(cluster.position(triangle[2])), px, py);
        Vec3d sum(0.0), tint(0.0);
        for (int k = 0; k < 3; ++k) {
          const std::uint8_t vertex = triangle[static_cast<std::size_t>(k)];
          if (!attributes.normals.empty()) sum += Vec3d(attributes.normals[vertex]) * weights.at[k];
          if (!attributes.colors.empty()) tint += Vec3d(attributes.colors[vertex]) * weights.at[k];
        }
        if (!attributes.normals.empty()) normal = to_world.apply(sum);
        if (!attributes.colors.empty()) {
          for (int k = 0; k < 3; ++k) color[static_cast<std::size_t>(k)] *= tint[k];
        }
        textures.tint(material, triangle, weights, color);
        if (textures.bends(material)) {
          normal = textures.bend(material, triangle, weights, normal,
                                 surface_change(instance, cluster, triangle, weights.right),
                                 surface_change(instance, cluster, triangle, weights.down));
        }
        break;
      }
    }
    const double light = lighting(context.projection, is_back ? -normal : normal);
    for (std::size_t k = 0; k < 3; ++k) image.rgba[4 * std::size_t{pixel} + k] = to_display(color[k] * light);
  }
}

}  // namespace

Result<Image> shade_view(const run::Asset& asset, std::span<const run::ClusterInstance> cut, const run::Camera& camera,
                         const VisibilityBuffer& visibility, View view, const TextureSet& textures) {
  TRY_LET(projection, make_projection(camera));
  TRY_LET(pages, CutPages::load(asset, cut));

  Image image;
  image.width = visibility.width;
  image.height = visibility.height;
  image.rgba.resize(4 * visibility.pixel_count());
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    image.rgba[i] = i % 4 == 3 ? std::uint8_t{255} : to_display(kBackground[i % 4]);
  }
  std::uint32_t level_count = 1;
  for (const format::MeshRecord& mesh : asset.meshes()) level_count = std::max(level_count, mesh.level_count);

  const ItemPixels by_item = gather_pixels(visibility, cut.size());
  const ShadeContext context{asset, *projection, visibility, view, level_count, textures};
  parallel_for_each_index(cut.size(), 4, [&](std::size_t item) {
    const std::span<const std::uint32_t> pixels =
        std::span(by_item.pixels).subspan(by_item.first[item], by_item.first[item + 1] - by_item.first[item]);
    if (!pixels.empty()) shade_item(context, *pages, cut[item], pixels, image);
  });
  if (view == View::kLevels) draw_level_legend(image, level_count);
  return image;
}

}  // namespace meshlode::draw
