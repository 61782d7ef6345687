// SPDX-License-Identifier: GPL-3.0-or-later
// Soups: many pieces that share no edge. A graph partitioner sees no distance between them; space has to decide.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/cluster/adjacency.h"
#include "builder/cluster/cluster.h"

namespace meshlode::builder {

/// Pieces of so many triangles are debris where there are larger ones.
constexpr std::uint32_t kDebris = 8;

/// From every piece but the largest to the nearest triangle of another that is no debris: debris beside a surface
/// belongs to the cluster that lies there, or nothing near it would stand for it once it is gone. Where all is debris,
/// to the nearest of any.
[[nodiscard]] std::vector<TriangleLink> link_to_nearest(std::span<const std::array<std::uint32_t, 3>> corner_positions,
                                                        std::span<const Vec3i> positions,
                                                        const std::vector<std::uint32_t>& piece,
                                                        std::uint32_t piece_count);

/// Cuts along medians of the pieces' centres, at multiples of the target, so that parts are compact and full and at
/// most one piece is divided per cut.
[[nodiscard]] Clustering cluster_pieces(std::span<const WedgeTriangle> triangles,
                                        std::span<const std::uint32_t> wedge_position, std::span<const Vec3i> positions,
                                        const std::vector<std::uint32_t>& piece, std::uint32_t piece_count,
                                        std::size_t parts);

}  // namespace meshlode::builder
