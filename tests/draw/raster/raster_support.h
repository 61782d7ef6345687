// SPDX-License-Identifier: GPL-3.0-or-later
// Drawing plain triangles, and counting how often each pixel is covered.
#pragma once

#include <cstdint>
#include <vector>

#include "base/random.h"
#include "draw/raster/coverage.h"
#include "draw/raster/screen.h"

namespace meshlode::draw::test {

class Random : public SplitMix64 {
 public:
  using SplitMix64::SplitMix64;
  double range(double low, double high) { return SplitMix64::between(low, high); }
  /// low … high, both included.
  std::int32_t between(std::int32_t low, std::int32_t high) {
    const std::int32_t count = high - low + 1;
    return low + static_cast<std::int32_t>(below(static_cast<std::uint64_t>(count)));
  }
};

inline VisibilityBuffer draw(const ScreenSoup& soup, ImageSize size) {
  VisibilityBuffer buffer = make_visibility_buffer(size.width, size.height);
  draw_soup(soup, buffer);
  return buffer;
}

/// Draws every entry of the soup alone, and counts.
inline std::vector<int> count_coverage(const ScreenSoup& soup, ImageSize size) {
  std::vector<int> counts(std::size_t{size.width} * size.height, 0);
  const auto add = [&](const ScreenSoup& one) {
    const VisibilityBuffer buffer = draw(one, size);
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += buffer.item[i] != VisibilityBuffer::kNothing ? 1 : 0;
  };
  for (const ScreenTriangle& triangle : soup.triangles) {
    ScreenSoup one;
    one.triangles.push_back(triangle);
    add(one);
  }
  for (const ScreenPolygon& polygon : soup.polygons) {
    ScreenSoup one;
    one.polygons.push_back(polygon);
    add(one);
  }
  return counts;
}

inline std::size_t count_drawn(const VisibilityBuffer& buffer) {
  std::size_t drawn = 0;
  for (const std::uint32_t item : buffer.item) drawn += item != VisibilityBuffer::kNothing ? 1 : 0;
  return drawn;
}

/// A vertex at a place of the picture given in pixels from the top left, at distance 1 with near 0.5 unless told.
inline ClipVertex at_pixel(double x, double y, ImageSize size, double w = 1.0, double near_distance = 0.5) {
  return {(x - 0.5 * size.width) * w, (y - 0.5 * size.height) * w, near_distance, w};
}

}  // namespace meshlode::draw::test
