// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of an exported document, and the meshes and levels that they draw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/export/gltf_document.h"
#include "base/vec.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// A mesh of the exported document.
struct ExportedMesh {
  std::vector<std::uint32_t> levels;  ///< indices in the glTF, the finest first; empty without primitives
  Vec3d translation{0.0};             ///< of a node to put around it
  double step = 0.0;                  ///< its scale, where positions are quantized; else 0
  std::string name;
  std::vector<double> screen_coverage;
  [[nodiscard]] bool is_moved() const { return step > 0.0 || translation != Vec3d(0.0); }
};

/// "NAME (level 2)".
[[nodiscard]] std::string level_name(const std::string& name, std::size_t level);

/// Gives each node of the document that draws a mesh its exported mesh, or none where the cut is empty. A document
/// without nodes gets one for each instance. `origins` names the exported mesh that each mesh of the asset is part of.
/// \returns whether a node has levels. Errors: as malformed()
[[nodiscard]] Result<bool> attach_meshes(const run::Asset& asset, std::span<const std::size_t> origins,
                                         std::span<const ExportedMesh> exported, GltfJson& document);

}  // namespace meshlode::app
