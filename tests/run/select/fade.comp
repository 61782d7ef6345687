// SPDX-License-Identifier: MIT
// Fading as a GPU sees it: tests compile this, so that fade.h stays GLSL as well as C++ (I9).
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "fade.h"

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Views { MetricView view; };
layout(std430, binding = 1) readonly buffer Bounds { float bounds[]; };  // center xyz, radius, error
layout(std430, binding = 2) writeonly buffer Weights { float weights[]; };

uint steps_of(uint i) {
  return fade_steps(view, bounds[5 * i], bounds[5 * i + 1], bounds[5 * i + 2], bounds[5 * i + 3], bounds[5 * i + 4]);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  uint own = steps_of(2 * i), coarser = steps_of(2 * i + 1);
  weights[2 * i] = fade_weight(own, coarser);
  weights[2 * i + 1] = fade_is_drawn(own, coarser, i % FADE_STEPS) ? 1.0 : 0.0;
}
