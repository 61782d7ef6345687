// SPDX-License-Identifier: GPL-3.0-or-later
// What keeps layers in order: of two surfaces with a gap between them each may move towards the other by half of the
// gap, and away from it as far as errors allow. So the lower one is simplified from below and the upper one from above,
// as a progressive hull is (Sander, Gu, Gortler, Hoppe and Snyder 2000). A narrow gap needs no more triangles than a
// wide one: an error may be many times the gap.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "builder/gap_label.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

class GapGuard {
 public:
  /// The input must outlive this.
  GapGuard(const SimplifyInput& input, const GroupPlaces& places);

  /// Whether a triangle of the group has a gap.
  [[nodiscard]] bool is_on() const { return is_on_; }
  /// How much farther into a gap than it may go the surface around the star comes with its vertex at `place`; 0 where
  /// it does not. In the frame. The new surface and the old one enclose tetrahedra between `place` and the triangles
  /// that were there, so that heights above these triangles' planes decide.
  [[nodiscard]] double excess(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                              const Vec3d& place) const {
    return find_worst(mesh, places, star, place).excess;
  }
  /// A place near the star's target with less of it, mostly none; the target where there is none near the edge.
  [[nodiscard]] Vec3d move_out(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star) const;

 private:
  struct Worst {
    double excess = 0.0;
    Vec3d out{0.0};  ///< out of the gap, of unit length
  };
  [[nodiscard]] Worst find_worst(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                 const Vec3d& place) const;

  const std::vector<std::uint32_t>& labels_;         ///< per triangle
  std::array<double, kNarrowestGap + 1> allowed_{};  ///< by code, in the frame
  bool is_on_ = false;
};

}  // namespace meshlode::builder
