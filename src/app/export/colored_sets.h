// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of clusters as a GLB in which each set has a colour of its own: for looking at parts of an asset, such as the
// groups where simplification is stuck.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/ids.h"
#include "run/read/asset.h"

namespace meshlode::app {

struct ColoredSet {
  MeshId mesh;
  std::string name;              ///< of the material
  std::array<float, 3> color{};  ///< base colour, linear
  std::vector<ClusterId> clusters;
};

/// One mesh for each mesh of the asset that a set names, one material for each name and colour, one node for each of
/// its instances that can be drawn. Positions alone, so it is shaded flat; nothing else of the scene. Without any
/// cluster a glTF without meshes. Errors: kUsage for clusters that are not of the set's mesh or named twice in it; what
/// load_page reports.
[[nodiscard]] Result<std::vector<std::uint8_t>> export_colored_sets(const run::Asset& asset,
                                                                    std::span<const ColoredSet> sets);

}  // namespace meshlode::app
