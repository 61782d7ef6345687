// SPDX-License-Identifier: GPL-3.0-or-later
// Layers of a shaded surface near a point: the two sides of a thin sheet, the two charts at a seam. Internal to the
// room.
#pragma once

#include <cstdint>
#include <vector>

#include "judge/metrics/shaded_surface.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {

class Layers {
 public:
  /// \pre `s` outlives this
  explicit Layers(const ShadedSurface& s);

  /// Scratch of one thread.
  struct Scratch {
    /// A corner of a triangle, or an edge.
    struct Joint {
      std::uint32_t low, high;  ///< of same_; of a corner both are it
      std::uint32_t place;      ///< of the triangle
    };
    std::vector<Joint> joints;
    std::vector<std::uint32_t> layer_of;
  };
  /// Of the triangles within `reach` of a point, by distance, leaves the first of each layer: triangles are of one
  /// layer that share a vertex or an edge within reach, position, normal and UVs all equal, or are so connected through
  /// others of them. Where they meet farther away does not matter: a sheet may fold, and a seam end.
  void keep_first_of_each(const Vec3d& point, double reach, std::vector<NearestPoint>& found, Scratch& scratch) const;

 private:
  const Surface& surface_;
  std::vector<std::uint32_t> same_;  ///< equal numbers for vertices that are equal in all
};

}  // namespace meshlode::judge
