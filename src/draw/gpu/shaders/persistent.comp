// SPDX-License-Identifier: MIT
// The BVH in one dispatch, as long as there is work (persistent threads, Aila and Laine 2009; the queue as in Karis et al.
// 2021): the other way than traverse.comp, same results. A subgroup takes as many places of the queue as it has lanes and
// waits until they are filled or nothing is left to do.
//
// Why nobody waits for ever: places are taken in order and filled in order, so where a lane waits for its place, no place
// behind it is filled either; what is filled was taken by a running subgroup, or will be by the next one that is free.
// A limit on the rounds spent waiting turns a mistake into a reported overflow.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "cull.glsl"
#include "nodes.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer Places { uint64_t at[]; };

const uint kMaxIdleRounds = 1u << 22;

// A place is 0 until it is filled: slot + 1 above the node.
uint64_t packed(uint slot, uint node) { return (uint64_t(slot + 1u) << 32) | uint64_t(node); }

void main() {
  const bool is_retry = pass == 1u;
  const uint initial = min(counters.stages[STAGE_QUEUE + MAX_DEPTH * pass].count,
                           is_retry ? frame.retry_capacity : frame.queue_capacity);
  // What is added lies in part `a` of the queue; pass 0 begins with part 0.
  Places places = Places(uint64_t(frame.queue) + 8ul * uint64_t(a) * uint64_t(frame.queue_capacity));
  bool is_waiting = false;
  uint index = 0u;
  for (uint idle = 0u; idle < kMaxIdleRounds;) {
    if (!any_of(is_waiting)) {
      uint base = 0u;
      if (subgroupElect()) base = atomicAdd(counters.taken[pass], gl_SubgroupSize);
      index = subgroupBroadcastFirst(base) + gl_SubgroupInvocationID;
      is_waiting = true;
    }
    uint filled = 0u;
    if (subgroupElect()) filled = atomicAdd(counters.added[pass], 0u);
    filled = min(subgroupBroadcastFirst(filled), frame.queue_capacity);
    bool has_entry = false, is_tested = false;
    uint slot = 0u, node_id = 0u;
    if (is_waiting && index < initial) {
      const uvec2 entry = is_retry ? frame.retry_nodes.at[index] : frame.queue.at[index];
      slot = entry.x;
      node_id = entry.y;
      has_entry = true;
    } else if (is_waiting && index - initial < filled) {
      const uint64_t place = atomicExchange(places.at[index - initial], 0ul);  // empty again for the next frame
      has_entry = is_tested = place != 0ul;
      slot = uint(place >> 32) - 1u;
      node_id = uint(place);
    }
    const uvec4 done = subgroupBallot(has_entry);
    if (subgroupBallotBitCount(done) == 0u) {
      int balance = 0;
      if (subgroupElect()) balance = atomicAdd(counters.balance[pass], 0);
      if (int(initial) + subgroupBroadcastFirst(balance) <= 0) return;
      ++idle;
      continue;
    }
    idle = 0u;
    is_waiting = is_waiting && !has_entry;
    uint first = 0u, child_count = 0u;
    MetricView view;
    if (has_entry) {
      view = frame.visible.at[slot].view;
      first = frame.nodes.at[node_id].first;
      child_count = children_of(frame.nodes.at[node_id], node_id);
    }
    if (any_of(has_entry && !is_tested)) {
      uint answer = kDropped;
      bool is_leaf = false;
      if (has_entry && !is_tested) {
        answer = test_node(slot, view, frame.nodes.at[node_id]);
        is_leaf = frame.nodes.at[node_id].child_count == 0u;
        if (answer != kOpen || is_leaf) child_count = 0u;
      }
      append_group(slot, first, answer == kOpen && is_leaf);
      append_retry(slot, node_id, answer == kRetried);
    }
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
      const uvec4 votes = subgroupBallot(wants);
      const uint total = subgroupBallotBitCount(votes);
      if (total == 0u) continue;
      // Counted as work before anybody can see it, so that the balance is never too low.
      uint base = 0u;
      if (subgroupElect()) {
        atomicAdd(counters.balance[pass], int(total));
        memoryBarrierBuffer();
        base = atomicAdd(counters.added[pass], total);
        if (base + total > frame.queue_capacity) {
          report_overflow(OVERFLOW_QUEUE);
          // What does not fit is no work.
          atomicAdd(counters.balance[pass], int(max(base, frame.queue_capacity)) - int(base + total));
        }
      }
      const uint at = subgroupBroadcastFirst(base) + subgroupBallotExclusiveBitCount(votes);
      if (wants && at < frame.queue_capacity) atomicExchange(places.at[at], packed(slot, first + child));
    }
    memoryBarrierBuffer();
    if (subgroupElect()) atomicAdd(counters.balance[pass], -int(subgroupBallotBitCount(done)));
  }
  if (subgroupElect()) report_overflow(OVERFLOW_QUEUE);
}
