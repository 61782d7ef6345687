// SPDX-License-Identifier: MIT
// Where everything of a page lies, before its streams are there: heads and ranges alone say it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "format/vertex_fields.h"
#include "run/unpack/page_columns.h"

namespace meshlode::run {

struct PagePlan {
  std::vector<format::ClusterFields> clusters;
  std::vector<format::UvRangeFields> ranges;
  std::vector<std::uint32_t> first_vertex;  ///< in the page, of each cluster; one more for the end
  std::uint32_t max_bits = 0;               ///< of any field
  std::uint32_t max_normal_bits = 0;
};

/// Places heads and ranges of all clusters in `page`, which is zero. False where they are not those of a page that is
/// filled exactly.
[[nodiscard]] bool plan_page(const format::MeshRecord& mesh, std::uint32_t cluster_count, PageColumns& columns,
                             std::span<std::uint32_t> page, PagePlan& out);

}  // namespace meshlode::run
