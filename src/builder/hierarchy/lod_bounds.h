// SPDX-License-Identifier: GPL-3.0-or-later
// The spheres and errors by which groups are selected, made to nest along the DAG (I4).
#pragma once

#include <span>
#include <vector>

#include "builder/hierarchy/enclosing_ball.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"

namespace meshlode::builder {

struct LodBounds {
  std::vector<Hierarchy::Sphere> spheres;  ///< per group
  std::vector<float> errors;               ///< per group; kInfiniteError where terminal
};

/// A group's sphere holds, with the margins of margins.h: the spheres of the groups that its members were made from,
/// the culling spheres of members of level 0, and the culling spheres of the clusters made from it (optimal placement
/// may leave the finer ones' bounds). `culling` has one sphere per cluster of the DAG.
[[nodiscard]] LodBounds nest_lod_bounds(const LodDag& dag, std::span<const Hierarchy::Sphere> culling,
                                        EnclosingBall enclose = enclosing_ball);

/// The float sphere that `inner` nest in, near-smallest.
[[nodiscard]] Hierarchy::Sphere enclose_spheres(std::span<const Hierarchy::Sphere> inner,
                                                EnclosingBall enclose = enclosing_ball);

/// LodBounds::errors alone: spheres do not depend on errors.
[[nodiscard]] std::vector<float> nest_errors(const LodDag& dag);

/// The error of something coarser than `finer`: at least `error`, and grown where `finer` is not 0.
[[nodiscard]] float grow_error(double error, float finer);

}  // namespace meshlode::builder
