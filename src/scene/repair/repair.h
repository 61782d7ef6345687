// SPDX-License-Identifier: GPL-3.0-or-later
// --repair: the geometry of a scene as an oriented surface without doubles. build and verify do it to the same scene in
// the same way.
#pragma once

#include "scene/scene.h"

namespace meshlode::scene {

/// More triangles around one point leave a mesh's orientation as it is: what orients it is quadratic in them.
constexpr std::uint32_t kMaxTrianglesAroundPoint = 16384;

/// Each mesh for itself, all its primitives together; a point is where positions are equal, whatever the attributes.
/// Triangles with two corners in one point are removed, and those with the same three points as an earlier one of their
/// material, in either direction; both are counted in ImportDrops::repaired. Of other materials such a triangle is a
/// layer on the first, and follows it. What is left is oriented, cut at edges of more than two triangles, and split at
/// vertices of more than one fan (orient_soup.h), which shows in the indices: two vertices of a primitive are equal
/// only where the surface is not one there. Positions and attributes stay as they are; what was done is in
/// SourceMesh::repairs, and what could not be in Scene::left_out. A scene without faults gets equal vertices joined,
/// and no other change.
void repair_scene(Scene& scene);

}  // namespace meshlode::scene
