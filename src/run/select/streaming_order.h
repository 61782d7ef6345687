// SPDX-License-Identifier: MIT
// In which order to load all pages of an asset, for no camera.
#pragma once

#include <cstdint>
#include <vector>

#include "run/read/asset.h"

namespace meshlode::run {

/// Each page behind those that it depends on, those with the largest errors first, over all meshes.
[[nodiscard]] std::vector<std::uint32_t> streaming_order(const Asset& asset);

}  // namespace meshlode::run
