// SPDX-License-Identifier: GPL-3.0-or-later
// How many texels a unit of texture coordinates spans, so that a budget can be given in texels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace meshlode::builder {

/// For each TEXCOORD_n: the most texels that a unit of it spans, over every texture that the mesh's materials sample
/// with it, KHR_texture_transform's scale included. 0 where no texture of known size is sampled.
[[nodiscard]] std::array<double, scene::kMaxUvSets> texels_per_unit(const scene::Scene& scene,
                                                                    const scene::SourceMesh& mesh);

/// The same for each of Scene::materials: images are looked at once, however many meshes there are …
[[nodiscard]] std::vector<std::array<double, scene::kMaxUvSets>> texels_of_materials(const scene::Scene& scene);
/// … and for the materials of a mesh together.
[[nodiscard]] std::array<double, scene::kMaxUvSets> texels_per_unit(
    std::span<const std::array<double, scene::kMaxUvSets>> of_materials, const scene::SourceMesh& mesh);

/// Texels that a unit of a TEXCOORD_n spans along u and along v.
using TexelExtents = std::array<std::array<double, 2>, scene::kMaxUvSets>;

/// The same along each axis by itself, of each of Scene::materials: the largest of the textures that it samples with
/// the set, where an image of unknown size counts as 2,048 by 2,048; 0 0 where it samples none. Rotations are left out.
[[nodiscard]] std::vector<TexelExtents> texel_extents_of_materials(const scene::Scene& scene);

}  // namespace meshlode::builder
