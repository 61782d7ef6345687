// SPDX-License-Identifier: GPL-3.0-or-later
// How long the edges of a mesh are.
#pragma once

#include "builder/prepare/corners.h"

namespace meshlode::builder {

/// The median length of the triangles' edges that have one, in the corners' unit; 0 where none has. Whatever the
/// order of the triangles, the same; of large meshes up to 2^-21 of itself too small, with the right exponent.
[[nodiscard]] double median_edge_length(const Corners& corners);

}  // namespace meshlode::builder
