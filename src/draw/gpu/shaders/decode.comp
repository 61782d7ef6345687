// SPDX-License-Identifier: MIT
// Writes what page.glsl reads, for the judge: every integer of clusters a, a + 1, …, one workgroup each. The list
// `retry_clusters` holds (cluster's mesh, first word of its output) and `clipped` is the output:
// vertex count, triangle count, channels vertex by vertex, then three corners and a material a triangle.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "page.glsl"

void main() {
  if (group_index() >= b) return;
  const uint cluster = a + group_index();
  const uvec2 entry = frame.retry_clusters.at[cluster];
  const GpuMesh mesh = frame.meshes.at[entry.x];
  const ClusterData data = open_cluster(mesh, cluster);
  const uint vertices = entry.y + 2u, triangles = vertices + data.vertex_count * mesh.channel_count;
  if (gl_LocalInvocationID.x == 0u) {
    frame.clipped.at[entry.y] = data.vertex_count;
    frame.clipped.at[entry.y + 1u] = data.triangle_count;
  }
  for (uint v = gl_LocalInvocationID.x; v < data.vertex_count; v += uint(GROUP_SIZE)) {
    for (uint c = 0u; c < mesh.channel_count; ++c) {
      frame.clipped.at[vertices + v * mesh.channel_count + c] = uint(cluster_channel(data, v, c));
    }
    const ivec3 position = cluster_position(data, v);
    if (uint(position.x) != frame.clipped.at[vertices + v * mesh.channel_count] ||
        uint(position.y) != frame.clipped.at[vertices + v * mesh.channel_count + 1u] ||
        uint(position.z) != frame.clipped.at[vertices + v * mesh.channel_count + 2u]) {
      frame.clipped.at[entry.y] = 0u;  // the two ways to read a position disagree
    }
  }
  for (uint t = gl_LocalInvocationID.x; t < data.triangle_count; t += uint(GROUP_SIZE)) {
    const uvec3 corners = cluster_triangle(data, t);
    frame.clipped.at[triangles + 4u * t] = corners.x;
    frame.clipped.at[triangles + 4u * t + 1u] = corners.y;
    frame.clipped.at[triangles + 4u * t + 2u] = corners.z;
    frame.clipped.at[triangles + 4u * t + 3u] = cluster_material(data, t);
  }
}
