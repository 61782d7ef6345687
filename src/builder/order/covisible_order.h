// SPDX-License-Identifier: GPL-3.0-or-later
// The order of groups inside a level decides which of them share a page. A page is loaded whole, so groups that the
// same views need should lie together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"
#include "builder/order/deal_groups.h"

namespace meshlode::builder {

/// What of one mesh the order is found from, as a build and as an asset's tables have it. Groups lie from coarse to
/// fine, and their members one behind the other.
struct OrderedGroups {
  struct Group {
    std::uint32_t first_cluster = 0, cluster_count = 0, level = 0;
    bool is_terminal = false;
    Hierarchy::Sphere sphere{};
    float error = 0.0F;
  };
  struct Cluster {
    Hierarchy::Sphere sphere{};
    std::uint32_t own_group = 0, coarser_group = 0;  ///< kNoId: made from none
  };
  std::vector<Group> groups;
  std::vector<Cluster> clusters;
};

struct CovisibleOrder {
  std::vector<std::uint32_t> groups;  ///< in their new order
  std::vector<ViewBits> needs;        ///< of each, in that order
};

/// See below.
[[nodiscard]] CovisibleOrder covisible_order(const OrderedGroups& mesh);

/// Orders the groups of each level by which training views need them, found by recursive bisection. Levels never mix
/// and terminal groups stay first in theirs, so that a group still comes after everything made from it. Both arguments
/// name groups and clusters by their new ids afterwards. The same order for any thread count.
/// \return of each group, in the new order
[[nodiscard]] std::vector<ViewBits> order_by_covisibility(LodDag& dag, Hierarchy& hierarchy);

}  // namespace meshlode::builder
