// SPDX-License-Identifier: GPL-3.0-or-later
// Raster: the CPU reference rasterizer. Integer edge functions on 1/256 pixel coordinates, top-left rule, depth 32-bit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "read/asset.h"
#include "select/select.h"

namespace meshlode {

enum class View : std::uint8_t { kShaded, kClusters, kTriangles, kLevels };

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 bytes a pixel, top row first
};

/// Draws the given cut. Errors: kInvalid for a broken page.
[[nodiscard]] Result<Image> render_cut(const Asset& asset, std::span<const ClusterInstance> cut, const Camera& camera,
                                       View view);

[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace meshlode
