// SPDX-License-Identifier: MIT
// The members of open groups that are drawn: the coarser group does not pass (it is open), the own one passes or there is
// none (I5). From a pool an open group wants its page, and its members are drawn where it is ready. They go to the list of
// items: to its front for the software rasterizer, to its back for the hardware's.
// With a = 1 the entries are clusters that last frame's depth hid, tried again in pass 1.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "cull.glsl"
#include "resident.glsl"

layout(constant_id = 3) const uint kHardware = 0u;

// Or cannot be opened: then its members' replacements are as fine as it gets.
bool own_group_passes(uint slot, uint own) {
  if (own == kNone || !is_ready(own)) return true;
  const GpuGroup group = frame.groups.at[own];
  return metric_passes(frame.visible.at[slot].view, group.center[0], group.center[1], group.center[2], group.radius,
                       group.error);
}

// Wide on the screen, or near enough to be clipped.
bool is_for_hardware(uint slot, vec3 center, float radius) {
  const ClipBounds b =
      bounds_of(frame.visible.at[slot].cull_x, frame.visible.at[slot].cull_y, frame.visible.at[slot].cull_z,
                frame.visible.at[slot].cull_w, frame.visible.at[slot].row_norm, center, radius);
  if (b.center.z + b.reach.z > b.center.w - b.reach.w) return true;
  return 2.0 * max(b.reach.x, b.reach.y) > frame.hardware_pixels * (b.center.w - b.reach.w);
}

void consider(uint slot, uint id, bool is_there) {
  bool is_hidden_before = false, is_hardware = false;
  if (is_there) {
    const GpuCluster cluster = frame.clusters.at[id];
    const vec3 center = vec3(cluster.center[0], cluster.center[1], cluster.center[2]);
    is_there = a == 1u || own_group_passes(slot, cluster.own_group);
    if (is_there) {
      const uint answer = cull_sphere(slot, center, cluster.radius);
      is_hidden_before = answer == kHiddenBefore;
      is_there = answer == kVisibleNow;
    }
    if (kHardware != 0u && is_there) is_hardware = is_for_hardware(slot, center, cluster.radius);
  }
  if (kOcclusion != 0u && pass == 0u) {
    const uint at = append(STAGE_RETRY_CLUSTERS, is_hidden_before, 1u, 64u);
    if (is_hidden_before) {
      if (at < frame.retry_capacity) frame.retry_clusters.at[at] = uvec2(slot, id);
      else report_overflow(OVERFLOW_RETRY);
    }
  }
  const bool is_software = is_there && !is_hardware;
  const uint at = append_item(STAGE_SOFTWARE, is_software, counters.software_before[pass], 1u);
  if (is_software) {
    if (at < frame.item_capacity) frame.items.at[at] = item_of(slot, id);
    else report_overflow(OVERFLOW_CLUSTERS);
  }
  if (kHardware != 0u) {
    const bool wants = is_there && is_hardware;
    const uint back = append_item(STAGE_HARDWARE, wants, counters.hardware_before[pass], 1u);
    if (wants) {
      if (back < frame.item_capacity) frame.items.at[frame.item_capacity - 1u - back] = item_of(slot, id);
      else report_overflow(OVERFLOW_CLUSTERS);
      atomicAdd(counters.stages[STAGE_DRAW + pass].x, 1u);
    }
  }
}

void main() {
  // One body for both lists, without an early return: every invocation takes part in the votes of append().
  const bool is_retry = a == 1u;
  const uint index = is_retry ? thread_index() : thread_index() / kGroupLanes;
  uvec2 entry = uvec2(0u);
  uint first = 0u, end = 0u;
  if (is_retry) {
    if (index < min(counters.stages[STAGE_RETRY_CLUSTERS].count, frame.retry_capacity)) {
      entry = frame.retry_clusters.at[index];
      first = entry.y;
      end = first + 1u;
    }
  } else if (index < min(counters.stages[STAGE_GROUPS + pass].count, frame.group_capacity)) {
    entry = frame.open_groups.at[index];
    const uint begin = frame.groups.at[entry.y].first_cluster;
    const uint lane = thread_index() % kGroupLanes;
    first = begin + lane;
    end = begin + frame.groups.at[entry.y].cluster_count;
    // Here and not where the BVH is walked: there each depth would wait for it (docs/log/gpu.md).
    if (lane == 0u) want_page(frame.visible.at[entry.x].view, entry.y);
    if (!is_ready(entry.y)) end = first;
  }
  for (uint id = first; subgroupBallotBitCount(subgroupBallot(id < end)) > 0u; id += kGroupLanes) {
    consider(entry.x, id, id < end);
  }
}
