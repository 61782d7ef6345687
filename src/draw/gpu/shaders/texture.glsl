// SPDX-License-Identifier: MIT
// src/draw/raster/pixel_surface.cpp and src/draw/textures/texture_image.cpp again, in floats behind exact derivatives: textures lie in
// a buffer with their mip levels, and are filtered here. Only resolve.comp compiled with TEXTURES has it.
#ifdef TEXTURES

struct Footprint {
  dvec2 at;          // UV
  vec2 right, down;  // its change to the next pixels
  bool is_there;
};

float linear_of_srgb(float c) { return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4); }

vec4 load_texel(uint image, uint level, uvec2 at) {
  const uint width = max(1u, frame.textures.at[image].width >> level);
  const vec4 c = unpackUnorm4x8(frame.texels.at[frame.textures.at[image].first[level] + at.y * width + at.x]);
  if (frame.textures.at[image].is_srgb == 0u) return c;
  return vec4(linear_of_srgb(c.r), linear_of_srgb(c.g), linear_of_srgb(c.b), c.a);
}

uint wrap_around(int i, int count, uint wrap) {
  if (wrap == WRAP_CLAMP) return uint(clamp(i, 0, count - 1));
  const int period = wrap == WRAP_MIRROR ? 2 * count : count;
  const int rest = i < 0 ? period - 1 - (-1 - i) % period : i % period;
  return uint(rest < count ? rest : period - 1 - rest);
}

vec4 sample_level(GpuTextureUse use, uint level, dvec2 uv) {
  const uvec2 size = max(uvec2(frame.textures.at[use.image].width, frame.textures.at[use.image].height) >> level, 1u);
  uvec2 low, high;
  vec2 share;
  for (uint axis = 0u; axis < 2u; ++axis) {
    double place = uv[axis] * double(size[axis]) - 0.5lf;
    if (!(abs(place) <= 1e9lf)) place = 0.0lf;
    const double whole = floor(place);
    share[axis] = float(place - whole);
    low[axis] = wrap_around(int(whole), int(size[axis]), use.wrap[axis]);
    high[axis] = wrap_around(int(whole) + 1, int(size[axis]), use.wrap[axis]);
  }
  const vec4 top = mix(load_texel(use.image, level, low), load_texel(use.image, level, uvec2(high.x, low.y)), share.x);
  const vec4 bottom = mix(load_texel(use.image, level, uvec2(low.x, high.y)), load_texel(use.image, level, high), share.x);
  return mix(top, bottom, share.y);
}

vec4 sample_texture(GpuTextureUse use, Footprint where) {
  const vec2 size = vec2(frame.textures.at[use.image].width, frame.textures.at[use.image].height);
  const vec2 right = where.right * size, down = where.down * size;
  const float longest2 = max(dot(right, right), dot(down, down)), most = float(frame.textures.at[use.image].levels - 1u);
  const float level = longest2 > 1.0 ? min(0.5 * log2(longest2), most) : 0.0;
  const uint fine = uint(level);
  const vec4 c = sample_level(use, fine, where.at);
  const float share = level - float(fine);
  return share == 0.0 ? c : mix(c, sample_level(use, fine + 1u, where.at), share);
}

Footprint footprint(GpuTextureUse use, uint mesh, ClusterData data, uvec3 corners, dvec3 weight, dvec3 right, dvec3 down) {
  Footprint f;
  f.is_there = false;
  if (use.image == kNone) return f;
  for (uint set = 0u; set < data.uv_set_count; ++set) {
    if ((frame.mesh_uvs.at[mesh].source >> (8u * set) & 255u) != use.uv_set) continue;
    const double unit = power_of_two(frame.mesh_uvs.at[mesh].log2[set]);
    f.at = dvec2(use.rows[2], use.rows[5]);
    dvec2 to_right = dvec2(0.0lf), to_down = dvec2(0.0lf);
    for (uint k = 0u; k < 3u; ++k) {
      const dvec2 raw = dvec2(lode_uv(data, set, corners[k], lode_raw_position(data, corners[k]))) * unit;
      const dvec2 uv = dvec2(use.rows[0] * raw.x + use.rows[1] * raw.y, use.rows[3] * raw.x + use.rows[4] * raw.y);
      f.at += weight[k] * uv;
      to_right += right[k] * uv;
      to_down += down[k] * uv;
    }
    f.right = vec2(to_right);
    f.down = vec2(to_down);
    f.is_there = true;
    return f;
  }
  return f;
}

dvec3 to_world_direction(uint instance, dvec3 v) {
  dvec3 world;
  for (uint row = 0u; row < 3u; ++row) {
    world[row] = frame.instances.at[instance].transform[4u * row] * v.x + frame.instances.at[instance].transform[4u * row + 1u] * v.y +
                 frame.instances.at[instance].transform[4u * row + 2u] * v.z;
  }
  return world;
}

// Unit, or zero where there is no direction.
vec3 unit_or_zero(dvec3 v) {
  const double largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
  return largest > 0.0lf && largest < 1e300lf ? normalize(vec3(v / largest)) : vec3(0.0);
}

// A normal map's normal: `right` and `down` are the changes of the surface's point, world.
vec3 bend_normal(GpuTextureUse use, float scale, Footprint where, vec3 normal, dvec3 right, dvec3 down) {
  const double determinant = double(where.right.x) * double(where.down.y) - double(where.down.x) * double(where.right.y);
  if (!(abs(determinant) > 0.0lf)) return normal;
  const double side = determinant < 0.0lf ? -1.0lf : 1.0lf;
  const dvec3 along_u = (right * double(where.down.y) - down * double(where.right.y)) * side;
  const dvec3 along_v = (down * double(where.right.x) - right * double(where.down.x)) * side;
  const vec3 tangent = unit_or_zero(along_u - dvec3(normal) * dot(dvec3(normal), along_u));
  if (tangent == vec3(0.0)) return normal;
  vec3 bitangent = cross(normal, tangent);
  if (dot(dvec3(bitangent), along_v) > 0.0lf) bitangent = -bitangent;
  const vec3 t = 2.0 * sample_texture(use, where).xyz - 1.0;
  const vec3 bent = unit_or_zero(dvec3(tangent * (t.x * scale) + bitangent * (t.y * scale) + normal * t.z));
  return bent == vec3(0.0) ? normal : bent;
}

#endif
