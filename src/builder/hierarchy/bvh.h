// SPDX-License-Identifier: GPL-3.0-or-later
// A wide BVH over a mesh's groups, so that selection need not look at groups that pass (I8).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "builder/hierarchy/hierarchy.h"

namespace meshlode::builder {

/// One leaf per group, with the group's own sphere and error; an inner node's bound nests its children's with the
/// margins of margins.h. Breadth first: the root is node 0, the children of a node are contiguous and behind it.
/// `levels` has one number per group. Empty where there are no groups.
[[nodiscard]] std::vector<format::NodeRecord> build_bvh(std::span<const Hierarchy::Sphere> spheres,
                                                        std::span<const float> errors,
                                                        std::span<const std::uint32_t> levels);

/// Other errors in a tree whose ids are as build_bvh() has them: children behind their parents.
void set_node_errors(std::span<const float> errors, std::span<format::NodeRecord> nodes);

}  // namespace meshlode::builder
