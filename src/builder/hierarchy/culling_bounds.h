// SPDX-License-Identifier: GPL-3.0-or-later
// Tight bounds of one cluster's own geometry, for culling: they decide nothing about the cut.
#pragma once

#include <cstdint>
#include <span>

#include "builder/hierarchy/enclosing_ball.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"
#include "format/grid.h"

namespace meshlode::builder {

/// Contains every vertex of the cluster as decoded, in doubles and in floats. Near-smallest.
[[nodiscard]] Hierarchy::Sphere culling_sphere(const LodDag& dag, const DagCluster& cluster,
                                               const format::PositionGrid& grid,
                                               EnclosingBall enclose = enclosing_ball);

/// The unit 2^log2 in which spheres are stored: the smallest in which every centre fits 16 bits, and every radius.
[[nodiscard]] std::int32_t choose_sphere_log2(std::span<const Hierarchy::Sphere> spheres);

/// The sphere in whole units: its centre rounded, its radius grown by what that moved and rounded up.
[[nodiscard]] Hierarchy::Sphere snap_sphere(const Hierarchy::Sphere& sphere, std::int32_t log2);

/// dot(view, axis / 127) >= cutoff / 127, view a unit vector from the eye, implies that every triangle of the cluster
/// is back-facing or has no area. cutoff 127: there is no such view.
[[nodiscard]] Hierarchy::Cone normal_cone(const LodDag& dag, const DagCluster& cluster);

}  // namespace meshlode::builder
