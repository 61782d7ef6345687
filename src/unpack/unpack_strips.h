// SPDX-License-Identifier: MIT
// The inverse of the strip model: numbers become the clusters' bit streams again (docs/format.md, Stored pages).
#pragma once

#include <cstdint>
#include <span>

#include <meshlode/format.h>

#include "unpack/page_columns.h"
#include "unpack/strip_values.h"

namespace meshlode {

/// Fills the rest of `page`, which is zero but for the heads that `columns` has placed. `values` are as many as those heads
/// call for. False where they are not those of a page of this size; whether it is the right page is for the checksum to
/// say. Never reads or writes outside the spans.
[[nodiscard]] bool unpack_strips(const format::MeshRecord& mesh, std::uint32_t cluster_count, PageColumns& columns,
                                 const StripValues& values, std::span<std::uint32_t> page);

}  // namespace meshlode
