// SPDX-License-Identifier: MIT
// Clusters out of pages as they lie in the file: <meshlode/decode.glsl> over the buffer of all pages. The only shader text
// of this room that knows the page layout.

#define LODE_WORD(i) frame.pages.at[i]
#include "meshlode/decode.glsl"
#undef LODE_WORD

#define ClusterData LodeCluster

// Pages are uploaded back to back, so that bits of one are counted from its own start.
LodeCluster open_cluster(GpuMesh mesh, uint cluster) {
  LodeMesh m;
  m.normal_scale = mesh.normal_scale;
  m.uv_set_count = mesh.uv_set_count;
  m.has_color = mesh.has_color;
  m.material = mesh.material;
  return lode_read_cluster(m, frame.page_words.at[frame.clusters.at[cluster].page], frame.clusters.at[cluster].index & 0xFFFFu);
}

ivec3 cluster_position(LodeCluster c, uint vertex) { return lode_position(c, lode_raw_position(c, vertex)); }

// Any integer of a vertex, in the order of format::MeshRecord.
int cluster_channel(LodeCluster c, uint vertex, uint channel) {
  if (channel < 3u) return cluster_position(c, vertex)[channel];
  channel -= 3u;
  if (c.normal_scale != 0u) {
    if (channel < 3u) return lode_normal(c, vertex)[channel];
    channel -= 3u;
  }
  if (channel < 2u * c.uv_set_count) {
    return lode_uv(c, channel >> 1u, vertex, lode_raw_position(c, vertex))[channel & 1u];
  }
  return int(lode_color(c, vertex)[channel - 2u * c.uv_set_count]);
}

uvec3 cluster_triangle(LodeCluster c, uint triangle) { return lode_triangle(c, triangle); }

uint cluster_material(LodeCluster c, uint triangle) { return lode_material(c, triangle); }
