// SPDX-License-Identifier: GPL-3.0-or-later
// Materials of what stands for an aggregate's pieces: opaque, seen from both sides, and in one colour, the mean of what
// the pieces show. They stand behind the scene's own, in the asset's table and in its document.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "builder/aggregate/material_looks.h"
#include "builder/aggregate/pieces.h"
#include "scene/scene.h"

namespace meshlode::builder {

struct CoarseMaterials {
  std::vector<scene::SceneMaterial> materials;  ///< the scene's, then those that were derived from them
  std::string document;                         ///< the scene's, with these
  std::vector<SourceMaterial> of_source;        ///< by the scene's material ids
};

/// Whether pixels have to be looked at to know what a material draws, and in which colour.
[[nodiscard]] bool needs_look(const scene::SceneMaterial& material);

/// For the materials that pieces of aggregates have (`is_used`, by id). A material that is opaque, double sided and
/// without texture stands for itself. `looks`: by material, those that need one. Errors: kInvalid for a document that
/// is no JSON object.
[[nodiscard]] Result<CoarseMaterials> derive_materials(const scene::Scene& scene, std::span<const std::uint8_t> is_used,
                                                       std::span<const std::optional<MaterialLook>> looks);

}  // namespace meshlode::builder
