// SPDX-License-Identifier: MIT
// Levels 1 to 6 of the depth pyramid, a workgroup per 64 × 64 pixels. A texel of level l is the farthest depth (the
// smallest number) of the pixels (x >> l, y >> l): with sizes rounded up nothing is left out at any resolution.
#version 460
#define GROUP_SIZE 256
#include "common.glsl"

shared uint farthest[256];

uint depth_at(uint x, uint y) {
  if (x >= frame.width || y >= frame.height) return 0xFFFFFFFFu;
  return uint(frame.pixels.at[y * frame.width + x] >> 32);
}

void put(uint level, uint x, uint y, uint value) {
  if (level > frame.pyramid_levels) return;
  const uint width = (frame.width + (1u << level) - 1u) >> level, height = (frame.height + (1u << level) - 1u) >> level;
  if (x < width && y < height) frame.pyramid.at[frame.pyramid_offset[level] + y * width + x] = value;
}

void build_tile() {
  const uint tiles = (frame.width + 63u) / 64u;
  const uint tile_x = group_index() % tiles, tile_y = group_index() / tiles;
  const uint tx = gl_LocalInvocationID.x & 15u, ty = gl_LocalInvocationID.x >> 4u;
  if (group_index() == 0u && gl_LocalInvocationID.x == 0u && pass == 0u) {
    counters.software_before[1] = counters.stages[STAGE_SOFTWARE].count;
    counters.hardware_before[1] = counters.stages[STAGE_HARDWARE].count;
  }
  uint all = 0xFFFFFFFFu;
  for (uint j = 0u; j < 2u; ++j) {
    for (uint i = 0u; i < 2u; ++i) {
      const uint x = tile_x * 32u + tx * 2u + i, y = tile_y * 32u + ty * 2u + j;
      const uint value = min(min(depth_at(2u * x, 2u * y), depth_at(2u * x + 1u, 2u * y)),
                             min(depth_at(2u * x, 2u * y + 1u), depth_at(2u * x + 1u, 2u * y + 1u)));
      put(1u, x, y, value);
      all = min(all, value);
    }
  }
  put(2u, tile_x * 16u + tx, tile_y * 16u + ty, all);
  farthest[gl_LocalInvocationID.x] = all;
  uint side = 16u;
  for (uint level = 3u; level <= 6u; ++level) {
    barrier();
    side >>= 1u;
    const uint x = gl_LocalInvocationID.x % side, y = gl_LocalInvocationID.x / side;
    uint value = 0u;
    if (gl_LocalInvocationID.x < side * side) {
      const uint at = 4u * side * y + 2u * x;  // rows of the finer level are 2 * side long
      value = min(min(farthest[at], farthest[at + 1u]), min(farthest[at + 2u * side], farthest[at + 2u * side + 1u]));
      put(level, tile_x * side + x, tile_y * side + y, value);
    }
    barrier();
    if (gl_LocalInvocationID.x < side * side) farthest[gl_LocalInvocationID.x] = value;
  }
}

void main() {
  // Where the second pass drew nothing the pyramid is already that of the whole picture.
  if (pass == 0u || counters.stages[STAGE_SOFTWARE + 1u].x + counters.stages[STAGE_HARDWARE + 1u].x > 0u) build_tile();
}
