// SPDX-License-Identifier: GPL-3.0-or-later
// An asset's errors measured anew, by another tier: what a build with that tier would write, without one.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::app {

/// The whole file: pages, spheres and tables of places stay, of all meshes. Byte for byte that of a build of `source`
/// with the tier, where this program built the asset in level order. Errors: kCheckFailed where the asset's level 0 is
/// not made of the source's triangles; kUnsupported where errors cannot be measured so (promises, parts that are
/// aggregates); kInvalid, and those of unpacking, where the asset is damaged. Threads: those of the caller's arena.
[[nodiscard]] Result<std::vector<std::uint8_t>> measure_asset(const run::Asset& asset, const scene::Scene& source,
                                                              format::ErrorTier tier);

}  // namespace meshlode::app
