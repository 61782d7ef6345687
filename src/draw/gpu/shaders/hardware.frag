// SPDX-License-Identifier: MIT
// The nearest triangle wins by the same atomicMax as in software. Which side is the front depends on instance and
// material, so it is decided here.
#version 460
#include "common.glsl"
#include "page.glsl"
#include "screen.glsl"
#include "alpha.glsl"

layout(constant_id = 0) const uint kDoubleSided = 0u;

#ifdef MESH_SHADER
#extension GL_EXT_mesh_shader : require
layout(location = 0) perprimitiveEXT flat in uint in_item;
layout(location = 1) perprimitiveEXT flat in uint in_triangle;
#else
layout(location = 0) flat in uint in_item;
layout(location = 1) flat in uint in_triangle;
#endif

void main() {
  const uint slot = frame.items.at[in_item].slot, cluster = frame.items.at[in_item].cluster;
  const bool is_mirrored = (frame.visible.at[slot].flags & kInstanceMirrored) != 0u;
  bool is_drawn = gl_FrontFacing != is_mirrored;
  if (kDoubleSided != 0u && !is_drawn) {
    const ClusterData data =
        open_cluster(frame.meshes.at[frame.visible.at[slot].mesh], cluster);
    is_drawn = frame.materials.at[cluster_material(data, in_triangle)].double_sided != 0u;
  }
#ifdef ALPHA_MASK
  if (is_drawn) {
    const ClusterData data = open_cluster(frame.meshes.at[frame.visible.at[slot].mesh], cluster);
    BEGIN_ALPHA(slot, data, in_triangle, cluster_triangle(data, in_triangle));
    is_drawn = passes_alpha(alpha_test, int(gl_FragCoord.x), int(gl_FragCoord.y));
  }
#endif
  // Below 2^32 as floats go; the sky is 0.
  const uint depth = uint(clamp(gl_FragCoord.z, 0.0, 0.99999994) * 4294967296.0);
  if (is_drawn) put_pixel(int(gl_FragCoord.x), int(gl_FragCoord.y), pixel_value(depth, in_item, in_triangle));
}
