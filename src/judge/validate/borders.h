// SPDX-License-Identifier: GPL-3.0-or-later
// The border proof (I6): for every group the border of its coarser set is that of its finer set, except where the
// source itself is open. Then every cut of a closed source is closed: the chain of a cut is the chain of level 0 plus
// what each replaced group adds, which is zero.
//
// Where the source is open, its border may be simplified. B starts as the chain of all level-0 clusters. Going from
// fine to coarse, a group may exchange border edges that are in B for others, which then belong to B too. What comes
// must hang together with what goes and have no more edges, or be a loop that moved as a whole; and the coarser set may
// have no more holes than the finer one, so that none can open inside.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "judge/validate/surface.h"

namespace meshlode::judge {

/// Signed multiplicities of the source's border and of what replaced it, per edge of the surface.
struct BorderSet {
  std::vector<std::int32_t> plus;   ///< >= 0: uses from the lower to the higher position
  std::vector<std::int32_t> minus;  ///< >= 0: uses the other way
  bool is_closed = true;            ///< level 0 has no border

  [[nodiscard]] bool allows(std::uint32_t edge, std::int32_t net) const {
    return net <= plus[edge] && -net <= minus[edge];
  }
};

struct BorderViolation {
  std::uint32_t group = 0;  ///< of the asset
  std::string detail;
};

struct BorderProof {
  BorderSet border;
  std::vector<BorderViolation> violations;  ///< at most one per group, ascending
  std::uint64_t groups = 0;                 ///< checked
};

[[nodiscard]] BorderProof prove_borders(const run::Asset& asset, const MeshSurface& surface);

/// Attributes on shared borders (I3, L506). A border edge that a group shares is drawn by its neighbours too, so what
/// the coarser set has at its ends must be what the finer set has there. At a seam a position has several wedges, and
/// the edge may come to use another of them. At most one violation per group, ascending.
[[nodiscard]] std::vector<BorderViolation> check_shared_attributes(const run::Asset& asset, const MeshSurface& surface,
                                                                   const BorderSet& border);

}  // namespace meshlode::judge
