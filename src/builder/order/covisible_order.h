// SPDX-License-Identifier: GPL-3.0-or-later
// The order of groups inside a level decides which of them share a page. A page is loaded whole, so groups that the
// same views need should lie together.
#pragma once

#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"

namespace meshlode::builder {

/// Orders the groups of each level by which training views need them, found by recursive bisection. Levels never mix
/// and terminal groups stay first in theirs, so that a group still comes after everything made from it. Both arguments
/// name groups and clusters by their new ids afterwards. The same order for any thread count.
void order_by_covisibility(LodDag& dag, Hierarchy& hierarchy);

}  // namespace meshlode::builder
