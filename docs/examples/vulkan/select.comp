// SPDX-License-Identifier: MIT
// The flat rule (docs/reference/selection.md), a thread for each cluster of an instance: it is drawn if its own group passes, or it
// has none, and its coarser group does not.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "meshlode/metric.h"
#include "tables.glsl"
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 5) buffer Items { uvec2 items[]; };
layout(std430, set = 0, binding = 6) buffer Draw { uint vertex_count, item_count, first_vertex, first_instance; };

bool passes(MetricView view, uint group) {
  const vec4 sphere = groups[group].sphere;
  return metric_passes(view, sphere.x, sphere.y, sphere.z, sphere.w, groups[group].error);
}

void main() {
  const uint instance = gl_WorkGroupID.y;
  if (gl_GlobalInvocationID.x >= instances[instance].cluster_count) return;
  const uint cluster = instances[instance].first_cluster + gl_GlobalInvocationID.x;
  const uint own_group = clusters[cluster].own_group;
  const MetricView view = instances[instance].view;
  if (own_group != 0xFFFFFFFFu && !passes(view, own_group)) return;
  if (passes(view, clusters[cluster].coarser_group)) return;
  items[atomicAdd(item_count, 1u)] = uvec2(instance, cluster);
}
