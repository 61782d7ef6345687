// SPDX-License-Identifier: MIT
// The rule as a GPU sees it: tests compile this, so that metric.h stays GLSL as well as C++ (I9).
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "metric.h"

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Views { MetricView view; };
layout(std430, binding = 1) readonly buffer Bounds { float bounds[]; };  // center xyz, radius, error
layout(std430, binding = 2) writeonly buffer Answers { uint answers[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  bool passes = metric_passes(view, bounds[5 * i], bounds[5 * i + 1], bounds[5 * i + 2], bounds[5 * i + 3],
                              bounds[5 * i + 4]);
  answers[i] = passes ? 1u : 0u;
}
