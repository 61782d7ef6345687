// SPDX-License-Identifier: MIT
// Selection without a hierarchy: every group of every visible instance, one workgroup an instance. What the BVH saves.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "resident.glsl"

void main() {
  const uint slot = group_index();
  const bool is_there = slot < min(counters.stages[STAGE_SLOTS].count, frame.slot_capacity);
  uint first = 0u, count = 0u;
  if (is_there) {
    const GpuMesh mesh = frame.meshes.at[frame.visible.at[slot].mesh];
    first = mesh.first_group;
    count = mesh.group_count;
  }
  for (uint base = 0u; base < count; base += uint(GROUP_SIZE)) {
    const uint id = base + gl_LocalInvocationID.x;
    bool is_open = false;
    if (id < count) {
      const GpuGroup group = frame.groups.at[first + id];
      is_open = !metric_passes(frame.visible.at[slot].view, group.center[0], group.center[1], group.center[2],
                               group.radius, group.error);
    }
    if (is_open) want_page(frame.visible.at[slot].view, first + id);
    is_open = is_open && is_ready(first + id);
    const uint at = append(STAGE_GROUPS + pass, is_open, kGroupLanes, 64u);
    if (is_open) {
      if (at < frame.group_capacity) frame.open_groups.at[at] = uvec2(slot, first + id);
      else report_overflow(OVERFLOW_GROUPS);
    }
  }
}
