// SPDX-License-Identifier: GPL-3.0-or-later
// A cut's clusters become indexed triangle lists, one per material. Vertices of different clusters are one vertex again
// where all their integers agree: clusters repeat the vertices on their common border, a glTF mesh need not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "base/ids.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// The triangles of one material. `vertices` is shaped like one large cluster, so that decode's own float conversion
/// serves here too; its triangle arrays are empty.
struct CutPrimitive {
  MaterialId material;                 ///< into Asset::materials()
  run::DecodedCluster vertices;        ///< merged, in order of first use
  std::vector<std::uint32_t> indices;  ///< 3 per triangle, into vertices
};

/// Primitives in ascending material order; triangles in ascending cluster order, each cluster's in its stored order.
/// Errors: kUsage a cluster that is not of this mesh or named twice; what load_page reports.
[[nodiscard]] Result<std::vector<CutPrimitive>> gather_cut(const run::Asset& asset, MeshId mesh,
                                                           std::span<const ClusterId> cut);

}  // namespace meshlode::app
