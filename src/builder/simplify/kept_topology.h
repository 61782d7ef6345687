// SPDX-License-Identifier: GPL-3.0-or-later
// What keeps every cut of a manifold a manifold of the same topology (--keep-topology), beyond the link condition of
// guards.h, which sees one group alone.
//
// A cut is level 0 with some groups replaced, in the order of rounds, by what they became. Let M be a manifold that
// such replacements led to, G the group that is replaced next, R the rest of M. A vertex that G does not share with
// another group of its round has its whole fan in G, in every cut. So what a collapse in G can meet in R lies at locked
// vertices, and it meets nothing there if
//   - no edge appears between two locked vertices: R, or another group of the round, may have that edge too. (Edges
//     between two vertices that stay locked never go: finer cuts have no edge there that the round has not.)
//   - a vertex goes to a place where no other vertex of any cut is: cuts are put together by places.
// Then the link condition holds in M where it holds in G, and M stays what it was (Dey et al. 1999).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_set>
#include <vector>

#include "base/vec.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_locks.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// Whether the collapse makes no edge between two shared vertices, no triangle of three, and does not take the last
/// triangle of a piece. As in guards.h a is the locked end, if one is. \pre keeps_topology() holds
[[nodiscard]] bool keeps_to_itself(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star);

struct HashOfPlace {
  std::size_t operator()(const Vec3i& place) const;
};
using PlaceSet = std::unordered_set<Vec3i, HashOfPlace>;

/// Who is where on the grid, so that no two vertices come to lie on each other.
class OwnPlaces {
 public:
  /// `input` must outlive this.
  explicit OwnPlaces(const SimplifyInput& input);

  /// The free place that is nearest to `wanted` and at most a step off along each axis, once the vertices at `a` and
  /// `b` have left theirs; false where there is none.
  [[nodiscard]] bool find_free(const Vec3i& a, const Vec3i& b, Vec3i& wanted) const;
  /// The vertices at `a` and `b` are one now, at `to`.
  void join(const Vec3i& a, const Vec3i& b, const Vec3i& to);

 private:
  [[nodiscard]] bool is_free(const Vec3i& place, const Vec3i& a, const Vec3i& b) const;

  const SimplifyInput& input_;
  PlaceSet given_;  ///< where vertices were that no other group has
  PlaceSet now_;    ///< where vertices are
};

/// Where the result has vertices that the input had none at, in the result's order.
[[nodiscard]] std::vector<Vec3i> new_places(const SimplifyInput& input, const SimplifyResult& result);

}  // namespace meshlode::builder
