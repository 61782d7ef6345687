// SPDX-License-Identifier: MIT
// The far instance: where one bound around a whole mesh passes, every group of the mesh but its terminal one passes
// too, so that one alone is open and nobody has to look at the hierarchy.
#pragma once

#include <cstdint>
#include <span>

#include <meshlode/format.h>

#include "run/read/nesting.h"
#include "run/select/select.h"

namespace meshlode::run {

struct FarBound {
  /// The BVH root's sphere, and the largest finite error of a group grown as an inner node's is: nested (nesting.h)
  /// over every group but `only_root`. What docs/reference/selection.md proves of the BVH's inner nodes holds for it.
  StoredBound bound{{0.0F, 0.0F, 0.0F}, 0.0F, 0.0F};
  /// The mesh's one group that never passes, of all groups of the asset; kNone where there is none or more than one,
  /// and then the bound says nothing.
  std::uint32_t only_root = format::kNone;
};

/// `errors`: of every group of the asset as the rule sees them, infinite where attribute bounds forbid a group.
/// \pre the mesh's BVH nests, as validate checks
[[nodiscard]] FarBound find_far_bound(const SelectTables& tables, const format::MeshRecord& mesh,
                                      std::span<const float> errors);

}  // namespace meshlode::run
