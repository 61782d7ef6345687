// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>
#include <numeric>
#include <span>

#include "builder/cluster/halving.h"
#include "builder/cluster/merged_partition.h"

namespace meshlode::builder {

namespace {

/// One node's edges, summed by the part that they lead to.
class EdgesByPart {
 public:
  explicit EdgesByPart(std::uint32_t parts) : weight_(parts, 0) {}

  void gather(const Graph& graph, const std::vector<std::uint32_t>& labels, std::uint32_t node) {
    for (const std::uint32_t part : parts_) weight_[part] = 0;
    parts_.clear();
    for (auto i = static_cast<std::size_t>(graph.row_start[node]);
         i < static_cast<std::size_t>(graph.row_start[node + 1]); ++i) {
      const std::uint32_t part = labels[static_cast<std::size_t>(graph.neighbor[i])];
      if (weight_[part] == 0) parts_.push_back(part);
      weight_[part] += graph.edge_weight[i];
    }
  }
  [[nodiscard]] const std::vector<std::uint32_t>& parts() const { return parts_; }  ///< in the order of edges
  [[nodiscard]] std::int64_t to(std::uint32_t part) const { return weight_[part]; }

 private:
  std::vector<std::int64_t> weight_;
  std::vector<std::uint32_t> parts_;
};

bool is_on_border(const Graph& graph, const std::vector<std::uint32_t>& labels, std::uint32_t node) {
  for (auto i = static_cast<std::size_t>(graph.row_start[node]);
       i < static_cast<std::size_t>(graph.row_start[node + 1]); ++i) {
    if (labels[static_cast<std::size_t>(graph.neighbor[i])] != labels[node]) return true;
  }
  return false;
}

/// How many parts those become that recursive bisection comes down to: a few each.
void share_out(std::uint32_t parts, std::vector<std::uint32_t>& shares) {
  constexpr std::uint32_t kFew = 4;
  if (parts <= kFew) {
    shares.push_back(parts);
    return;
  }
  share_out(parts / 2, shares);
  share_out(parts - parts / 2, shares);
}

/// METIS down to a few parts, and halves of those.
std::vector<std::uint32_t> partition_quads(Graph& graph, std::span<const Vec3f> centers, std::uint32_t parts,
                                           std::uint32_t seed) {
  std::vector<std::uint32_t> shares;
  share_out(parts, shares);
  const std::vector<std::uint32_t> few = partition_graph(graph, shares, seed);
  std::vector<std::uint32_t> first(shares.size() + 1, 0);
  for (const std::uint32_t label : few) ++first[label + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> nodes(few.size()), cursor(first.begin(), first.end() - 1);
  for (std::uint32_t node = 0; node < few.size(); ++node) nodes[cursor[few[node]]++] = node;
  std::vector<std::uint32_t> labels(few.size());
  Halving halving(graph, centers);
  std::uint32_t first_label = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    halving.cut(std::span(nodes).subspan(first[i], first[i + 1] - first[i]), shares[i], first_label, labels);
    first_label += shares[i];
  }
  fill_empty_parts(labels, parts);
  return labels;
}

/// Merged nodes lie at the mean of what they are made of.
std::vector<Vec3f> merge_centers(const MergedGraph& merged, std::span<const Vec3f> centers) {
  std::vector<Vec3f> sum(merged.graph.node_count(), Vec3f(0.0F));
  std::vector<float> count(sum.size(), 0.0F);
  for (std::size_t n = 0; n < centers.size(); ++n) {
    sum[merged.node[n]] += centers[n];
    count[merged.node[n]] += 1.0F;
  }
  for (std::size_t m = 0; m < sum.size(); ++m) sum[m] /= count[m];
  return sum;
}

}  // namespace

void refine_parts(const Graph& graph, const PartWeights& weights, int passes, std::vector<std::uint32_t>& labels,
                  std::uint32_t parts) {
  const auto count = static_cast<std::uint32_t>(graph.node_count());
  const auto weight_of = [&](std::uint32_t node) -> std::int64_t {
    return graph.node_weight.empty() ? 1 : graph.node_weight[node];
  };
  std::vector<std::int64_t> size(parts, 0);
  for (std::uint32_t n = 0; n < count; ++n) size[labels[n]] += weight_of(n);
  EdgesByPart edges(parts);
  std::vector<std::uint8_t> may_be_on_border(count, 1);  // most nodes are looked at once, inside a part
  for (int pass = 0; pass < passes; ++pass) {
    bool any_moved = false;
    for (std::uint32_t n = 0; n < count; ++n) {
      if (may_be_on_border[n] == 0) continue;
      if (!is_on_border(graph, labels, n)) {
        may_be_on_border[n] = 0;
        continue;
      }
      const std::uint32_t own = labels[n];
      const std::int64_t weight = weight_of(n);
      if (size[own] - weight < weights.least) continue;
      edges.gather(graph, labels, n);
      std::uint32_t best = own;
      for (const std::uint32_t part : edges.parts()) {
        if (part == own || size[part] + weight > weights.most) continue;
        const std::int64_t gain = edges.to(part) - (best == own ? 0 : edges.to(best));
        const bool is_lighter = size[part] < size[best] || (size[part] == size[best] && part < best);
        if (best == own || gain > 0 || (gain == 0 && is_lighter)) best = part;
      }
      if (best == own) continue;
      const std::int64_t gain = edges.to(best) - edges.to(own);
      if (gain < 0 && size[own] <= weights.most) continue;
      if (gain == 0 && size[own] <= size[best] + weight) continue;
      size[own] -= weight;
      size[best] += weight;
      labels[n] = best;
      any_moved = true;
      for (auto i = static_cast<std::size_t>(graph.row_start[n]); i < static_cast<std::size_t>(graph.row_start[n + 1]);
           ++i) {
        may_be_on_border[static_cast<std::size_t>(graph.neighbor[i])] = 1;
      }
    }
    if (!any_moved) return;
  }
}

std::vector<std::uint32_t> partition_merged(Graph& graph, std::span<const Vec3f> centers, std::uint32_t parts,
                                            std::uint32_t seed) {
  constexpr std::size_t kFewestNodes = 32;  // a part: eight quads
  constexpr int kPassesOfPairs = 2, kPassesOfTriangles = 4;
  constexpr std::int64_t kOver = 1, kUnder = 6;  // triangles, than the mean
  if (parts <= 1 || graph.node_count() < kFewestNodes * parts) return partition_graph(graph, parts, seed);
  MergedGraph pairs = merge_pairs(graph);
  MergedGraph quads = merge_pairs(pairs.graph);
  if (quads.graph.node_count() < parts) return partition_graph(graph, parts, seed);
  const std::int64_t total =
      std::accumulate(pairs.graph.node_weight.begin(), pairs.graph.node_weight.end(), std::int64_t{0});
  const std::int64_t mean = total / parts;
  const PartWeights weights{mean > kUnder ? mean - kUnder : 1, (total + parts - 1) / parts + kOver};
  const auto expand = [](const std::vector<std::uint32_t>& node, const std::vector<std::uint32_t>& coarse) {
    std::vector<std::uint32_t> labels(node.size());
    for (std::size_t n = 0; n < node.size(); ++n) labels[n] = coarse[node[n]];
    return labels;
  };
  std::vector<std::uint32_t> labels = expand(
      quads.node, partition_quads(quads.graph, merge_centers(quads, merge_centers(pairs, centers)), parts, seed));
  refine_parts(pairs.graph, weights, kPassesOfPairs, labels, parts);
  labels = expand(pairs.node, labels);
  refine_parts(graph, weights, kPassesOfTriangles, labels, parts);
  return labels;
}

}  // namespace meshlode::builder
