// SPDX-License-Identifier: MIT
// One depth of the BVH for all instances at once. An invocation tests one node by the rule (metric.h): a node that passes
// has nothing to draw below it (I8). Its children go to the queue of the next depth; a leaf's group goes to the list of
// open groups. What last frame's depth hides waits for pass 1.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "cull.glsl"

void main() {
  const uint stage = STAGE_QUEUE + MAX_DEPTH * pass + depth;
  const uint half_queue = (depth & 1u) * frame.queue_capacity;
  const uint index = thread_index();
  uint slot = 0u, child_count = 0u, first = 0u;
  bool is_leaf = false, is_retried = false;
  uint node_id = 0u;
  const bool is_retry = pass == 1u && depth == 0u;
  if (index < min(counters.stages[stage].count, is_retry ? frame.retry_capacity : frame.queue_capacity)) {
    const uvec2 item = is_retry ? frame.retry_nodes.at[index] : frame.queue.at[half_queue + index];
    slot = item.x;
    node_id = item.y;
    const GpuNode node = frame.nodes.at[node_id];
    if (!metric_passes(frame.visible.at[slot].view, node.center[0], node.center[1], node.center[2], node.radius,
                       node.error)) {
      const uint answer = cull_sphere(slot, vec3(node.center[0], node.center[1], node.center[2]), node.radius);
      is_retried = answer == kHiddenBefore;
      if (answer == kVisibleNow) {
        first = node.first;
        is_leaf = node.child_count == 0u;
        // Children lie behind their node, which also keeps a damaged table from looping.
        child_count = first > node_id ? node.child_count : 0u;
      }
    }
  }
  const uint group_at = append(STAGE_GROUPS + pass, is_leaf, kGroupLanes, 64u);
  if (is_leaf) {
    if (group_at < frame.group_capacity) frame.open_groups.at[group_at] = uvec2(slot, first);
    else report_overflow(OVERFLOW_GROUPS);
  }
  if (kOcclusion != 0u && pass == 0u) {
    // Straight into the queue that pass 1 begins with.
    const uint at = append(STAGE_QUEUE + MAX_DEPTH, is_retried, 1u, 64u);
    if (is_retried) {
      if (at < frame.retry_capacity) frame.retry_nodes.at[at] = uvec2(slot, node_id);
      else report_overflow(OVERFLOW_RETRY);
    }
  }
  const uint next = stage + 1u;
  const uint next_half = frame.queue_capacity - half_queue;
  // Eight votes at most, one a child: what is queued stays dense.
  for (uint child = 0u; subgroupBallotBitCount(subgroupBallot(child < child_count)) > 0u; ++child) {
    const bool wants = child < child_count;
    const uint at = append(next, wants, 1u, 64u);
    if (!wants) continue;
    if (at < frame.queue_capacity) frame.queue.at[next_half + at] = uvec2(slot, first + child);
    else report_overflow(OVERFLOW_QUEUE);
  }
}
