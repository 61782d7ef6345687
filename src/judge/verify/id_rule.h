// SPDX-License-Identifier: GPL-3.0-or-later
// Whether each pixel still shows the surface that the source shows there (V211). Internal to the judge.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "judge/pictures/cameras.h"
#include "judge/pictures/id_distance.h"
#include "judge/validate/rules.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// Of both pictures' pixels, so many may show another surface.
constexpr double kMostAstray = 0.005;

/// One cut's picture against the source's.
struct JudgedIds {
  std::string camera;
  double pixel_error = 0.0;
  IdDistance distance;
};

/// Around the scene, `count` whole views and as many close ones, which see a fifth of it from the same places. None
/// where nothing can be drawn.
[[nodiscard]] std::vector<NamedCamera> id_cameras(const run::Asset& asset, std::uint32_t count, std::uint64_t seed);

/// Draws source and cuts by the CPU and adds V211 for each picture that is beyond the limit. A camera that cannot be
/// drawn from has no pictures.
[[nodiscard]] std::vector<JudgedIds> check_ids(const run::Asset& asset, const scene::Scene& source,
                                               std::uint32_t count, std::uint64_t seed, RuleLog& log);

}  // namespace meshlode::judge
