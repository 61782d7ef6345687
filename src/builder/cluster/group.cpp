// SPDX-License-Identifier: GPL-3.0-or-later
// The graph: clusters joined by how many border vertices they share (what a group encloses is free to simplify), plus
// weak links to clusters near by, so that loose pieces, which share nothing, find company.
#include "builder/cluster/group.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "builder/cluster/partition.h"

namespace meshlode::builder {

namespace {

constexpr std::int32_t kSharedVertexWeight = 4;
constexpr std::int32_t kNearbyWeight = 1;
constexpr std::size_t kNearbyLinks = 4;  ///< links along each axis order
constexpr std::size_t kMaxFan = 12;      ///< clusters around one vertex that are linked all with all

/// For each position of a level the clusters that have it, ascending.
struct Fans {
  std::vector<std::uint32_t> start;  ///< by position, and one more: into clusters
  std::vector<std::uint32_t> clusters;

  explicit Fans(const GroupInput& input) : start(input.position_count + 1, 0), clusters(input.positions.size()) {
    for (const std::uint32_t p : input.positions) ++start[p + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> cursor(start.begin(), start.end() - 1);
    for (std::uint32_t c = 0; c < input.cluster_count(); ++c) {
      for (std::uint32_t i = input.first_position[c]; i < input.first_position[c + 1]; ++i) {
        clusters[cursor[input.positions[i]]++] = c;
      }
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t position) const {
    return std::span(clusters).subspan(start[position], start[position + 1] - start[position]);
  }
};

/// A cluster's link to another. Both ends have it.
struct Link {
  std::uint32_t to = 0;
  std::int32_t weight = 0;
};

/// With all that share a position with it; where very many do, with those before and after it alone.
void add_shared_links(const GroupInput& input, const Fans& fans, std::uint32_t own, std::vector<Link>& links) {
  for (std::uint32_t i = input.first_position[own]; i < input.first_position[own + 1]; ++i) {
    const std::span<const std::uint32_t> fan = fans.around(input.positions[i]);
    if (fan.size() <= kMaxFan) {
      for (const std::uint32_t other : fan) {
        if (other != own) links.push_back({other, kSharedVertexWeight});
      }
      continue;
    }
    const auto at = std::lower_bound(fan.begin(), fan.end(), own);
    if (at != fan.begin()) links.push_back({*(at - 1), kSharedVertexWeight});
    if (at + 1 != fan.end()) links.push_back({*(at + 1), kSharedVertexWeight});
  }
}

/// A cluster's nearest few; as many times itself as there are fewer.
using Nearest = std::array<std::uint32_t, kNearbyLinks>;

/// Of each cluster the nearest of those whose centres come shortly before or after its own along an axis.
std::vector<Nearest> find_nearest(const GroupInput& input) {
  const std::uint32_t count = input.cluster_count();
  constexpr std::size_t kWindow = 15;
  std::array<std::vector<std::uint32_t>, 3> order, rank;
  parallel_for_each_index(3, 1, [&](std::size_t k) {
    const auto axis = static_cast<int>(k);
    order[k].resize(count);
    rank[k].resize(count);
    std::iota(order[k].begin(), order[k].end(), 0U);
    std::sort(order[k].begin(), order[k].end(), [&](std::uint32_t a, std::uint32_t b) {
      return input.centers[a][axis] != input.centers[b][axis] ? input.centers[a][axis] < input.centers[b][axis] : a < b;
    });
    for (std::uint32_t i = 0; i < count; ++i) rank[k][order[k][i]] = i;
  });
  std::vector<Nearest> nearest(count);
  parallel_for_each_index(count, 64, [&](std::size_t c) {
    const auto own = static_cast<std::uint32_t>(c);
    std::array<std::pair<double, std::uint32_t>, kNearbyLinks> best;
    best.fill({std::numeric_limits<double>::infinity(), own});
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = rank[k][c], last = std::min<std::size_t>(count, at + kWindow + 1);
      for (std::size_t i = at - std::min(at, kWindow); i < last; ++i) {
        const std::uint32_t other = order[k][i];
        const Vec3d d = input.centers[other] - input.centers[own];
        const std::pair<double, std::uint32_t> candidate(glm::dot(d, d), other);
        if (other == own || !(candidate < best.back()) || std::find(best.begin(), best.end(), candidate) != best.end())
          continue;
        best.back() = candidate;
        for (std::size_t j = kNearbyLinks - 1; j > 0 && best[j] < best[j - 1]; --j) std::swap(best[j], best[j - 1]);
      }
    }
    for (std::size_t j = 0; j < kNearbyLinks; ++j) nearest[c][j] = best[j].second;
  });
  return nearest;
}

/// Who has a cluster among its nearest.
struct NearestTo {
  std::vector<std::uint32_t> start;  ///< by cluster, and one more: into clusters
  std::vector<std::uint32_t> clusters;

  explicit NearestTo(const std::vector<Nearest>& nearest)
      : start(nearest.size() + 1, 0), clusters(kNearbyLinks * nearest.size()) {
    for (const Nearest& few : nearest) {
      for (const std::uint32_t c : few) ++start[c + 1];
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> cursor(start.begin(), start.end() - 1);
    for (std::uint32_t c = 0; c < nearest.size(); ++c) {
      for (const std::uint32_t other : nearest[c]) clusters[cursor[other]++] = c;
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t cluster) const {
    return std::span(clusters).subspan(start[cluster], start[cluster + 1] - start[cluster]);
  }
};

/// One link to each other cluster, ascending, with the weights of all.
void merge_links(std::vector<Link>& links) {
  std::sort(links.begin(), links.end(), [](const Link& x, const Link& y) { return x.to < y.to; });
  std::size_t merged = 0;
  for (const Link& link : links) {
    if (merged > 0 && links[merged - 1].to == link.to) {
      links[merged - 1].weight += link.weight;
    } else {
      links[merged++] = link;
    }
  }
  links.resize(merged);
}

Graph cluster_graph(const GroupInput& input) {
  constexpr std::size_t kRows = 32;
  const std::uint32_t count = input.cluster_count();
  const Fans fans(input);
  const std::vector<Nearest> nearest = find_nearest(input);
  const NearestTo nearest_to(nearest);
  std::vector<std::vector<Link>> rows(chunk_count(count, kRows));
  Graph graph;
  graph.row_start.assign(count + 1, 0);
  parallel_for_each_chunk(count, kRows, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::vector<Link> row;
    for (std::size_t c = begin; c < end; ++c) {
      const auto own = static_cast<std::uint32_t>(c);
      row.clear();
      add_shared_links(input, fans, own, row);
      for (const std::uint32_t other : nearest[c]) {
        if (other != own) row.push_back({other, kNearbyWeight});
      }
      for (const std::uint32_t other : nearest_to.of(own)) {
        if (other != own) row.push_back({other, kNearbyWeight});
      }
      merge_links(row);
      graph.row_start[c + 1] = static_cast<std::int32_t>(row.size());
      rows[chunk].insert(rows[chunk].end(), row.begin(), row.end());
    }
  });
  std::partial_sum(graph.row_start.begin(), graph.row_start.end(), graph.row_start.begin());
  graph.neighbor.reserve(static_cast<std::size_t>(graph.row_start.back()));
  graph.edge_weight.reserve(graph.neighbor.capacity());
  for (const std::vector<Link>& chunk : rows) {
    for (const Link& link : chunk) {
      graph.neighbor.push_back(static_cast<std::int32_t>(link.to));
      graph.edge_weight.push_back(link.weight);
    }
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

}  // namespace meshlode::builder
