// SPDX-License-Identifier: MIT
// Hardware raster by vertex pulling: instance i is the i-th item from the back of the list, vertex v the corner v % 3 of
// its triangle v / 3. Works everywhere; mesh shaders decode each vertex once.
#version 460
#include "common.glsl"
#include "page.glsl"
#include "screen.glsl"

layout(location = 0) flat out uint out_item;
layout(location = 1) flat out uint out_triangle;

void main() {
  const uint item = frame.item_capacity - 1u - (counters.hardware_before[pass] + gl_InstanceIndex);
  const uint slot = frame.items.at[item].slot, cluster = frame.items.at[item].cluster;
  const ClusterData data =
      open_cluster(frame.meshes.at[frame.visible.at[slot].mesh], cluster);
  const uint triangle = gl_VertexIndex / 3u;
  out_item = item;
  out_triangle = triangle;
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);  // behind the cluster's last triangle: no area
  if (triangle < data.triangle_count) {
    const dvec4 clip = clip_vertex(slot, cluster_position(data, cluster_triangle(data, triangle)[gl_VertexIndex % 3u]));
    gl_Position = hardware_position(clip);
  }
}
