// SPDX-License-Identifier: GPL-3.0-or-later
// What SourceTree hides: its own copy of the source, and the tree over it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "deviation/deviation.h"
#include "deviation/surface_tree.h"

namespace meshlode {

struct SourceTree::Impl {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  SurfaceTree tree;  ///< over the two above
};

}  // namespace meshlode
