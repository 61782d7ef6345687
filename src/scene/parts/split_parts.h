// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh of which loose pieces are a mesh of their own: the leaves of a tree whose trunk stays.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace meshlode::scene {

struct MeshPart {
  std::uint32_t of = 0;                       ///< the mesh whose pieces they are
  std::string name = {};                      ///< of the new mesh
  std::vector<std::uint32_t> most_triangles;  ///< which pieces: Pieces::find_small()
};

/// Takes the pieces out of their meshes. The new meshes follow behind the scene's in the order of `parts`, and their
/// instances behind the scene's, in their order: one for each of the mesh that they are of, of the same node, name and
/// transform. Of
/// primitives without a triangle in a mesh nothing is left there; what import counted stays with the mesh.
/// \pre no mesh has two parts
void split_parts(Scene& scene, std::span<const MeshPart> parts);

}  // namespace meshlode::scene
