// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that are equal to the last bit are built once.
#pragma once

#include "scene/import/gltf/gltf.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Of meshes with the same primitives (every array, the material and its variants) the first keeps them; instances and
/// the nodes of the tree name it instead of the others, which stay in the list with their names, empty. scene.left_out
/// says which. \pre the meshes are read, the instances too
void merge_equal_meshes(GltfAsset& asset, Scene& scene);

}  // namespace meshlode::scene
