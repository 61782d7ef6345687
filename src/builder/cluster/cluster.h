// SPDX-License-Identifier: GPL-3.0-or-later
// Cluster: triangles are cut into meshlets under hard caps (I2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/prepared.h"

namespace meshlode::builder {

struct ClusterCaps {
  std::uint32_t max_triangles = 128;
  std::uint32_t max_vertices = 256;
  /// What the partitioner aims at: two below the cap, so that its small imbalance stays inside.
  std::uint32_t target_triangles = 126;
  /// METIS cuts quads of triangles instead of triangles (merged_partition.h): in half the time, and with borders of
  /// clusters that are a little longer. builder/preset.h and builder/stage_options.cpp say where.
  bool merge_triangles = true;
  std::uint32_t seed = 1;  ///< of the partitioner
};

/// One part per triangle; parts are 0 … count-1 and none is empty.
struct Clustering {
  std::vector<std::uint32_t> label;
  std::uint32_t count = 0;
};

/// Cuts a surface into clusters. `wedge_position` maps the triangles' wedges to positions; `positions` are the points.
/// Large inputs are first cut into chunks along medians, which are then partitioned side by side. Triangles should come
/// in a spatially coherent order: it decides where loose pieces go.
[[nodiscard]] Clustering cluster_triangles(std::span<const WedgeTriangle> triangles,
                                           std::span<const std::uint32_t> wedge_position,
                                           std::span<const Vec3i> positions, const ClusterCaps& caps);

}  // namespace meshlode::builder
