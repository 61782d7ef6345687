// SPDX-License-Identifier: GPL-3.0-or-later
// Normals that say nothing.
#pragma once

#include <cstddef>

#include "scene/scene.h"

namespace meshlode::scene {

/// Gives each normal that is not finite or has no length the area-weighted sum of its triangles' own.
/// \returns how many that a triangle names. \pre the positions and indices are those that stay
std::size_t mend_normals(Primitive& primitive);

}  // namespace meshlode::scene
