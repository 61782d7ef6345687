// SPDX-License-Identifier: MIT
// The depth pyramid. A texel of level l is the farthest depth (the smallest number) of the pixels (x >> l, y >> l): with
// sizes rounded up nothing is left out at any resolution. A workgroup makes levels 1 to 6 of 64 × 64 pixels; the one that
// is done last makes the levels above, which are small (one pass for all levels: AMD's single pass downsampler).
#version 460
#define GROUP_SIZE 256
#include "common.glsl"

shared uint farthest[256];
shared bool is_last;

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
  if (group_index() == 0u && gl_LocalInvocationID.x == 0u) {
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

void build_levels() {
  for (uint level = 7u; level <= frame.pyramid_levels; ++level) {
    const uint fine_width = (frame.width + (1u << (level - 1u)) - 1u) >> (level - 1u);
    const uint fine_height = (frame.height + (1u << (level - 1u)) - 1u) >> (level - 1u);
    const uint width = (fine_width + 1u) / 2u, height = (fine_height + 1u) / 2u;
    const uint fine = frame.pyramid_offset[level - 1u];
    for (uint i = gl_LocalInvocationID.x; i < width * height; i += uint(GROUP_SIZE)) {
      const uint x = i % width, y = i / width;
      const uint x1 = min(2u * x + 1u, fine_width - 1u), y1 = min(2u * y + 1u, fine_height - 1u);
      frame.pyramid.at[frame.pyramid_offset[level] + i] =
          min(min(frame.pyramid.at[fine + 2u * y * fine_width + 2u * x], frame.pyramid.at[fine + 2u * y * fine_width + x1]),
              min(frame.pyramid.at[fine + y1 * fine_width + 2u * x], frame.pyramid.at[fine + y1 * fine_width + x1]));
    }
    memoryBarrierBuffer();
    barrier();
  }
}

void main() {
  build_tile();
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    is_last = atomicAdd(counters.pyramid_tiles, 1u) + 1u == gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  }
  barrier();
  memoryBarrierBuffer();
  if (is_last) build_levels();
}
