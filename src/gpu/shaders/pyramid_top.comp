// SPDX-License-Identifier: MIT
// The levels of the depth pyramid above the sixth: small, one workgroup makes them all.
#version 460
#define GROUP_SIZE 256
#include "common.glsl"

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
  if (pass == 0u || counters.stages[STAGE_SOFTWARE + 1u].x + counters.stages[STAGE_HARDWARE + 1u].x > 0u) build_levels();
}
