// SPDX-License-Identifier: GPL-3.0-or-later
// Caps: a partition's parts are brought under their caps, whatever the partitioner left.
#pragma once

#include <cstdint>
#include <span>

#include "builder/cluster/cluster.h"
#include "builder/cluster/partition.h"

namespace meshlode::builder {

/// Parts with too many triangles first hand border triangles to neighbours that have room, at the least cost in cut
/// edges; what is still over a cap (triangles, or distinct wedges) is bisected until it is under. `graph` is the
/// triangles' own.
void enforce_caps(std::span<const WedgeTriangle> triangles, const Graph& graph, const ClusterCaps& caps,
                  Clustering& clustering);

}  // namespace meshlode::builder
