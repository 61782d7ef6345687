// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_materials_variants: which material a primitive has in which variant travels with the mesh.
#pragma once

#include <string>
#include <vector>

#include "scene/import/gltf/gltf.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Types and indices of every mapping. \pre check_gltf's look at meshes and materials. Errors: kInvalid.
[[nodiscard]] Status check_gltf_variants(const Json& root, const std::string& file);

/// The primitives of mesh `m` that have mappings, as glTF has them but without geometry: `material` and `extensions`.
/// In an asset triangles are told apart by their materials alone, so it is one for each material; where primitives of
/// one material have other mappings than each other, that material has none, which `left_out` says.
[[nodiscard]] Json::Array variant_primitives(const GltfAsset& asset, std::size_t m, std::vector<LeftOut>& left_out);

/// A material samples the UV sets that its variants do, so that they are kept.
void keep_uv_sets_of_variants(const GltfAsset& asset, std::vector<SceneMaterial>& materials);

}  // namespace meshlode::scene
