// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/pixel_surface.h"

#include <algorithm>
#include <cmath>

namespace meshlode::draw {

namespace {

/// Unit, or nothing where there is no direction.
std::optional<Vec3d> unit(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0.0 && largest < 1e300)) return std::nullopt;
  const Vec3d s = v / largest;
  return s / std::sqrt(glm::dot(s, s));
}

}  // namespace

PixelWeights find_pixel_weights(const ClipVertex& a, const ClipVertex& b, const ClipVertex& c, double px, double py) {
  const Vec3d p(px, py, 1.0), va(a.x, a.y, a.w), vb(b.x, b.y, b.w), vc(c.x, c.y, c.w);
  Vec3d planes[3] = {glm::cross(vb, vc), glm::cross(vc, va), glm::cross(va, vb)};
  Vec3d weights(glm::dot(p, planes[0]), glm::dot(p, planes[1]), glm::dot(p, planes[2]));
  const double signed_sum = weights.x + weights.y + weights.z;
  PixelWeights out;
  if (std::abs(signed_sum) > 0.0 && std::abs(signed_sum) < 1e300) {
    const Vec3d share = weights / signed_sum;
    const Vec3d right(planes[0].x, planes[1].x, planes[2].x), down(planes[0].y, planes[1].y, planes[2].y);
    out.right = (right - share * (right.x + right.y + right.z)) / signed_sum;
    out.down = (down - share * (down.x + down.y + down.z)) / signed_sum;
  }
  if (signed_sum < 0.0) weights = -weights;
  for (int k = 0; k < 3; ++k) weights[k] = std::max(weights[k], 0.0);  // snapping moves edges by parts of a pixel
  const double sum = weights.x + weights.y + weights.z;
  if (sum > 0.0 && sum < 1e300) out.at = weights / sum;
  return out;
}

std::optional<TextureFootprint> PixelTextures::footprint(const TextureUse& use,
                                                         const std::array<std::uint8_t, 3>& triangle,
                                                         const PixelWeights& weights) const {
  for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
    if (mesh_.uv_set_source[set] != use.uv_set || attributes_.uvs[set].empty()) continue;
    TextureFootprint out;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::array<double, 3>& row = axis == 0 ? use.row_u : use.row_v;
      out.at[axis] = row[2];
      for (int k = 0; k < 3; ++k) {
        const Vec2f& uv = attributes_.uvs[set][triangle[static_cast<std::size_t>(k)]];
        const double value = row[0] * static_cast<double>(uv.x) + row[1] * static_cast<double>(uv.y);
        out.at[axis] += weights.at[k] * value;
        out.right[axis] += weights.right[k] * value;
        out.down[axis] += weights.down[k] * value;
      }
    }
    return out;
  }
  return std::nullopt;
}

void PixelTextures::tint(std::uint32_t material, const std::array<std::uint8_t, 3>& triangle,
                         const PixelWeights& weights, Rgb& color) const {
  if (textures_.is_empty() || !textures_.materials[material].base_color) return;
  const SampledTexture& texture = *textures_.materials[material].base_color;
  const auto where = footprint(texture.use, triangle, weights);
  if (!where) return;
  const auto texel = sample_texture(textures_.images[texture.image], texture.use.wrap_u, texture.use.wrap_v, *where);
  for (std::size_t k = 0; k < 3; ++k) color[k] *= texel[k];
}

bool PixelTextures::bends(std::uint32_t material) const {
  return !textures_.is_empty() && textures_.materials[material].normal.has_value();
}

Vec3d PixelTextures::bend(std::uint32_t material, const std::array<std::uint8_t, 3>& triangle,
                          const PixelWeights& weights, const Vec3d& normal, const Vec3d& right,
                          const Vec3d& down) const {
  const SampledTexture& texture = *textures_.materials[material].normal;
  const auto where = footprint(texture.use, triangle, weights);
  if (!where) return normal;
  // Along u and along v on the surface: the inverse of (u, v) over (right, down), up to the positive |determinant|.
  const double determinant = where->right[0] * where->down[1] - where->down[0] * where->right[1];
  if (!(std::abs(determinant) > 0.0)) return normal;
  const double sign = determinant < 0.0 ? -1.0 : 1.0;
  const Vec3d along_u = (right * where->down[1] - down * where->right[1]) * sign;
  const Vec3d along_v = (down * where->right[0] - right * where->down[0]) * sign;
  const auto tangent = unit(along_u - normal * glm::dot(normal, along_u));
  if (!tangent) return normal;
  // Green points up in the picture, and v down. Mirrored UVs turn the bitangent around.
  Vec3d bitangent = glm::cross(normal, *tangent);
  if (glm::dot(bitangent, along_v) > 0.0) bitangent = -bitangent;
  const auto texel = sample_texture(textures_.images[texture.image], texture.use.wrap_u, texture.use.wrap_v, *where);
  const double scale = textures_.materials[material].normal_scale;
  const Vec3d bent = *tangent * ((2.0 * texel[0] - 1.0) * scale) + bitangent * ((2.0 * texel[1] - 1.0) * scale) +
                     normal * (2.0 * texel[2] - 1.0);
  return unit(bent).value_or(normal);
}

}  // namespace meshlode::draw
