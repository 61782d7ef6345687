// SPDX-License-Identifier: GPL-3.0-or-later
// Export: a cut of an asset as a GLB that keeps nodes, names, instances, materials and textures.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "app/export/packing.h"
#include "base/ids.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// One cut per mesh of the asset, which may have several of one mesh of the source: parts of it, all of them one mesh
/// in the GLB (an empty cut leaves the mesh without primitives and its nodes without mesh). Positions that are one grid
/// point become one vertex wherever their attributes agree. Errors: kInvalid for a page or a blob that is not what was
/// written.
[[nodiscard]] Result<std::vector<std::uint8_t>> export_glb(const run::Asset& asset,
                                                           std::span<const std::vector<ClusterId>> cut_per_mesh,
                                                           Packing packing = {});

/// The discrete levels of one mesh, the finest first, for MSFT_lod.
struct LodChain {
  std::vector<std::vector<ClusterId>> cuts;
  /// Switch values in [0, 1], one per cut, falling: cut k is meant while its coverage of the screen is at least
  /// screen_coverage[k] (0 for the last: it is never switched off). Empty: no hints are written.
  std::vector<double> screen_coverage;
};

/// Discrete levels of detail: each node with a mesh gets its coarser levels as further nodes, named by MSFT_lod, and
/// the coverage hints as MSFT_screencoverage. A reader without that extension sees the finest level. A mesh with one
/// level is exported as export_glb does. Errors: kUsage for chains and coverage that are not as described.
[[nodiscard]] Result<std::vector<std::uint8_t>> export_glb_lods(const run::Asset& asset,
                                                                std::span<const LodChain> chain_per_mesh,
                                                                Packing packing = {});

}  // namespace meshlode::app
