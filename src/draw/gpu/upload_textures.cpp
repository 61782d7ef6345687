// SPDX-License-Identifier: GPL-3.0-or-later
// Textures on the device: one buffer of texels, mip levels and all, and tables that say where they lie.
#include <algorithm>

#include "base/try.h"
#include "draw/gpu/gpu_scene.h"
#include "draw/gpu/shaders/frame.h"
#include "draw/gpu/upload_table.h"

namespace meshlode::draw {

namespace {

GpuTextureUse use_of(const std::optional<SampledTexture>& texture) {
  GpuTextureUse out{};
  out.image = format::kNone;
  if (!texture) return out;
  std::copy(texture->use.row_u.begin(), texture->use.row_u.end(), out.rows);
  std::copy(texture->use.row_v.begin(), texture->use.row_v.end(), out.rows + 3);
  out.image = texture->image;
  out.uv_set = texture->use.uv_set;
  out.wrap[0] = static_cast<std::uint32_t>(texture->use.wrap_u);
  out.wrap[1] = static_cast<std::uint32_t>(texture->use.wrap_v);
  return out;
}

}  // namespace

Status upload_textures(Device& device, const TextureSet& textures, GpuScene& scene) {
  if (textures.is_empty()) return Ok{};
  std::uint64_t words = 0;
  std::vector<GpuTexture> table;
  for (const TextureImage& image : textures.images) {
    GpuTexture t{};
    t.width = image.width;
    t.height = image.height;
    t.levels = image.level_count();
    t.is_srgb = image.is_srgb ? 1 : 0;
    for (std::size_t level = 0; level < image.first.size(); ++level) {
      t.first[level] = static_cast<std::uint32_t>(words + image.first[level]);  // 2^31 texels at most: kMaxTextureBytes
    }
    words += image.texels.size();
    table.push_back(t);
  }
  TRY_LET(texels, device.make_buffer(words * 4, Memory::kDevice));
  std::uint64_t at = 0;
  for (const TextureImage& image : textures.images) {
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(image.texels.data()),
                                              image.texels.size() * 4);
    if (const Status done = device.upload(*texels, bytes, at); !done) return done;
    at += bytes.size();
  }
  std::vector<GpuSurface> surfaces;
  for (const SampledMaterial& material : textures.materials) {
    GpuSurface s{};
    s.base_color = use_of(material.base_color);
    s.normal = use_of(material.normal);
    s.normal_scale = static_cast<float>(material.normal_scale);
    surfaces.push_back(s);
  }
  TRY_LET(table_buffer, make_table(device, table));
  TRY_LET(surface_buffer, make_table(device, surfaces));
  scene.texels = *texels;
  scene.textures = *table_buffer;
  scene.surfaces = *surface_buffer;
  return Ok{};
}

}  // namespace meshlode::draw
