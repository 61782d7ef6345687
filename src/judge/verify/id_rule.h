// SPDX-License-Identifier: GPL-3.0-or-later
// Whether each pixel still shows the surface that the source shows there (V211). Internal to the judge.
#pragma once

#include <cstdint>
#include <vector>

#include "judge/pictures/cameras.h"
#include "judge/pictures/id_judge.h"
#include "judge/validate/rules.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// Around the scene and above it, `count` whole views and as many close ones, which see a fifth of it from the same
/// places. None where nothing can be drawn.
[[nodiscard]] std::vector<NamedCamera> id_cameras(const run::Asset& asset, std::uint32_t count, std::uint64_t seed);

/// Whether some mesh's errors are estimates (tier qem): what they promise of pictures is not judged.
[[nodiscard]] bool has_estimates(const run::Asset& asset);

/// Draws source and cuts by the CPU and adds V211 for each picture that is beyond the limit, where errors are more than
/// estimates. Of a scene that has a great many triangles with all its instances there are fewer cameras than `count`,
/// at last none; a camera that cannot be drawn from has no pictures.
[[nodiscard]] IdTotals check_ids(const run::Asset& asset, const scene::Scene& source, std::uint32_t count,
                                 std::uint64_t seed, RuleLog& log);

}  // namespace meshlode::judge
