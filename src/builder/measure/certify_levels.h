// SPDX-License-Identifier: GPL-3.0-or-later
// The tier `certified`: what is proven of the triangles of a level is handed on to the triangles that replace them.
#pragma once

#include <span>

#include "builder/deviation/deviation.h"
#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// As measure_levels(), but that errors are upper bounds and need no margin.
void certify_levels(const PreparedMesh& mesh, SourceTree source, const CanonicalForm& form,
                    std::span<const double> least, LodDag& dag);

}  // namespace meshlode::builder
