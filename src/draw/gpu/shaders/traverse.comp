// SPDX-License-Identifier: MIT
// One depth of the BVH for all instances at once. Entries of the queue are open nodes; an invocation tests the children of
// one: open inner nodes go to the queue of the next depth, open leaves' groups to the list of open groups. What the first
// queue of a pass holds, roots and what pass 0 put off, has not been tested itself.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "cull.glsl"
#include "nodes.glsl"

void main() {
  const uint stage = STAGE_QUEUE + MAX_DEPTH * pass + depth;
  const uint half_queue = (depth & 1u) * frame.queue_capacity;
  const uint next_half = frame.queue_capacity - half_queue;
  const uint index = thread_index();
  const bool is_retry = pass == 1u && depth == 0u;
  const bool is_there = index < min(counters.stages[stage].count, is_retry ? frame.retry_capacity : frame.queue_capacity);
  uint slot = 0u, node_id = 0u, first = 0u, child_count = 0u;
  MetricView view;
  if (is_there) {
    const uvec2 entry = is_retry ? frame.retry_nodes.at[index] : frame.queue.at[half_queue + index];
    slot = entry.x;
    node_id = entry.y;
    view = frame.visible.at[slot].view;
    first = frame.nodes.at[node_id].first;
    child_count = children_of(frame.nodes.at[node_id], node_id);
  }
  if (depth == 0u) {
    uint answer = kDropped;
    bool is_leaf = false;
    if (is_there) {
      answer = test_node(slot, view, frame.nodes.at[node_id]);
      is_leaf = frame.nodes.at[node_id].child_count == 0u;
    }
    append_group(slot, first, answer == kOpen && is_leaf);
    append_retry(slot, node_id, answer == kRetried);
    if (answer != kOpen || is_leaf) child_count = 0u;
  }
  // Eight rounds at most, one a child: what is queued stays dense.
  for (uint child = 0u; any_of(child < child_count); ++child) {
    uint answer = kDropped, group = 0u;
    bool is_leaf = false;
    if (child < child_count) {
      const GpuNode node = frame.nodes.at[first + child];
      answer = test_node(slot, view, node);
      is_leaf = node.child_count == 0u;
      group = node.first;
    }
    append_group(slot, group, answer == kOpen && is_leaf);
    append_retry(slot, first + child, answer == kRetried);
    const bool wants = answer == kOpen && !is_leaf;
    const uint at = append(stage + 1u, wants, 1u, 64u);
    if (!wants) continue;
    if (at < frame.queue_capacity) frame.queue.at[next_half + at] = uvec2(slot, first + child);
    else report_overflow(OVERFLOW_QUEUE);
  }
}
