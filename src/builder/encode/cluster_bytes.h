// SPDX-License-Identifier: GPL-3.0-or-later
// One cluster as the words that stand in a page: its head and its data.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/encode/encode.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// What every cluster of a mesh is encoded with.
struct ChannelPlan {
  AttributeLayout layout;
  std::int32_t normal_scale = 0;
  std::array<std::int32_t, scene::kMaxUvSets> uv_log2{};
  std::uint32_t material = format::kNone;  ///< of every triangle of the mesh, or kNone
  std::uint32_t strip_trials = 1;
  std::uint32_t mixed_strip_trials = 1;  ///< of a cluster of several materials

  [[nodiscard]] std::uint32_t head_words() const {
    return format::kHeadWords + (layout.has_normal ? format::kNormalHeadWords : 0U);
  }
};

struct ClusterWords {
  std::array<std::uint32_t, format::kHeadWords + format::kNormalHeadWords> head{};  ///< kDataWord is left zero
  std::vector<std::uint32_t> data;
};

/// Errors: kBuildFailed where the cluster breaks a limit of the format; `where` is left to the caller.
[[nodiscard]] Result<ClusterWords> encode_cluster(const LodDag& dag, const DagCluster& cluster,
                                                  const ChannelPlan& plan);

}  // namespace meshlode::builder
