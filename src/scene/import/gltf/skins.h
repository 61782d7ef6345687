// SPDX-License-Identifier: GPL-3.0-or-later
// Skinned meshes in the rest pose of the file: a static asset has no joints, but the mesh stands where they put it.
#pragma once

#include <vector>

#include <meshlode/result.h>

#include "scene/import/gltf/gltf.h"
#include "scene/import/gltf/primitive.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Whether some node draws the mesh with a skin: by mesh.
[[nodiscard]] std::vector<bool> find_skinned_meshes(const GltfAsset& asset);

/// The transform of a node that draws a mesh with a skin says nothing about the mesh (glTF 2.0, section 3.7.3.3): each
/// vertex goes where its joints put it. The mesh moves from that node to a new one, behind the others and a root of the
/// same scenes. Where all joints of the mesh have one matrix in common, that is the new node's; else the vertices of
/// the mesh are moved and the new node has none: in the mesh's own place where nobody else draws it as it was, in a new
/// mesh behind the others if not.
/// `weights`: by mesh and primitive of scene.meshes. Skins, and what of their weights is not used, are said in
/// scene.left_out. \pre the asset is checked, its instancing expanded, scene.meshes read.
/// Errors: kInvalid inverse bind matrices that are too few or of another type, joints in use whose matrix is not
/// finite, or more copies than the files justify.
[[nodiscard]] Status settle_skins(GltfAsset& asset, const std::vector<std::vector<VertexWeights>>& weights,
                                  DecodeBudget& budget, Scene& scene);

}  // namespace meshlode::scene
