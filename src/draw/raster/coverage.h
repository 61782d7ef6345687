// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage and depth in integers (Pineda 1988): which pixel centres a triangle covers, and the nearest triangle there.
//
// The top-left rule is what one gets by moving every pixel centre by an infinitesimal amount to the right and a much
// smaller one down: then no centre lies on an edge, and a point is inside exactly one of the triangles around it. The
// same argument holds for signed sums, which is why clipped polygons are drawn as signed fans.
#pragma once

#include <cstdint>
#include <span>

#include "draw/raster/raster.h"
#include "draw/raster/screen.h"

namespace meshlode::draw {

/// Draws a soup into the buffer. The result depends neither on the order of the triangles nor on the threads: the pixel
/// keeps the largest depth, and of equal depths the lowest key.
void draw_soup(const ScreenSoup& soup, VisibilityBuffer& buffer);

/// 2^32 values at the vertices, interpolated exactly: floor(sum(weight · depth) / area).
/// \pre weights are not negative and their sum is `area` > 0
[[nodiscard]] std::uint32_t interpolate_depth(const ScreenTriangle& triangle, const std::int64_t (&weights)[3],
                                              std::int64_t area);

}  // namespace meshlode::draw
