// SPDX-License-Identifier: MIT
// One step of Batcher's odd-even merge sort (1968) over the list of items, ascending by instance and cluster: in verify mode
// equal depths must resolve alike everywhere. Every comparison puts the lower one first, so that a list of any length sorts
// as if it went on with endless infinities. `a`: items, `b`: the distance compared at, `depth`: the runs that are merged.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"

uint64_t key_of(GpuItem item) {
  return (uint64_t(frame.visible.at[item.slot & ITEM_SLOT].instance) << 32) | uint64_t(item.cluster);
}

void main() {
  const uint low = thread_index(), start = b % depth;
  if (low < start || ((low - start) / b) % 2u != 0u || low + b >= a) return;
  const uint high = low + b;
  if (low / (2u * depth) != high / (2u * depth)) return;
  const GpuItem first = frame.items.at[low], second = frame.items.at[high];
  if (key_of(second) >= key_of(first)) return;
  frame.items.at[low] = second;
  frame.items.at[high] = first;
}
