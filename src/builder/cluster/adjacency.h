// SPDX-License-Identifier: GPL-3.0-or-later
// Which triangles share an edge, as a weighted graph for the partitioner.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "builder/cluster/partition.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Weight of a shared edge, and of a link that only keeps near pieces together.
constexpr std::int32_t kSharedEdgeWeight = 8;
constexpr std::int32_t kNearbyWeight = 1;

using TriangleLink = std::pair<std::uint32_t, std::uint32_t>;

/// Triangles as nodes, in the order given; position ids are compacted inside. An edge with more than two triangles
/// links them in a chain, so that a fan of thousands stays linear. Triangles that follow each other but belong to
/// different pieces are linked weakly: the caller's order is taken as spatial, and loose pieces near each other stay
/// together. `links` are pairs of triangles to be joined as by a shared edge.
[[nodiscard]] Graph triangle_graph(std::span<const std::array<std::uint32_t, 3>> corner_positions,
                                   std::span<const TriangleLink> links = {});

}  // namespace meshlode::builder
