// SPDX-License-Identifier: GPL-3.0-or-later
// Exact predicates on floats: sums of products held as expansions of doubles (Shewchuk 1997), so that a containment is
// proven and not estimated. Exact for |values| between 2^-500 and 2^500 and their differences, far beyond any float.
#pragma once

#include "base/vec.h"

namespace meshlode::judge {

struct ExactBall {
  float center[3];
  float radius;
};

/// |outer.center - inner.center| + inner.radius <= outer.radius, exactly. \pre all finite, radii >= 0
[[nodiscard]] bool contains_ball(const ExactBall& outer, const ExactBall& inner);
/// |ball.center - point| <= ball.radius, exactly. \pre all finite, radius >= 0
[[nodiscard]] bool contains_point(const ExactBall& ball, const Vec3d& point);

}  // namespace meshlode::judge
