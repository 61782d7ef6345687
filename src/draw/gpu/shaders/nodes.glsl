// SPDX-License-Identifier: MIT
// What the two ways to walk the BVH share: the test of a node. One that passes the rule has nothing to draw below it (I8).

const uint kDropped = 0u;
const uint kOpen = 1u;
const uint kRetried = 2u;  // last frame's depth hides it: pass 1 tries it again

uint test_node(uint slot, MetricView view, GpuNode node) {
  if (metric_passes(view, node.center[0], node.center[1], node.center[2], node.radius, node.error)) return kDropped;
  const uint answer = cull_sphere(slot, vec3(node.center[0], node.center[1], node.center[2]), node.radius);
  return answer == kVisibleNow ? kOpen : answer == kHiddenBefore ? kRetried : kDropped;
}

// An open leaf's group, whether its page is there or not.
void append_group(uint slot, uint group, bool wants) {
  const uint at = append(STAGE_GROUPS + pass, wants, kGroupLanes, 64u);
  if (!wants) return;
  if (at < frame.group_capacity) frame.open_groups.at[at] = uvec2(slot, group);
  else report_overflow(OVERFLOW_GROUPS);
}

// Into the list that pass 1 begins with.
void append_retry(uint slot, uint node_id, bool wants) {
  if (kOcclusion == 0u || pass != 0u) return;
  const uint at = append(STAGE_QUEUE + MAX_DEPTH, wants, 1u, 64u);
  if (!wants) return;
  if (at < frame.retry_capacity) frame.retry_nodes.at[at] = uvec2(slot, node_id);
  else report_overflow(OVERFLOW_RETRY);
}

// Children lie behind their node, which also keeps a damaged table from looping.
uint children_of(GpuNode node, uint node_id) { return node.first > node_id ? node.child_count : 0u; }

bool any_of(bool value) { return subgroupBallotBitCount(subgroupBallot(value)) > 0u; }
