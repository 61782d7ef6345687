// SPDX-License-Identifier: GPL-3.0-or-later
// One cluster as the bytes that stand in a page: header, channels, material ranges, vertex bits, triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "encode/encode.h"
#include "mesh/dag.h"
#include "mesh/prepared.h"

namespace meshlode {

/// What every cluster of a mesh is encoded with.
struct ChannelPlan {
  AttributeLayout layout;
  std::uint32_t normal_bits = 0;
  std::array<std::int32_t, kMaxUvSets> uv_log2{};
  std::uint32_t channel_count = 3;
};

[[nodiscard]] constexpr std::uint32_t align4(std::uint32_t bytes) { return (bytes + 3U) & ~3U; }

/// Appends the cluster; PageCluster::vertex_offset and triangle_offset count from the cluster's own start until the
/// page is put together. Errors: kBuildFailed where the cluster breaks a limit of the format; `where` is left to the caller.
[[nodiscard]] Status append_cluster(const LodDag& dag, const DagCluster& cluster, const ChannelPlan& plan,
                                    std::vector<std::uint8_t>& out);

}  // namespace meshlode
