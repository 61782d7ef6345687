// SPDX-License-Identifier: GPL-3.0-or-later
// How far a group is from the source in what is painted on it: the two-sided distance in the product space of
// positions, texture coordinates and normals (docs/reference/selection.md, "What is promised"), quantization included.
//
// Points of a group are held against all of the source. Points of the source are carried through the finished DAG: each
// lies on a cluster of level 0, and where a group replaces that, on the nearest of the clusters made from it. One
// cluster of each such chain is in any cut, so that what is found for the groups holds for cuts. In the tier certified
// nothing is sampled: promise_certifier.h.
#pragma once

#include <span>
#include <vector>

#include <meshlode/format.h>

#include "builder/lod_dag.h"
#include "builder/promise/painted_source.h"

namespace meshlode::builder {

struct PromiseErrors {
  format::PromiseMeshRecord mesh{};
  std::vector<format::PromiseGroupRecord> groups;
};

/// `record` and `groups` are what encoding the DAG came to: the steps that attributes are stored with, and the groups'
/// errors for positions. `margin`: on what samples found; 1 in the tier certified. `promises`: format::kPromises…. The
/// same for any thread count (I10).
[[nodiscard]] PromiseErrors measure_promises(const PaintedSource& source, const LodDag& dag,
                                             const format::MeshRecord& record,
                                             std::span<const format::GroupRecord> groups, double margin,
                                             std::uint32_t promises);

/// Of a mesh whose groups' errors are no distances (aggregates): they stand for themselves.
[[nodiscard]] PromiseErrors promises_of_positions(const format::MeshRecord& record,
                                                  std::span<const format::GroupRecord> groups, std::uint32_t promises);

}  // namespace meshlode::builder
