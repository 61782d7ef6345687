// SPDX-License-Identifier: MIT
// Which groups may be opened where only some pages are resident (run/select/resident.h). A group that does not pass has
// coarser groups above it that do not pass either (I4), so it is reached iff its page and those of all groups above are
// resident: a bit of each group, the same for all instances.

layout(constant_id = 9) const uint kStreams = 0u;

bool is_ready(uint group) {
  return kStreams == 0u || (frame.ready.at[group / 32u] >> (group % 32u) & 1u) != 0u;
}

// The group is open: its page is wanted, by the projected error that is left without it. Priorities order loads and decide
// nothing that is drawn, so their division and square root need not be the CPU's.
void want_page(MetricView view, uint id) {
  if (kStreams == 0u) return;
  const GpuGroup group = frame.groups.at[id];
  float priority = kInfiniteError;
  if (group.error < kInfiniteError) {
    const vec3 c = vec3(group.center[0], group.center[1], group.center[2]);
    precise float x = ((view.row0.x * c.x + view.row0.y * c.y) + view.row0.z * c.z) + view.row0.w;
    precise float y = ((view.row1.x * c.x + view.row1.y * c.y) + view.row1.z * c.z) + view.row1.w;
    precise float z = ((view.row2.x * c.x + view.row2.y * c.y) + view.row2.z * c.z) + view.row2.w;
    precise float distance2 = (x * x + y * y) + z * z;
    precise float reach = group.radius * view.scale;
    const float distance = max(sqrt(distance2) - reach, view.near_distance);
    priority = clamp(group.error * view.error_scale / distance, 1.17549435e-38, 8.5070592e37);  // 2^-126 ... 2^126
  }
  atomicMax(frame.priorities.at[group.page], floatBitsToUint(priority));
}
