// SPDX-License-Identifier: GPL-3.0-or-later
// A material of MTL as glTF has it: metallic-roughness, alpha mode, normal and emissive textures.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/import/json.h"
#include "scene/import/polygons/read_mtl.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// The images of its maps that are kept; each image has one texture of its index, and is the blob of that index.
struct MtlImages {
  std::uint32_t base_color = kNoId, metallic_roughness = kNoId, normal = kNoId, emissive = kNoId;
  bool masks = false;  ///< the alpha of the base colour texture is a mask (map_d)
};

/// d counts before Tr. Tr 1 alone would make a surface that nobody sees, and is taken as opaque.
[[nodiscard]] double opacity_of(const MtlMaterial& from);
/// A roughness texture says nothing of metal: it can stand where there is none, or where one file has both.
[[nodiscard]] bool can_have_roughness_map(const MtlMaterial& from);

/// \param out gets what the build acts on
/// \param has_strength becomes true where KHR_materials_emissive_strength is used
/// \returns the material of the document
[[nodiscard]] Json make_material(const MtlMaterial& from, const MtlImages& images, SceneMaterial& out,
                                 bool& has_strength);

}  // namespace meshlode::scene
