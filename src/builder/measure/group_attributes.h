// SPDX-License-Identifier: GPL-3.0-or-later
// How far shading normals and texture coordinates of a group are from the source's, in any tier that measures.
#pragma once

#include <cstdint>
#include <span>

#include "builder/deviation/deviation.h"
#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Sets normal_deviation and uv_deviation of `group` of the DAG, not below those of what it replaces (whose groups are
/// done). `made`: the clusters made from it. `near`: by their triangles, where the source is near; or nothing.
void measure_group_attributes(const SourceTree& source, const PreparedMesh& mesh, const CanonicalForm& form,
                              std::span<const std::uint32_t> made, std::span<const TreeSlot> near, const LodDag& dag,
                              DagGroup& group);

}  // namespace meshlode::builder
