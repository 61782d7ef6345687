// SPDX-License-Identifier: GPL-3.0-or-later
// Faults that single triangles have, or a few of them have for all. Each function looks for one; `count` 0: none.
#pragma once

#include "scene/detect/fault.h"
#include "scene/detect/topology.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Positions, normals, texture coordinates and colours; import mends or refuses them, a caller's arrays may have them.
[[nodiscard]] Fault find_not_finite(const SourceMesh& mesh, const Topology& topology);
[[nodiscard]] Fault find_degenerate_faces(const Topology& topology);
[[nodiscard]] Fault find_duplicate_faces(const Topology& topology);

/// Longest edge over height on it.
constexpr double kNeedleRatio = 100.0;
/// Where they are one of a hundred triangles or more.
[[nodiscard]] Fault find_needles(const Topology& topology);

/// The thousandth of the triangles that hold half of the error and more, the worst first. The error of a triangle is a
/// third of that of its corners: what moving the corner to the best of its neighbours would cost by the quadric of its
/// triangles (Garland and Heckbert 1997), which is what a first collapse costs. Of meshes of 1000 triangles and more,
/// where the worst corner would move by a ten-thousandth of the diagonal.
[[nodiscard]] Fault find_error_in_few(const Topology& topology);

}  // namespace meshlode::scene
