// SPDX-License-Identifier: GPL-3.0-or-later
// A GLB as the tests see it: read from the specification alone, sharing no code with what wrote it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <meshlode/result.h>

namespace meshlode::test {

struct Glb {
  nlohmann::json json;
  std::vector<std::uint8_t> bin;

  /// Empty json where the container is wrong; every wrong thing is a test failure too.
  static Glb parse(std::span<const std::uint8_t> bytes);
  /// Rows of an accessor, normalized integers as fractions. Fails the test where it leaves its buffer.
  [[nodiscard]] std::vector<std::vector<double>> rows(std::size_t accessor) const;
  [[nodiscard]] std::vector<std::uint8_t> view_bytes(std::size_t view) const;
  /// Structural rules that hold for every file: indices in range, alignment, min and max, targets, one buffer.
  void expect_sound() const;
};

/// Of what an exporter returned: an error, and whatever is not sound, is a test failure.
[[nodiscard]] Glb read_sound(const Result<std::vector<std::uint8_t>>& bytes);

using Point = std::array<double, 3>;
/// One triangle with its material (-1 the default), rotated so that the smallest corner is first.
struct PlacedTriangle {
  int material;
  std::array<Point, 3> corners;
  auto operator<=>(const PlacedTriangle&) const = default;
};
/// Triangles of one mesh, ascending; with a node's own translation added.
[[nodiscard]] std::vector<PlacedTriangle> triangles_of(const Glb& glb, std::size_t mesh, Point translation = {});

}  // namespace meshlode::test
