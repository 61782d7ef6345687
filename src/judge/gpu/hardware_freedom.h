// SPDX-License-Identifier: GPL-3.0-or-later
// What the specification leaves free when hardware draws a triangle: which pixels it may cover, which it must, and what
// depth it may have there. docs/gpu.md derives it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "draw/raster/screen.h"

namespace meshlode::judge {

/// One result of the fixed functions' arithmetic, relative: they take binary32, and are off by two units in the last
/// place at most. (The specification asks for no more than 1 part in 10^5 there.)
constexpr double kFixedFunctionError = 0x1p-22;

/// A triangle as it would be drawn in real numbers, clipped to 0 <= z <= w, and how far from there hardware may put it.
class TriangleFreedom {
 public:
  struct Corner {
    double x = 0.0, y = 0.0;  ///< pixels from the picture's top left
    double z = 0.0;           ///< depth, 0 … 1, larger = nearer
    double inverse_w = 1.0;
    /// The triangle's edge k (from corner k to k + 1) to the next corner, or kCut.
    int edge = 0;
  };
  static constexpr int kCut = -1;
  static constexpr std::size_t kMaxCorners = 5;

  /// `subpixel_bits`: subPixelPrecisionBits of the device.
  TriangleFreedom(const std::array<draw::ClipVertex, 3>& v, draw::ImageSize size, std::uint32_t subpixel_bits);

  /// Nothing of it is in front of the near plane and before the far one.
  [[nodiscard]] bool is_empty() const { return count_ == 0; }
  /// Twice the signed area, as doubled_area() has it; of the unclipped part.
  [[nodiscard]] double area() const { return area_; }
  /// Hardware may see it from the other side, or as nothing.
  [[nodiscard]] bool is_facing_open() const { return is_facing_open_; }
  /// Pixels that it may cover lie within: first and last, clamped to the picture; empty where first > last.
  [[nodiscard]] draw::PixelRange columns() const { return columns_; }
  [[nodiscard]] draw::PixelRange rows() const { return rows_; }

  struct Sample {
    double low = 0.0, high = 0.0;  ///< depths that it may have there, units of 2^-32
    double reach = 0.0;            ///< how far the sample may be from where it is on the triangle, pixels
    bool is_certain = false;       ///< it covers the sample however the freedom is used
  };
  /// At a pixel's centre; nothing where it cannot cover it.
  [[nodiscard]] std::optional<Sample> at(std::int32_t pixel_x, std::int32_t pixel_y) const;

  /// Edges of the clipped triangle that pass within `reach` of a pixel's centre: bit k, and bit 3 for one where it was
  /// cut.
  [[nodiscard]] std::uint32_t edges_near(std::int32_t pixel_x, std::int32_t pixel_y, double reach) const;

 private:
  void clip(const std::array<draw::ClipVertex, 3>& v, draw::ImageSize size);
  void find_planes();
  void find_facing();
  void find_bounds(draw::ImageSize size);
  [[nodiscard]] double reach_at(double x, double y) const;

  /// a · x + b · y + c over the picture.
  struct Plane {
    double a = 0.0, b = 0.0, c = 0.0;
    [[nodiscard]] double at(double x, double y) const { return a * x + b * y + c; }
    [[nodiscard]] double change(double reach) const;  ///< largest, within `reach` on either axis
  };

  std::array<Corner, kMaxCorners> corners_{};
  std::size_t count_ = 0;
  double area_ = 0.0;
  bool is_facing_open_ = true;
  bool has_planes_ = false;
  Plane z_, inverse_w_;
  double interpolation_ = 0.0;  ///< pixels: arithmetic of depth's plane
  double snap_ = 0.0;           ///< pixels: the subpixel grid, and interpolation
  double clip_error_ = 0.0;     ///< pixels · w: over w it is what clip coordinates may be off
  double largest_w_ = 0.0, largest_z_ = 0.0, operations_ = 0.0;
  double max_inverse_w_ = 0.0, min_z_ = 1.0, max_z_ = 0.0;
  double extent_ = 0.0;        ///< pixels, the longer side of its bounds
  double weight_error_ = 1.0;  ///< of barycentric coordinates, by the arithmetic of areas
  draw::PixelRange columns_, rows_;
};

}  // namespace meshlode::judge
