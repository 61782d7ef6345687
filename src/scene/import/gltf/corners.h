// SPDX-License-Identifier: GPL-3.0-or-later
// Lists, strips and fans become three corners a triangle.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/result.h>

#include "scene/import/gltf/accessor.h"

namespace meshlode::scene {

struct CornerSource {
  const AccessorReader* indices = nullptr;  ///< nullptr: the vertices in their order
  int mode = TINYGLTF_MODE_TRIANGLES;       ///< of the three that make triangles
  std::uint64_t vertex_count = 0;
  bool may_restart = false;  ///< an extension lets strips and fans have restart values
  bool repair = false;       ///< broken triangles are dropped, and strips and fans split at restart values all the same

  [[nodiscard]] std::uint64_t count() const { return indices != nullptr ? indices->count() : vertex_count; }
  /// At most; fewer where a strip or fan is split.
  [[nodiscard]] std::uint64_t triangle_count() const;
};

struct TriangleCorners {
  std::vector<std::uint32_t> vertices;  ///< three each triangle, each below vertex_count
  std::uint64_t broken = 0;             ///< triangles that were dropped
  std::uint64_t restarts = 0;           ///< at which a strip or fan was split
};

/// Errors: kInvalid, without a place.
[[nodiscard]] Result<TriangleCorners> read_corners(const CornerSource& source);

}  // namespace meshlode::scene
