// SPDX-License-Identifier: MIT
// From the visibility buffer to colours, a pixel an invocation: the triangle is decoded again, its corners are projected
// again, and the pixel's own barycentrics (perspective-correct, Heckbert 1989) weigh normals, colours and UVs; their
// derivatives are the map's own, so textures need no neighbouring pixel. The views are those of src/draw/raster/shade.cpp, and
// those that only a GPU's frame has.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "page.glsl"
#include "screen.glsl"
#include "texture.glsl"

layout(constant_id = 3) const uint kView = 0u;

const vec3 kBackground = vec3(0.80, 0.83, 0.87);

// A bright colour that depends on nothing but the numbers: draw/raster/legend.cpp.
vec3 hash_color(uint x, uint y) {
  uint64_t z = ((uint64_t(x) << 32) | uint64_t(y)) + 0x9E3779B97F4A7C15ul;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ul;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBul;
  z ^= z >> 31;
  const float hue = float(uint(z) & 0xFFFFu) / 65536.0 * 6.0;
  const float saturation = 0.45 + 0.4 * float(uint(z) >> 16u & 0xFFu) / 255.0;
  const float value = 0.55 + 0.45 * float(uint(z) >> 24u) / 255.0;
  vec3 distance = abs(vec3(hue) - vec3(0.0, 2.0, 4.0));
  distance = min(distance, 6.0 - distance);
  return value * (1.0 - saturation * clamp(distance - 1.0, 0.0, 1.0));
}

// From blue over green and yellow to red, t in [0, 1].
vec3 ramp(float t) {
  const vec3 stops[5] = vec3[](vec3(0.05, 0.12, 0.75), vec3(0.05, 0.6, 0.8), vec3(0.15, 0.65, 0.1), vec3(0.9, 0.75, 0.05),
                               vec3(0.8, 0.06, 0.04));
  const float at = 4.0 * clamp(t, 0.0, 1.0);
  const uint stop = min(uint(at), 3u);
  return mix(stops[stop], stops[stop + 1u], at - float(stop));
}

uint to_display(vec3 linear) {
  const uvec3 c = uvec3(floor(sqrt(clamp(linear, 0.0, 1.0)) * 255.0 + 0.5));
  return c.r | c.g << 8u | c.b << 16u | 0xFF000000u;
}

// Weights of a triangle's corners at a picture point, the solution of sum(b · (x, y, w)) ∝ (px, py, 1), and their change to
// the next pixels. In doubles: far corners of a long triangle cancel.
struct PixelWeights {
  dvec3 at, right, down;
};
PixelWeights find_pixel_weights(dvec3 va, dvec3 vb, dvec3 vc, dvec2 p) {
  PixelWeights o;
  const dvec3 at = dvec3(p, 1.0lf), bc = cross(vb, vc), ca = cross(vc, va), ab = cross(va, vb);
  dvec3 weights = dvec3(dot(at, bc), dot(at, ca), dot(at, ab));
  const double signed_sum = weights.x + weights.y + weights.z;
  o.right = o.down = dvec3(0.0lf);
#ifdef TEXTURES
  if (abs(signed_sum) > 0.0lf && abs(signed_sum) < 1e300lf) {
    const dvec3 share = weights / signed_sum, right = dvec3(bc.x, ca.x, ab.x), down = dvec3(bc.y, ca.y, ab.y);
    o.right = (right - share * (right.x + right.y + right.z)) / signed_sum;
    o.down = (down - share * (down.x + down.y + down.z)) / signed_sum;
  }
#endif
  if (signed_sum < 0.0lf) weights = -weights;
  weights = max(weights, dvec3(0.0lf));  // snapping moves edges by parts of a pixel
  const double sum = weights.x + weights.y + weights.z;
  o.at = sum > 0.0lf && sum < 1e300lf ? weights / sum : dvec3(1.0lf / 3.0lf);
  return o;
}

// Normals of mesh space to world space: the cofactors of the 3×3 part, turned outwards again where it mirrors.
vec3 to_world(uint instance, dvec3 n) {
  const dvec3 r0 = dvec3(frame.instances.at[instance].transform[0], frame.instances.at[instance].transform[1],
                         frame.instances.at[instance].transform[2]);
  const dvec3 r1 = dvec3(frame.instances.at[instance].transform[4], frame.instances.at[instance].transform[5],
                         frame.instances.at[instance].transform[6]);
  const dvec3 r2 = dvec3(frame.instances.at[instance].transform[8], frame.instances.at[instance].transform[9],
                         frame.instances.at[instance].transform[10]);
  dvec3 world = dvec3(dot(cross(r1, r2), n), dot(cross(r2, r0), n), dot(cross(r0, r1), n));
  if ((frame.instances.at[instance].flags & kInstanceMirrored) != 0u) world = -world;
  const double largest = max(abs(world.x), max(abs(world.y), abs(world.z)));
  if (!(largest > 0.0lf && largest < 1e300lf)) return vec3(0.0);
  return normalize(vec3(world / largest));
}

float lighting(vec3 normal) {
  vec3 light;
  [[unroll]] for (uint k = 0u; k < 3u; ++k) {
    light[k] = float((frame.camera.right[k] * -2.0lf + frame.camera.up[k] * 3.0lf - frame.camera.forward[k] * 6.0lf) / 7.0lf);
  }
  return 0.16 + 0.07 * normal.y + 0.67 * max(0.0, dot(normal, light));
}

vec3 shade(uint item, uint triangle, dvec2 p, uint level_count) {
  const uint marked = frame.items.at[item].slot, slot = marked & ITEM_SLOT, cluster = frame.items.at[item].cluster;
  const uint instance = frame.visible.at[slot].instance;
  const GpuMesh mesh = frame.meshes.at[frame.visible.at[slot].mesh];
  const ClusterData data = open_cluster(mesh, cluster);
  const uvec3 corners = cluster_triangle(data, triangle);
  const ivec3 a = cluster_position(data, corners.x), b = cluster_position(data, corners.y), c = cluster_position(data, corners.z);
  const vec3 face = to_world(instance, cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a)));
  vec3 to_viewer;
  [[unroll]] for (uint k = 0u; k < 3u; ++k) {
    to_viewer[k] = frame.camera.is_orthographic != 0u
                       ? float(-frame.camera.forward[k])
                       : float((frame.camera.up[k] * p.y - frame.camera.right[k] * p.x) / frame.camera.pixels_per_unit -
                               frame.camera.forward[k]);
  }
  const bool is_back = dot(face, to_viewer) < 0.0;
  vec3 normal = face, color = vec3(0.0);
  const bool is_front_list = item < counters.stages[STAGE_SOFTWARE].count;
  if (kView == VIEW_SHADED || kView == VIEW_NORMALS) {
    const uint material_id = cluster_material(data, triangle);
    const GpuMaterial material = frame.materials.at[material_id];
    color = vec3(material.base_color.x, material.base_color.y, material.base_color.z);
    const dvec4 va = clip_vertex(slot, a), vb = clip_vertex(slot, b), vc = clip_vertex(slot, c);
    const PixelWeights exact = find_pixel_weights(va.xyw, vb.xyw, vc.xyw, p);
    const vec3 weights = vec3(exact.at);
    vec3 sum = vec3(0.0), tint = vec3(0.0);
    [[unroll]] for (uint k = 0u; k < 3u; ++k) {
      if (mesh.normal_scale != 0u) sum += weights[k] * normalize(vec3(lode_normal(data, corners[k])));
      if (mesh.has_color != 0u) tint += weights[k] * (vec3(lode_color(data, corners[k]).rgb) / 255.0);
    }
    if (mesh.normal_scale != 0u) normal = to_world(instance, dvec3(sum));
    if (mesh.has_color != 0u) color *= tint;
#ifdef TEXTURES
    const uint mesh_id = frame.visible.at[slot].mesh;
    if (kView == VIEW_SHADED) {
      const GpuTextureUse base = frame.surfaces.at[material_id].base_color;
      const Footprint where = footprint(base, mesh_id, data, corners, exact.at, exact.right, exact.down);
      if (where.is_there) color *= sample_texture(base, where).rgb;
    }
    const GpuTextureUse bump = frame.surfaces.at[material_id].normal;
    const Footprint where = footprint(bump, mesh_id, data, corners, exact.at, exact.right, exact.down);
    if (where.is_there) {
      const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a);  // changes sum up to 0
      normal = bend_normal(bump, frame.surfaces.at[material_id].normal_scale, where, normal,
                           to_world_direction(instance, ab * exact.right.y + ac * exact.right.z),
                           to_world_direction(instance, ab * exact.down.y + ac * exact.down.z));
    }
#endif
    if (kView == VIEW_NORMALS) {
      const vec3 shown = 0.5 + 0.5 * (is_back ? -normal : normal);
      return shown * shown;  // to_display() takes the root
    }
  } else if (kView == VIEW_CLUSTERS) {
    color = hash_color(cluster, 0x636Cu);
  } else if (kView == VIEW_TRIANGLES) {
    color = hash_color(cluster, 0x10000u + triangle);
  } else if (kView == VIEW_LEVELS) {
    color = ramp(level_count < 2u ? 0.0 : float(min(frame.clusters.at[cluster].index >> 16u, level_count - 1u)) / float(level_count - 1u));
  } else if (kView == VIEW_PAGES) {
    color = hash_color(frame.page_words.at[frame.clusters.at[cluster].page], 0x7067u);
  } else if (kView == VIEW_PATHS) {
    color = (marked & ITEM_IS_FAR) != 0u ? vec3(0.15, 0.65, 0.1) : is_front_list ? vec3(0.05, 0.3, 0.75) : vec3(0.8, 0.06, 0.04);
  } else if (kView == VIEW_OCCLUDED) {
    const bool is_second = is_front_list ? item >= counters.software_before[1]
                                         : frame.item_capacity - 1u - item >= counters.hardware_before[1];
    color = is_second ? vec3(0.9, 0.35, 0.05) : vec3(0.45);
  }
  return color * lighting(is_back ? -normal : normal);
}

void main() {
  const uint at = thread_index();
  if (at >= frame.width * frame.height) return;
  const uint64_t value = frame.pixels.at[at];
  vec3 color = kBackground;
  if (kView == VIEW_OVERDRAW) {
    const uint count = frame.overdraw.at[at];  // blue: once, red: 16 times and more
    if (count > 0u) color = ramp(log2(float(count)) / 4.0);
  } else if (value != 0ul) {
    const uint key = ~uint(value);
    const dvec2 p = dvec2(double(at % frame.width) + 0.5lf - 0.5lf * double(frame.width),
                          double(at / frame.width) + 0.5lf - 0.5lf * double(frame.height));
    color = shade(key >> 8u, key & 255u, p, b);
  }
  frame.colors.at[at] = to_display(color);
}
