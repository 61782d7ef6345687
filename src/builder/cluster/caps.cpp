// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/caps.h"

#include <algorithm>
#include <utility>

#include "base/local_ids.h"
#include "builder/cluster/dense_limit.h"

namespace meshlode::builder {

namespace {

std::vector<std::vector<std::uint32_t>> members_of(const Clustering& clustering) {
  std::vector<std::uint32_t> size(clustering.count, 0);
  for (const std::uint32_t label : clustering.label) ++size[label];
  std::vector<std::vector<std::uint32_t>> members(clustering.count);
  for (std::uint32_t part = 0; part < clustering.count; ++part) members[part].reserve(size[part]);
  for (std::uint32_t t = 0; t < clustering.label.size(); ++t) members[clustering.label[t]].push_back(t);
  return members;
}

/// Moves the triangle of `part` that costs the fewest cut edges to a neighbouring part with room. False: there is none.
bool move_one(std::uint32_t part, const Graph& graph, const ClusterCaps& caps, Clustering& clustering,
              std::vector<std::vector<std::uint32_t>>& members) {
  std::int32_t best_gain = 0;
  std::uint32_t best_triangle = 0;
  std::uint32_t best_target = part;
  for (const std::uint32_t t : members[part]) {
    std::int32_t inside = 0;
    for (auto i = graph.row_start[t]; i < graph.row_start[t + 1]; ++i) {
      const auto n = static_cast<std::uint32_t>(graph.neighbor[static_cast<std::size_t>(i)]);
      if (clustering.label[n] == part) inside += graph.edge_weight[static_cast<std::size_t>(i)];
    }
    for (auto i = graph.row_start[t]; i < graph.row_start[t + 1]; ++i) {
      const std::uint32_t target =
          clustering.label[static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(i)])];
      if (target == part || members[target].size() >= caps.max_triangles) continue;
      std::int32_t outside = 0;
      for (auto j = graph.row_start[t]; j < graph.row_start[t + 1]; ++j) {
        const auto n = static_cast<std::uint32_t>(graph.neighbor[static_cast<std::size_t>(j)]);
        if (clustering.label[n] == target) outside += graph.edge_weight[static_cast<std::size_t>(j)];
      }
      const std::int32_t gain = outside - inside;
      if (best_target == part || gain > best_gain) {
        best_gain = gain;
        best_triangle = t;
        best_target = target;
      }
    }
  }
  if (best_target == part) return false;
  members[part].erase(std::find(members[part].begin(), members[part].end(), best_triangle));
  members[best_target].push_back(best_triangle);
  clustering.label[best_triangle] = best_target;
  return true;
}

/// Counts distinct wedges of parts, by the part that each was last seen in.
class WedgeCounter {
 public:
  explicit WedgeCounter(std::span<const WedgeTriangle> triangles) : local_(triangles.begin(), triangles.end()) {
    if (const std::uint32_t limit = dense_limit(triangles); limit != 0) {
      seen_.assign(limit, 0);
      return;
    }
    LocalIds ids(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) local_[t][k] = ids.add(triangles[t][k]);
    }
    seen_.assign(ids.size(), 0);
  }
  std::size_t count(const std::vector<std::uint32_t>& members) {
    ++part_;
    std::size_t distinct = 0;
    for (const std::uint32_t t : members) {
      for (const std::uint32_t wedge : local_[t]) {
        distinct += seen_[wedge] != part_ ? 1 : 0;
        seen_[wedge] = part_;
      }
    }
    return distinct;
  }

 private:
  std::vector<WedgeTriangle> local_;
  std::vector<std::uint32_t> seen_;  ///< per wedge
  std::uint32_t part_ = 0;
};

/// The part of `graph` between `members`, in their order.
Graph subgraph(const Graph& graph, const std::vector<std::uint32_t>& members, std::vector<std::int32_t>& local) {
  Graph sub;
  for (std::size_t i = 0; i < members.size(); ++i) local[members[i]] = static_cast<std::int32_t>(i);
  sub.row_start.push_back(0);
  for (const std::uint32_t t : members) {
    for (auto i = graph.row_start[t]; i < graph.row_start[t + 1]; ++i) {
      const std::int32_t n = local[static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(i)])];
      if (n < 0) continue;
      sub.neighbor.push_back(n);
      sub.edge_weight.push_back(graph.edge_weight[static_cast<std::size_t>(i)]);
    }
    sub.row_start.push_back(static_cast<std::int32_t>(sub.neighbor.size()));
  }
  for (const std::uint32_t t : members) local[t] = -1;
  return sub;
}

}  // namespace

void enforce_caps(std::span<const WedgeTriangle> triangles, const Graph& graph, const ClusterCaps& caps,
                  Clustering& clustering) {
  std::vector<std::vector<std::uint32_t>> members = members_of(clustering);
  for (std::uint32_t part = 0; part < clustering.count; ++part) {
    while (members[part].size() > caps.max_triangles && move_one(part, graph, caps, clustering, members)) {
    }
  }
  WedgeCounter wedges(triangles);
  std::vector<std::int32_t> local(triangles.size(), -1);
  // New parts are appended, so the loop meets them too.
  for (std::uint32_t part = 0; part < clustering.count; ++part) {
    while (members[part].size() > caps.max_triangles || wedges.count(members[part]) > caps.max_vertices) {
      std::sort(members[part].begin(), members[part].end());
      Graph sub = subgraph(graph, members[part], local);
      const std::vector<std::uint32_t> half = partition_graph(sub, 2);
      std::vector<std::uint32_t> keep;
      std::vector<std::uint32_t> split;
      for (std::size_t i = 0; i < half.size(); ++i) (half[i] == 0 ? keep : split).push_back(members[part][i]);
      for (const std::uint32_t t : split) clustering.label[t] = clustering.count;
      ++clustering.count;
      members[part] = std::move(keep);
      members.push_back(std::move(split));
    }
  }
}

}  // namespace meshlode::builder
