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
  bool has_restarts = false;  ///< an extension lets strips and fans have restart values
  // What is said once of the whole file: vertices.
  std::uint64_t clamped_colors = 0;  ///< with values outside 0 … 1
  std::uint64_t whole_colors = 0;    ///< whose whole numbers are not said to be normalized, and are above 1
};

/// Which joints move each stored vertex of a primitive, `width` of them, and how much.
struct VertexWeights {
  std::size_t width = 0;  ///< 4 for each pair of JOINTS_n and WEIGHTS_n; 0: it has none
  std::vector<std::uint32_t> joints;
  std::vector<double> weights;  ///< as they are: they may be anything
};

/// Nothing where the primitive has no triangles to give (points, lines, no POSITION), which is said in left_out.
/// The material is glTF's index, or invalid where there is none. `json`: the primitive's own text.
/// `weights` gets those of the vertices where it is given.
/// Errors: kInvalid; with options.repair broken triangles are dropped and counted in `drops` instead.
[[nodiscard]] Result<std::optional<Primitive>> read_primitive(PrimitiveContext& context, std::size_t mesh,
                                                              std::size_t primitive, const Json& json,
                                                              ImportDrops& drops, VertexWeights* weights);

}  // namespace meshlode::scene
