// SPDX-License-Identifier: GPL-3.0-or-later
// What texture coordinates and normals count as beside positions.
#pragma once

#include <array>

#include "scene/scene.h"

namespace meshlode::builder {

/// What a promise counts beside positions (docs/reference/selection.md), object units; 0: nothing.
struct PaintedUnits {
  double normal = 0.0;                                        ///< of a unit normal
  std::array<std::array<double, 2>, scene::kMaxUvSets> uv{};  ///< of a UV unit in u and v, by stored set
};

}  // namespace meshlode::builder
