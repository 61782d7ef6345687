// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "base/vec.h"

namespace meshlode::builder {

struct Ball {
  Vec3d center{0.0};
  double radius = 0.0;
};

/// The centre of a near-smallest ball around `balls`, and its radius up to rounding: callers measure the radius they
/// store themselves. Exactly reproducible: + - * / sqrt in a fixed order, no randomness. Scale-free: any finite size.
/// \pre `balls` is not empty and finite, radii are not negative.
[[nodiscard]] Ball enclosing_ball(std::span<const Ball> balls);

/// What may stand in its place, under the same contract.
using EnclosingBall = Ball (*)(std::span<const Ball> balls);

}  // namespace meshlode::builder
