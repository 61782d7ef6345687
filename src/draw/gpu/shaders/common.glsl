// SPDX-License-Identifier: MIT
// Every shader begins with this: extensions, the frame, and lists that many invocations append to.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require

#include "frame.h"

layout(push_constant, scalar) uniform Push {
  FrameBlock block;
  uint pass;   // of occlusion culling: 0 or 1
  uint depth;  // of the traversal
  uint a, b;
};

#define frame block.all
#define counters block.all.counters.all

const uint kGroupLanes = 8u;   // invocations that share an open group's clusters
const uint kFarLanes = 32u;    // that draw a far root
const uint kFarPerGroup = 128u / kFarLanes;  // far roots of a workgroup of raster_far.comp
const uint kNone = 0xFFFFFFFFu;
const uint kInstanceMirrored = 1u;
const uint kInstanceSingular = 2u;
const float kInfiniteError = 3.402823466e+38;

// Commands::dispatch() lays groups out in rows of 32768.
const uint kGroupRow = 32768u;

#ifdef GROUP_SIZE
layout(local_size_x = GROUP_SIZE) in;
uint group_index() { return gl_WorkGroupID.y * kGroupRow + gl_WorkGroupID.x; }
uint thread_index() { return group_index() * uint(GROUP_SIZE) + gl_LocalInvocationID.x; }
#endif

// Makes the dispatch arguments of a stage cover invocations base … base + total - 1, `per_group` of them a workgroup.
// Every invocation is added by one call, so who crosses a border says so, and nobody else touches the arguments: on them
// all workgroups would wait for each other.
void cover(uint stage, uint base, uint total, uint per_group) {
  const uint before = (base + per_group - 1u) / per_group, after = (base + total + per_group - 1u) / per_group;
  if (after == before) return;
  if (before < kGroupRow) atomicMax(counters.stages[stage].x, min(after, kGroupRow));
  const uint rows = (after + kGroupRow - 1u) / kGroupRow;
  if (rows != (before + kGroupRow - 1u) / kGroupRow) atomicMax(counters.stages[stage].y, rows);
}

// Room for one entry where `wants`: its index. Dispatch arguments follow, for `factor` invocations an entry.
uint append(uint stage, bool wants, uint factor, uint per_group) {
  const uvec4 votes = subgroupBallot(wants);
  const uint total = subgroupBallotBitCount(votes);
  uint base = 0u;
  if (subgroupElect() && total > 0u) {
    base = atomicAdd(counters.stages[stage].count, total);
    cover(stage, base * factor, total * factor, per_group);
  }
  return subgroupBroadcastFirst(base) + subgroupBallotExclusiveBitCount(votes);
}

// append() to one end of the items; the count goes on from pass 0, the dispatch covers this pass alone.
uint append_item(uint stage, bool wants, uint before, uint per_group) {
  const uvec4 votes = subgroupBallot(wants);
  const uint total = subgroupBallotBitCount(votes);
  uint base = 0u;
  if (subgroupElect() && total > 0u) {
    base = atomicAdd(counters.stages[stage].count, total);
    cover(stage + pass, base - before, total, per_group);
  }
  return subgroupBroadcastFirst(base) + subgroupBallotExclusiveBitCount(votes);
}

GpuItem item_of(uint slot, uint cluster) { return GpuItem(slot, cluster, 0u); }

void report_overflow(uint which) { atomicOr(counters.overflow, which); }
