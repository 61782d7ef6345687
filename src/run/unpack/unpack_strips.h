// SPDX-License-Identifier: MIT
// The inverse of the strip model: numbers become the clusters' bit streams again (docs/reference/codecs.md, Strips).
#pragma once

#include <span>

#include <meshlode/format.h>

#include "run/unpack/page_plan.h"
#include "run/unpack/strip_values.h"

namespace meshlode::run {

/// Fills the rest of `page`, which is zero but for the heads and ranges that `plan` tells of. `values` are as many as
/// those heads call for. False where they are not those of a page of this size; whether it is the right page is for the
/// checksum to say. Never reads or writes outside the spans. \pre narrow: the plan's bits are those of NarrowLanes
[[nodiscard]] bool unpack_strips(const format::MeshRecord& mesh, const PagePlan& plan,
                                 const StripValues<WideLanes>& values, std::span<std::uint32_t> page);
[[nodiscard]] bool unpack_strips(const format::MeshRecord& mesh, const PagePlan& plan,
                                 const StripValues<NarrowLanes>& values, std::span<std::uint32_t> page);

}  // namespace meshlode::run
