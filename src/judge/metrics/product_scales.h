// SPDX-License-Identifier: GPL-3.0-or-later
// What UVs and normals count as in the product space (product_distance.h).
#pragma once

#include <array>

#include <meshlode/format.h>

#include "base/ids.h"
#include "base/vec.h"
#include "judge/metrics/shaded_surface.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// What counts beside positions, as lengths. Where all are 0 the distance is that of the positions.
struct ProductScales {
  std::array<Vec2d, scene::kMaxUvSets> uv{};  ///< object units per UV unit in u and v, by TEXCOORD_n; 0: does not count
  double normal = 0.0;                        ///< lambda: object units that a unit normal counts; 0: does not count
};

/// What counts for a promise, as the asset says of a mesh. \pre the asset has the promise
[[nodiscard]] ProductScales scales_of(const run::Asset& asset, MeshId mesh, format::Promise promise);

/// What floats lose of UVs and normals as they are read and decoded, object units.
[[nodiscard]] double rounding_of(const ShadedSurface& source, const ProductScales& scales);

}  // namespace meshlode::judge
