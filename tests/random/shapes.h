// SPDX-License-Identifier: GPL-3.0-or-later
// The pieces of random scenes: surfaces that meet, pinch, fold, repeat and degenerate in the ways that scenes do which
// nobody chose. No math library but sqrt, floor and ldexp: a seed gives the same bits with every compiler.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dice.h"

namespace meshlode::test {

/// Triangles over shared points, about one unit large.
struct Shape {
  std::vector<Vec3d> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::uint32_t add(const Vec3d& p) {
    points.push_back(p);
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles.push_back({a, b, c}); }
  /// Corners in turn; for corners that are made on the way, whose order a braced list fixes.
  void quad(const std::array<std::uint32_t, 4>& c) { quad(c[0], c[1], c[2], c[3]); }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  void append(const Shape& other);
};

/// One kind of piece. `make` is given about how many triangles the piece may have, at least 1, and keeps to that within
/// a few dozen.
struct ShapeKind {
  const char* name;
  Shape (*make)(Dice& dice, std::uint32_t triangles);
};

[[nodiscard]] std::span<const ShapeKind> shape_kinds();

/// Harm done to a finished piece: triangles doubled (turned, or facing away), degenerate ones among them, points moved
/// a little or snapped to a coarse lattice. Each with its own chance, none in about half the cases.
void damage(Shape& shape, Dice& dice);

}  // namespace meshlode::test
