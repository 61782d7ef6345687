// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/adjacency.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/local_ids.h"
#include "builder/cluster/dense_limit.h"

namespace meshlode::builder {

namespace {

using Corner3 = std::array<std::uint32_t, 3>;

/// Positions renumbered below n, which is returned.
std::uint32_t compact(std::span<const Corner3> source, std::vector<Corner3>& out) {
  if (const std::uint32_t limit = dense_limit(source); limit != 0) {
    out.assign(source.begin(), source.end());
    return limit;
  }
  LocalIds ids(source.size());  // a closed surface has half as many
  out.resize(source.size());
  for (std::size_t t = 0; t < source.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) out[t][k] = ids.add(source[t][k]);
  }
  return static_cast<std::uint32_t>(ids.size());
}

/// By insertion where there are few, as nearly always.
void sort_few(std::uint64_t* first, std::uint64_t* last) {
  constexpr std::ptrdiff_t kFew = 24;
  if (last - first > kFew) {
    std::sort(first, last);
    return;
  }
  for (std::uint64_t* it = first; it != last; ++it) {
    const std::uint64_t value = *it;
    std::uint64_t* hole = it;
    for (; hole != first && value < *(hole - 1); --hole) *hole = *(hole - 1);
    *hole = value;
  }
}

/// Two numbers that sort by the first, as one.
constexpr std::uint64_t pair_of(std::uint32_t first, std::uint32_t second) {
  return std::uint64_t{first} << 32U | second;
}
constexpr std::uint32_t first_of(std::uint64_t pair) {
  return static_cast<std::uint32_t>(pair >> 32U);
}
constexpr std::uint32_t second_of(std::uint64_t pair) {
  return static_cast<std::uint32_t>(pair);
}

}  // namespace

/// Each row sorted. Two triangles that share two edges become one neighbour of twice the weight: METIS wants no
/// repeated edges.
Graph TriangleLinks::rows() {
  std::sort(more_.begin(), more_.end());
  Graph graph;
  graph.row_start.reserve(degree_.size() + 1);
  graph.row_start.push_back(0);
  const std::size_t entries = kFew * few_.size() + more_.size();
  graph.neighbor.reserve(entries);
  graph.edge_weight.reserve(entries);
  std::vector<std::uint64_t> row;
  auto rest = more_.begin();
  const auto write = [&](std::uint64_t* first, std::uint64_t* last) {
    sort_few(first, last);
    for (const std::uint64_t* it = first; it != last; ++it) {
      const auto weight = static_cast<std::int32_t>(second_of(*it));
      if (it != first && first_of(*it) == first_of(*(it - 1))) {
        graph.edge_weight.back() += weight;
        continue;
      }
      graph.neighbor.push_back(static_cast<std::int32_t>(first_of(*it)));
      graph.edge_weight.push_back(weight);
    }
  };
  for (std::uint32_t t = 0; t < degree_.size(); ++t) {
    if (degree_[t] <= kFew) {
      write(few_[t].data(), few_[t].data() + degree_[t]);
    } else {
      row.assign(few_[t].begin(), few_[t].end());
      for (; rest != more_.end() && rest->first == t; ++rest) row.push_back(rest->second);
      write(row.data(), row.data() + row.size());
    }
    graph.row_start.push_back(static_cast<std::int32_t>(graph.neighbor.size()));
  }
  return graph;
}

/// Triangles that share an edge: those of one edge in a chain. A counting sort of edges by their smaller position, then
/// a sort inside each (usually tiny) bucket.
void TriangleLinks::link_along_edges(const std::vector<Corner3>& corners, std::uint32_t position_count) {
  const auto for_each_edge = [&](auto&& visit) {
    for (std::uint32_t t = 0; t < corners.size(); ++t) {
      const auto [a, b, c] = corners[t];
      if (a != b) visit(std::min(a, b), std::max(a, b), t);
      if (b != c) visit(std::min(b, c), std::max(b, c), t);
      if (c != a) visit(std::min(c, a), std::max(c, a), t);
    }
  };
  std::vector<std::uint32_t> end(position_count + 1, 0);  // of each bucket, once it is filled
  for_each_edge([&](std::uint32_t low, std::uint32_t, std::uint32_t) { ++end[low + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::uint64_t> uses(end.back());  // the larger position, and the triangle
  for_each_edge([&](std::uint32_t low, std::uint32_t high, std::uint32_t t) { uses[end[low]++] = pair_of(high, t); });
  std::uint64_t* first = uses.data();
  for (std::uint32_t bucket = 0; bucket < position_count; ++bucket) {
    std::uint64_t* const last = uses.data() + end[bucket];
    sort_few(first, last);
    for (const std::uint64_t* use = first; use != last && use + 1 != last; ++use) {
      if (first_of(use[0]) != first_of(use[1]) || second_of(use[0]) == second_of(use[1])) continue;
      link(second_of(use[0]), second_of(use[1]), kSharedEdgeWeight);
    }
    first = last;
  }
}

TriangleLinks::TriangleLinks(std::span<const Corner3> corner_positions) : TriangleLinks(corner_positions.size()) {
  std::vector<Corner3> corners;
  const std::uint32_t position_count = compact(corner_positions, corners);
  link_along_edges(corners, position_count);
}

std::uint32_t TriangleLinks::find_pieces(std::vector<std::uint32_t>& piece) {
  piece.assign(degree_.size(), kNoId);
  std::vector<std::uint32_t> name(degree_.size(), kNoId);  // by what stands for the piece
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; t < piece.size(); ++t) {
    std::uint32_t& own = name[pieces_.find(t)];
    if (own == kNoId) own = count++;
    piece[t] = own;
  }
  return count;
}

void TriangleLinks::add(std::span<const TriangleLink> links) {
  for (const auto& [a, b] : links) link(a, b, kSharedEdgeWeight);
}

TriangleLinks TriangleLinks::without(std::span<const std::uint32_t> hosts) const {
  std::vector<std::uint32_t> place(hosts.size(), kNoId);
  std::uint32_t count = 0;
  for (std::size_t t = 0; t < hosts.size(); ++t) {
    if (hosts[t] == kNoId) place[t] = count++;
  }
  TriangleLinks kept(count);
  const auto keep = [&](std::uint32_t t, std::uint64_t entry) {
    const std::uint32_t to = place[first_of(entry)];
    if (place[t] == kNoId || to == kNoId) return;
    kept.put(place[t], pair_of(to, second_of(entry)));
    kept.pieces_.join(place[t], to);
  };
  for (std::uint32_t t = 0; t < hosts.size(); ++t) {
    for (std::uint32_t i = 0; i < std::min(degree_[t], kFew); ++i) keep(t, few_[t][i]);
  }
  for (const auto& [t, entry] : more_) keep(t, entry);
  return kept;
}

Graph TriangleLinks::graph() {
  for (std::uint32_t t = 0; t + 1 < degree_.size(); ++t) {
    if (pieces_.find(t) != pieces_.find(t + 1)) link(t, t + 1, kNearbyWeight);
  }
  return rows();
}

}  // namespace meshlode::builder
