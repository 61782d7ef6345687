// SPDX-License-Identifier: MIT
// Decodes one corner of a triangle from the page of its cluster.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "meshlode/metric.h"
#include "tables.glsl"
#define LODE_WORD(i) words[i]
#include "meshlode/decode.glsl"
layout(std430, set = 0, binding = 5) readonly buffer Items { uvec2 items[]; };
layout(location = 0) out vec3 normal;
layout(location = 1) flat out uint cluster;

void main() {
  const uvec2 item = items[gl_InstanceIndex];
  const uvec4 m = meshes[instances[item.x].mesh];
  const Cluster which = clusters[item.y];
  const LodeCluster c = lode_read_cluster(LodeMesh(m.x, m.y, m.z, m.w), which.page_word, which.index_in_page);
  const uint triangle = uint(gl_VertexIndex) / 3u;
  cluster = item.y;
  normal = vec3(0.0);
  gl_Position = vec4(0.0);
  if (triangle >= c.triangle_count) return;  // all three corners: nothing is drawn
  const uint v = lode_triangle(c, triangle)[gl_VertexIndex % 3];
  gl_Position = instances[item.x].clip * vec4(lode_position(c, lode_raw_position(c, v)), 1.0);
  if (m.x == 0u) return;
  const vec3 n = vec3(lode_normal(c, v));
  for (int k = 0; k < 3; ++k) normal[k] = dot(instances[item.x].normal[k].xyz, n);
}
