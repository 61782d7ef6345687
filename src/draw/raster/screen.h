// SPDX-License-Identifier: GPL-3.0-or-later
// From clip coordinates to triangles in integers: near-plane clipping, the perspective divide and facing.
//
// A vertex is quantized once, from its own numbers alone: triangles that share a vertex share its integers. An edge
// that is clipped is cut from its inner to its outer end whichever triangle it belongs to, so that neighbours share the
// new vertex too. With that, and with the top-left rule of coverage.h, two triangles on both sides of an edge never
// leave a pixel out and never draw one twice.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "draw/raster/masked_triangle.h"

namespace meshlode::draw {

constexpr int kSubpixelBits = 8;
constexpr std::int32_t kSubpixels = 1 << kSubpixelBits;
constexpr std::uint32_t kMaxImageSide = 16384;
/// Vertices farther than this from the picture's middle, in pixels, are clipped away: with 2^28 subpixels a coordinate,
/// differences are below 2^30 and edge functions below 2^61.
constexpr double kGuardPixels = 1048576.0;

struct ImageSize {
  std::uint32_t width = 0, height = 0;
};

/// Homogeneous: the pixel is (width/2 + x/w, height/2 + y/w) with y down, the depth is z/w, larger = nearer. In front
/// of the near plane iff z <= w. \pre w > 0 or z > w: what is not behind the near plane has a positive w
struct ClipVertex {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};

/// Subpixels from the top left corner of the picture; depth as in VisibilityBuffer.
struct ScreenVertex {
  std::int32_t x = 0, y = 0;
  std::uint32_t depth = 0;
};

/// Whose a pixel is. Item and triangle decide between equal depths; lower wins.
struct TriangleKey {
  static constexpr std::uint32_t kOpaque = 0xFFFFFFFFu;
  std::uint32_t item = 0, triangle = 0;
  std::uint32_t mask = kOpaque;  ///< into ScreenSoup::masked: what passes_alpha() is asked
};

struct ScreenTriangle {
  std::array<ScreenVertex, 3> v;  ///< of positive area: clockwise on the screen
  TriangleKey key;
};

/// What clipping leaves of a triangle. Rounding may bend it a little, so it is drawn as a signed fan (coverage.h).
struct ScreenPolygon {
  /// A triangle cut by five planes has at most 8; where rounding bends it, a plane adds at most half as many again.
  static constexpr std::size_t kMaxVertices = 20;
  std::array<ScreenVertex, kMaxVertices> v;
  std::uint32_t count = 0;
  TriangleKey key;
};

struct ScreenSoup {
  std::vector<ScreenTriangle> triangles;
  std::vector<ScreenPolygon> polygons;
  std::vector<MaskedTriangle> masked;
  std::uint64_t not_finite = 0;  ///< triangles left out because a coordinate overflowed
};

enum class Culling : std::uint8_t {
  kNone,              ///< double sided
  kClockwise,         ///< counter-clockwise triangles (y up) are front faces
  kCounterClockwise,  ///< the same, mirrored
};

/// The vertex in integers, or nothing where it has to be clipped or is not finite.
[[nodiscard]] std::optional<ScreenVertex> snap_vertex(const ClipVertex& v, ImageSize size);

/// Adds a triangle whose vertices were all snapped, unless it is culled, has no area or no pixel centre in its bounds.
void add_snapped(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, Culling culling, TriangleKey key,
                 ImageSize size, ScreenSoup& out);

/// Adds any triangle: clips it where it has to be.
void add_triangle(const std::array<ClipVertex, 3>& v, Culling culling, TriangleKey key, ImageSize size,
                  ScreenSoup& out);

/// Rows or columns whose pixel centres lie in [low, high] subpixels, clamped to `count`; empty where first > last.
struct PixelRange {
  std::int32_t first = 0, last = -1;
  [[nodiscard]] bool is_empty() const { return first > last; }
};
[[nodiscard]] PixelRange pixels_between(std::int32_t low, std::int32_t high, std::uint32_t count);

/// Twice the signed area; positive = clockwise on the screen.
[[nodiscard]] std::int64_t doubled_area(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c);

}  // namespace meshlode::draw
