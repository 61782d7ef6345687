// SPDX-License-Identifier: GPL-3.0-or-later
// Two DAGs as one of one mesh.
#pragma once

#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Of parts of a mesh that share no position: the groups of both from coarse to fine, those of the first before those
/// of the second within a level. Neither top is the whole's, so that both are stuck: what is left are loose components.
/// An aggregate has no deviations of normals and UVs, and the format has them of all groups of a mesh or of none.
[[nodiscard]] LodDag join_dags(const LodDag& first, const LodDag& second, const AttributeLayout& layout);

}  // namespace meshlode::builder
