// SPDX-License-Identifier: GPL-3.0-or-later
// How far what a collapse makes is from what it replaces: the other direction of left_behind.h.
#pragma once

#include <vector>

#include "base/vec.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/star_facets.h"

namespace meshlode::builder {

class NewSurface {
 public:
  /// How far the new star is from the triangles that it replaces, squared, where that exceeds `least`; else `least`. By
  /// the middles of its triangles and of their edges at the target. \pre star.outer is gathered
  [[nodiscard]] double distance2(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                 double least);

 private:
  void gather_replaced(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star);

  // Of the collapse asked about last.
  StarFacets replaced_;  ///< those behind the outer edges first, in their order
  std::vector<Vec3d> middles_, spokes_;
  std::vector<float> by_triangle_;
};

}  // namespace meshlode::builder
