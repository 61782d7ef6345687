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

const uint kGroupLanes = 8u;  // invocations that share an open group's clusters
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

// Makes the dispatch arguments of a stage cover `count` entries, `per_group` of them a workgroup.
void cover(uint stage, uint count, uint per_group) {
  const uint groups = (count + per_group - 1u) / per_group;
  atomicMax(counters.stages[stage].x, min(groups, kGroupRow));
  atomicMax(counters.stages[stage].y, (groups + kGroupRow - 1u) / kGroupRow);
}

// Room for one entry where `wants`: its index. Dispatch arguments follow, for `factor` invocations an entry.
uint append(uint stage, bool wants, uint factor, uint per_group) {
  const uvec4 votes = subgroupBallot(wants);
  const uint total = subgroupBallotBitCount(votes);
  uint base = 0u;
  if (subgroupElect() && total > 0u) {
    base = atomicAdd(counters.stages[stage].count, total);
    cover(stage, (base + total) * factor, per_group);
  }
  return subgroupBroadcastFirst(base) + subgroupBallotExclusiveBitCount(votes);
}

void report_overflow(uint which) { atomicOr(counters.overflow, which); }
