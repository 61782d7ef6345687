// SPDX-License-Identifier: GPL-3.0-or-later
// The graph: clusters joined by how many border vertices they share (what a group encloses is free to simplify), plus
// weak links to clusters near by, so that loose pieces, which share nothing, find company.
#include "build/cluster/group.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "build/cluster/partition.h"

namespace meshlode::build {

namespace {

constexpr std::int32_t kSharedVertexWeight = 4;
constexpr std::int32_t kNearbyWeight = 1;
constexpr std::size_t kNearbyLinks = 4;  ///< links along each axis order
constexpr std::size_t kMaxFan = 12;      ///< clusters around one vertex that are linked all with all

struct Link {
  std::uint32_t a, b;  ///< a < b
  std::int32_t weight;
};

void add_shared_links(const GroupInput& input, std::vector<Link>& links) {
  std::vector<std::uint32_t> start(input.position_count + 1, 0);
  for (const std::uint32_t p : input.positions) ++start[p + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> clusters(input.positions.size());
  std::vector<std::uint32_t> cursor(start.begin(), start.end() - 1);
  for (std::uint32_t c = 0; c < input.cluster_count(); ++c) {
    for (std::uint32_t i = input.first_position[c]; i < input.first_position[c + 1]; ++i) {
      clusters[cursor[input.positions[i]]++] = c;
    }
  }
  for (std::uint32_t p = 0; p < input.position_count; ++p) {
    const std::uint32_t count = start[p + 1] - start[p];
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t last = count <= kMaxFan ? count : std::min(count, i + 2);
      for (std::uint32_t j = i + 1; j < last; ++j) {
        links.push_back({clusters[start[p] + i], clusters[start[p] + j], kSharedVertexWeight});
      }
    }
  }
}

/// Links each cluster to the next few along every axis whose centres are nearest among those.
void add_nearby_links(const GroupInput& input, std::vector<Link>& links) {
  const std::uint32_t count = input.cluster_count();
  constexpr std::size_t kWindow = 16;
  std::vector<std::uint32_t> order(count);
  std::vector<std::vector<std::pair<double, std::uint32_t>>> near(count);
  for (int axis = 0; axis < 3; ++axis) {
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return input.centers[a][axis] != input.centers[b][axis] ? input.centers[a][axis] < input.centers[b][axis] : a < b;
    });
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < std::min<std::size_t>(count, i + kWindow); ++j) {
        const Vec3d d = input.centers[order[i]] - input.centers[order[j]];
        near[order[i]].emplace_back(glm::dot(d, d), order[j]);
        near[order[j]].emplace_back(glm::dot(d, d), order[i]);
      }
    }
  }
  const std::size_t first = links.size();
  links.resize(first + kNearbyLinks * count);
  parallel_for_each_index(count, 64, [&](std::size_t c) {
    std::sort(near[c].begin(), near[c].end());
    near[c].erase(std::unique(near[c].begin(), near[c].end()), near[c].end());
    for (std::size_t i = 0; i < kNearbyLinks; ++i) {
      const auto own = static_cast<std::uint32_t>(c);
      const std::uint32_t other = i < near[c].size() ? near[c][i].second : own;
      links[first + kNearbyLinks * c + i] = {std::min(own, other), std::max(own, other), kNearbyWeight};
    }
  });
  std::erase_if(links, [](const Link& link) { return link.a == link.b; });  // of clusters with few others near by
}

Graph cluster_graph(const GroupInput& input) {
  std::vector<Link> links;
  add_shared_links(input, links);
  add_nearby_links(input, links);
  std::sort(links.begin(), links.end(), [](const Link& x, const Link& y) {
    return std::tuple(x.a, x.b, x.weight) < std::tuple(y.a, y.b, y.weight);
  });
  std::size_t merged = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (merged > 0 && links[merged - 1].a == links[i].a && links[merged - 1].b == links[i].b) {
      links[merged - 1].weight += links[i].weight;
    } else {
      links[merged++] = links[i];
    }
  }
  links.resize(merged);

  Graph graph;
  graph.row_start.assign(input.cluster_count() + 1, 0);
  for (const Link& link : links) {
    ++graph.row_start[link.a + 1];
    ++graph.row_start[link.b + 1];
  }
  std::partial_sum(graph.row_start.begin(), graph.row_start.end(), graph.row_start.begin());
  graph.neighbor.resize(2 * links.size());
  graph.edge_weight.resize(2 * links.size());
  std::vector<std::int32_t> cursor(graph.row_start.begin(), graph.row_start.end() - 1);
  const auto add = [&](std::uint32_t from, std::uint32_t to, std::int32_t weight) {
    const auto slot = static_cast<std::size_t>(cursor[from]++);
    graph.neighbor[slot] = static_cast<std::int32_t>(to);
    graph.edge_weight[slot] = weight;
  };
  for (const Link& link : links) {
    add(link.a, link.b, link.weight);
    add(link.b, link.a, link.weight);
  }
  return graph;
}

bool is_too_large(const GroupInput& input, const GroupOptions& options, const std::vector<std::uint32_t>& group) {
  if (group.size() > options.max_clusters) return true;
  std::uint64_t weight = 0;
  for (const std::uint32_t c : group) weight += input.weights[c];
  return weight > options.max_weight && group.size() > 1;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> group_clusters(const GroupInput& input, const GroupOptions& options) {
  const std::uint32_t count = input.cluster_count();
  if (count == 0) return {};
  // One and a half targets are still one group: fewer locked borders where they hurt most, at the top.
  std::uint32_t parts = 1;
  if (2 * count > 3 * options.target_clusters) parts = (count + options.target_clusters - 1) / options.target_clusters;
  Graph graph = cluster_graph(input);
  const std::vector<std::uint32_t> label = partition_graph(graph, parts, options.seed);
  std::vector<std::vector<std::uint32_t>> groups(parts);
  for (std::uint32_t c = 0; c < count; ++c) groups[label[c]].push_back(c);
  std::erase_if(groups, [](const auto& group) { return group.empty(); });

  // Halving by index order keeps near clusters together, because clusters of a level come in spatial order.
  for (std::size_t g = 0; g < groups.size(); ++g) {
    while (is_too_large(input, options, groups[g])) {
      const auto middle = groups[g].begin() + static_cast<std::ptrdiff_t>(groups[g].size() / 2);
      std::vector<std::uint32_t> rest(middle, groups[g].end());
      groups[g].erase(middle, groups[g].end());
      groups.push_back(std::move(rest));
    }
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

}  // namespace meshlode::build
