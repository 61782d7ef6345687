// SPDX-License-Identifier: MIT
// Once a scene: the one root cluster of each mesh that has one, decoded, because far instances by the million draw
// nothing else. A workgroup a mesh. At GpuCluster::root_word: vertex count | triangle count << 16, three words a vertex, a
// word a triangle (corners, 8 bits each; bit 24: double sided).
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "page.glsl"

void main() {
  const GpuMesh mesh = frame.meshes.at[group_index()];
  if (mesh.only_root == kNone || frame.groups.at[mesh.only_root].cluster_count != 1u) return;
  const uint cluster = frame.groups.at[mesh.only_root].first_cluster;
  const ClusterData data = open_cluster(mesh, cluster);
  const uint head = frame.clusters.at[cluster].root_word, vertices = head + 1u, triangles = vertices + 3u * data.vertex_count;
  if (gl_LocalInvocationID.x == 0u) frame.roots.at[head] = data.vertex_count | data.triangle_count << 16u;
  for (uint v = gl_LocalInvocationID.x; v < data.vertex_count; v += uint(GROUP_SIZE)) {
    const ivec3 q = cluster_position(data, v);
    for (uint k = 0u; k < 3u; ++k) frame.roots.at[vertices + 3u * v + k] = uint(q[k]);
  }
  for (uint t = gl_LocalInvocationID.x; t < data.triangle_count; t += uint(GROUP_SIZE)) {
    const uvec3 v = cluster_triangle(data, t);
    const uint is_double_sided = frame.materials.at[cluster_material(data, t)].double_sided != 0u ? 1u : 0u;
    frame.roots.at[triangles + t] = v.x | v.y << 8u | v.z << 16u | is_double_sided << 24u;
  }
}
