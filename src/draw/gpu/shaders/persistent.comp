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

// What a lane has got to do. A tested node is open: its children are looked at.
struct Entry {
  bool is_there, is_tested;
  uint slot, node;
};

// The place that a lane waits for, if it is filled: the first ones by the pass before, those behind by this dispatch.
Entry take_entry(bool is_waiting, uint index, uint initial, uint filled, Places places) {
  Entry entry = Entry(false, false, 0u, 0u);
  if (is_waiting && index < initial) {
    const uvec2 pair = pass == 1u ? frame.retry_nodes.at[index] : frame.queue.at[index];
    entry = Entry(true, false, pair.x, pair.y);
  } else if (is_waiting && index - initial < filled) {
    const uint64_t place = atomicExchange(places.at[index - initial], 0ul);  // empty again for the next frame
    entry = Entry(place != 0ul, place != 0ul, uint(place >> 32) - 1u, uint(place));
  }
  return entry;
}

// An untested node: its group where it is an open leaf. Returns whether its children are to be looked at.
bool test_entry(Entry entry, MetricView view, uint first) {
  const bool wants = entry.is_there && !entry.is_tested;
  uint answer = kDropped;
  bool is_leaf = false;
  if (wants) {
    answer = test_node(entry.slot, view, frame.nodes.at[entry.node]);
    is_leaf = frame.nodes.at[entry.node].child_count == 0u;
  }
  append_group(entry.slot, first, answer == kOpen && is_leaf);
  append_retry(entry.slot, entry.node, answer == kRetried);
  return !wants || (answer == kOpen && !is_leaf);
}

// Puts open inner nodes into the queue, one a lane that wants to.
void add_node(bool wants, uint slot, uint node, Places places) {
  const uvec4 votes = subgroupBallot(wants);
  const uint total = subgroupBallotBitCount(votes);
  if (total == 0u) return;
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
  if (wants && at < frame.queue_capacity) atomicExchange(places.at[at], packed(slot, node));
}

// All lanes together, child by child, as long as one has any.
void test_children(uint slot, MetricView view, uint first, uint child_count, Places places) {
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
    add_node(answer == kOpen && !is_leaf, slot, first + child, places);
  }
}

void main() {
  const uint initial = min(counters.stages[STAGE_QUEUE + MAX_DEPTH * pass].count,
                           pass == 1u ? frame.retry_capacity : frame.queue_capacity);
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
    const Entry entry = take_entry(is_waiting, index, initial, filled, places);
    const uvec4 done = subgroupBallot(entry.is_there);
    if (subgroupBallotBitCount(done) == 0u) {
      int balance = 0;
      if (subgroupElect()) balance = atomicAdd(counters.balance[pass], 0);
      if (int(initial) + subgroupBroadcastFirst(balance) <= 0) return;
      ++idle;
      continue;
    }
    idle = 0u;
    is_waiting = is_waiting && !entry.is_there;
    uint first = 0u, child_count = 0u;
    MetricView view;
    if (entry.is_there) {
      view = frame.visible.at[entry.slot].view;
      first = frame.nodes.at[entry.node].first;
      child_count = children_of(frame.nodes.at[entry.node], entry.node);
    }
    if (any_of(entry.is_there && !entry.is_tested) && !test_entry(entry, view, first)) child_count = 0u;
    test_children(entry.slot, view, first, child_count, places);
    memoryBarrierBuffer();
    if (subgroupElect()) atomicAdd(counters.balance[pass], -int(subgroupBallotBitCount(done)));
  }
  if (subgroupElect()) report_overflow(OVERFLOW_QUEUE);
}
