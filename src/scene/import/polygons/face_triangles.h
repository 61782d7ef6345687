// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon of three dimensions becomes triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"

namespace meshlode::scene {

struct PolygonTriangles;

class FaceTriangles {
 public:
  /// Of all triangles that one corner has with the sides.
  struct Fan {
    std::size_t start = 0;
    bool is_good = false;    ///< every triangle faces the way the polygon does
    bool is_folded = false;  ///< some face the other way
  };
  explicit FaceTriangles(const std::vector<Vec3d>& positions) : positions_(positions) {}
  /// Appends triangles to `indices`: polygon.size() - 2 where, seen from its front, no corner lies on another or on a
  /// side.
  /// \pre three corners or more, whose positions are finite
  void append(std::span<const std::uint32_t> polygon, std::vector<std::uint32_t>& indices);
  /// Says what could not be done as it should.
  void report(std::vector<LeftOut>& left_out) const;

 private:
  bool append_triangulated(std::span<const std::uint32_t> polygon, const Vec3d& area,
                           std::vector<std::uint32_t>& indices);
  /// Triangles are made as seen from the front of a face. Of a bent face sides that lie on one another there can be
  /// apart: adds the triangles of corners that have none. False where some of the border is missing even so; not asked
  /// of what passes a place twice. \param area twice the polygon's area vector
  [[nodiscard]] bool add_spikes(std::span<const std::uint32_t> polygon, const Vec3d& area,
                                PolygonTriangles& made) const;
  /// Where sides cross: without the corners at places where it was before, as of a face that goes round twice.
  bool append_first_visits(std::span<const std::uint32_t> polygon, std::vector<std::uint32_t>& indices);
  static void append_fan(std::span<const std::uint32_t> polygon, const Fan& fan, std::vector<std::uint32_t>& indices);
  const std::vector<Vec3d>& positions_;
  std::uint64_t work_ = 0;  ///< squares of the corners of large polygons so far
  std::uint64_t crossing_ = 0, bent_ = 0, too_large_ = 0;
};

}  // namespace meshlode::scene
