// SPDX-License-Identifier: GPL-3.0-or-later
// Satellites: triangles that must be where another one is. What the grid has flattened to a point or a segment covers
// nothing by itself, and a few triangles of debris beside a surface cover little; in a group without that surface
// nothing would be left near them once they are simplified away, and what they deviate by then is every coarser level's
// error. To a partitioner they are leaves, the cheapest things to move, so they are taken out of its hands.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/ids.h"
#include "builder/cluster/adjacency.h"
#include "builder/cluster/cluster.h"

namespace meshlode::builder {

/// Per triangle the triangle whose cluster it joins, or kNoId. Hosts have no hosts themselves.
using Hosts = std::vector<std::uint32_t>;

/// Triangles with fewer than three positions, each with the first triangle that has all of them and covers an area, or
/// else one that has some. Empty where there is no triangle of the kind.
[[nodiscard]] Hosts host_collapsed(std::span<const WedgeTriangle> triangles,
                                   std::span<const std::uint32_t> wedge_position, std::size_t position_count);

/// Pieces of at most a few triangles, each with the triangle of a larger piece that `links` lead to. Empty where there
/// is none. `links` is one per piece but the largest, from the piece.
[[nodiscard]] Hosts host_debris(const std::vector<std::uint32_t>& piece, std::uint32_t piece_count,
                                std::span<const TriangleLink> links);

/// Clusters triangles of which each counts as its weight: itself and its satellites.
using ClusterWeighted =
    std::function<Clustering(std::span<const WedgeTriangle>, std::span<const std::int32_t> weights)>;

/// Clusters of the triangles that have no host, by `cluster`; the others follow their hosts. Clusters that are too
/// large nevertheless are divided. No host at all: `hosts` is empty or all kNoId.
[[nodiscard]] Clustering cluster_with_satellites(std::span<const WedgeTriangle> triangles,
                                                 std::span<const std::uint32_t> wedge_position,
                                                 std::span<const Vec3i> positions, const Hosts& hosts,
                                                 const ClusterCaps& caps, const ClusterWeighted& cluster);

}  // namespace meshlode::builder
