// SPDX-License-Identifier: MIT
// Levels that fade into each other instead of popping: what a renderer adds to the rule of metric.h, once, as C++ and
// as GLSL. Nothing more is stored. docs/reference/selection.md, "Fading".
//
// The rule is asked at FADE_STEPS thresholds, from the pixel error t down to nearly t / 2. Each of these is a cut of
// its own: every piece of surface is drawn once in it (I5). A group that passes at the first so many steps of them has
// these *steps*; a cluster is drawn in the cuts from its coarser group's steps on up to its own group's, so that its
// weight
//     (steps of its own group - steps of its coarser group) / FADE_STEPS      level 0: its own are FADE_STEPS
// is the share of the cuts that draw it. Along any path from level 0 to a root these sum to exactly one, and nothing
// that is drawn at all is off by more than t pixels.
//
// Without blending: give each pixel a number from 0 to FADE_STEPS - 1, a dither pattern, and draw a cluster there iff
// fade_is_drawn. Each pixel then shows one whole cut: no hole, and nothing twice.
#ifndef MESHLODE_SELECT_FADE_H
#define MESHLODE_SELECT_FADE_H

#ifdef __cplusplus
#include <cstdint>

#include "run/select/metric.h"
namespace meshlode::run {
using FadeCount = std::uint32_t;
#define FADE_FUNCTION [[nodiscard]] inline
#define FADE_VALUE const float
#define FADE_STEPS 16U
#else
#include "metric.h"
#define FadeCount uint
#define FADE_FUNCTION
#define FADE_VALUE precise float
#define FADE_STEPS 16u
#endif

// The view whose cut is that of a step, 0 to FADE_STEPS - 1. A larger factor lets fewer groups pass.
FADE_FUNCTION MetricView fade_view(MetricView view, FadeCount at_step) {
  FADE_VALUE factor = 1.0f + float(at_step) * 0.0625f;
  FADE_VALUE scale = view.error_scale * factor;
  view.error_scale = scale;
  return view;
}

// At how many steps a group passes: at all below it and none from it on, 0 to FADE_STEPS. Where view.error_scale is
// that of t pixels.
FADE_FUNCTION FadeCount fade_steps(MetricView view, float center_x, float center_y, float center_z, float radius,
                                   float error) {
  FadeCount low = FadeCount(0), high = FADE_STEPS;  // by halves: 5 tests
  while (low < high) {
    FadeCount middle = (low + high) / FadeCount(2);
    if (metric_passes(fade_view(view, middle), center_x, center_y, center_z, radius, error)) {
      low = middle + FadeCount(1);
    } else {
      high = middle;
    }
  }
  return low;
}

// Of a cluster, by its groups' steps; `own_steps` of level 0 is FADE_STEPS. 0 where it is not drawn at all.
FADE_FUNCTION float fade_weight(FadeCount own_steps, FadeCount coarser_steps) {
  return own_steps > coarser_steps ? float(own_steps - coarser_steps) * 0.0625f : 0.0f;
}

// In the cut of a step.
FADE_FUNCTION bool fade_is_drawn(FadeCount own_steps, FadeCount coarser_steps, FadeCount at_step) {
  return at_step >= coarser_steps && at_step < own_steps;
}

#undef FADE_FUNCTION
#undef FADE_VALUE
#ifdef __cplusplus
}  // namespace meshlode::run
#endif

#endif  // MESHLODE_SELECT_FADE_H
