// SPDX-License-Identifier: GPL-3.0-or-later
// One glTF primitive becomes one flat triangle list.
#pragma once

#include <optional>
#include <vector>

#include "scene/import/gltf/gltf.h"
#include "scene/import/import.h"
#include "scene/scene.h"

namespace meshlode::scene {

struct PrimitiveContext {
  const GltfAsset* asset = nullptr;
  const ImportOptions* options = nullptr;
  DecodeBudget* budget = nullptr;
  std::vector<LeftOut>* left_out = nullptr;
};

/// Nothing where the primitive has no triangles to give (points, lines, no POSITION), which is said in left_out.
/// The material is glTF's index, or invalid where there is none. `json`: the primitive's own text.
/// Errors: kInvalid; with options.repair broken triangles are dropped and counted in `drops` instead.
[[nodiscard]] Result<std::optional<Primitive>> read_primitive(const PrimitiveContext& context, std::size_t mesh,
                                                              std::size_t primitive, const Json& json,
                                                              ImportDrops& drops);

}  // namespace meshlode::scene
