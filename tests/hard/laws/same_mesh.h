// SPDX-License-Identifier: GPL-3.0-or-later
// One mesh of an asset against one of another, field by field, up to a change that a law foresees. Ids are compared
// within the mesh, so that it may lie anywhere in its asset; contents are compared as decoded.
#pragma once

#include <cstdint>
#include <string>

#include "base/ids.h"
#include "base/vec.h"
#include "run/read/asset.h"

namespace meshlode::test::hard {

struct Change {
  int log2 = 0;                       ///< lengths of the second are those of the first times 2^log2, exactly
  Vec3d shift{0.0};                   ///< the second's origin is the first's (scaled) plus this, exactly
  std::uint64_t unused_vertices = 0;  ///< the second's source has so many more vertices
  /// 0: lengths are compared bit for bit. Else they are 2^log2 times `factor` as large, to within `tolerance` of it
  /// plus `absolute` (object units of the second); the grid's step is compared as a number.
  double factor = 0.0;
  double tolerance = 0.0, absolute = 0.0;
};

struct Comparison {
  std::string difference;  ///< the first, in words; empty: there is none
  double share = 0.0;      ///< of the tolerance that was used at most
};

/// Errors in `difference` too: a page that does not decode.
[[nodiscard]] Comparison compare_meshes(const run::Asset& a, MeshId mesh_a, const run::Asset& b, MeshId mesh_b,
                                        const Change& change = {});

}  // namespace meshlode::test::hard
