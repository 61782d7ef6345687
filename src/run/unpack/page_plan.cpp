// SPDX-License-Identifier: MIT
#include "run/unpack/page_plan.h"

#include <algorithm>

#include <meshlode/page.h>

namespace meshlode::run {

bool plan_page(const format::MeshRecord& mesh, std::uint32_t cluster_count, PageColumns& columns,
               std::span<std::uint32_t> page, PagePlan& out) {
  out.clusters.resize(cluster_count);
  out.ranges.reserve(std::size_t{cluster_count} * mesh.uv_set_count);
  out.first_vertex.resize(cluster_count + std::size_t{1});
  std::uint32_t word = columns.first_data_word();
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    if (!columns.place_cluster(c, word)) return false;
    format::ClusterFields& cluster = out.clusters[c];
    const format::ClusterLayout& layout = cluster.layout;
    if (format::read_cluster_layout(mesh, page, c, cluster.layout) != nullptr || layout.stream_word != word)
      return false;
    format::read_cluster_fields(mesh, page.data(), cluster, out.ranges);
    word = layout.end_word;
    out.first_vertex[c + 1] = out.first_vertex[c] + layout.vertex_count;
    for (const std::uint32_t bits : layout.bits) out.max_bits = std::max(out.max_bits, bits);
    for (const std::uint32_t bits : layout.normal_bits) out.max_normal_bits = std::max(out.max_normal_bits, bits);
  }
  for (const format::UvRangeFields& range : out.ranges) {
    for (const std::uint32_t bits : range.bits) out.max_bits = std::max(out.max_bits, bits);
  }
  return word + 1 == page.size();
}

}  // namespace meshlode::run
