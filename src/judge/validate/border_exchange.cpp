// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/border_exchange.h"

#include <algorithm>
#include <compare>
#include <cstdlib>
#include <utility>

#include "base/disjoint_sets.h"

namespace meshlode::judge {

namespace {

/// What hangs together by edges, by name of position.
class Components {
 public:
  template <class Edges>
  Components(const MeshSurface& surface, const Edges& edges)
      : positions_(ends_of(surface, edges)), sets_(positions_.size()) {}

  /// Less than size(). \pre x is an end of one of the edges
  [[nodiscard]] std::uint32_t find(std::uint32_t x) { return sets_.find(index(x)); }
  bool join(std::uint32_t a, std::uint32_t b) { return sets_.join(index(a), index(b)); }
  [[nodiscard]] std::size_t size() const { return positions_.size(); }

 private:
  template <class Edges>
  static std::vector<std::uint32_t> ends_of(const MeshSurface& surface, const Edges& edges) {
    std::vector<std::uint32_t> ends;
    for (const auto& edge : edges) {
      ends.insert(ends.end(), surface.edges[edge.edge].begin(), surface.edges[edge.edge].end());
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
  }
  [[nodiscard]] std::uint32_t index(std::uint32_t x) const {
    return static_cast<std::uint32_t>(std::lower_bound(positions_.begin(), positions_.end(), x) - positions_.begin());
  }

  std::vector<std::uint32_t> positions_;  ///< ascending, distinct
  DisjointSets sets_;
};

Exchange exchange_of(std::uint32_t edge, std::int32_t finer, std::int32_t coarser) {
  const bool same_sign = (finer > 0) == (coarser > 0) && finer != 0 && coarser != 0;
  if (!same_sign) return {edge, finer, coarser};
  const std::int32_t kept = finer > 0 ? std::min(finer, coarser) : std::max(finer, coarser);
  return {edge, finer - kept, coarser - kept};
}

/// How many pieces of the set's surface, connected across edges, have an edge of the chain.
std::int64_t count_pieces_with_border(const MeshSurface& surface, const ClusterSet& set) {
  struct Side {
    std::array<std::uint32_t, 2> ends;  ///< ascending
    std::uint32_t triangle;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  sides.reserve(3 * set.triangles.size());
  for (std::uint32_t t = 0; t < set.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = set.triangles[t][k];
      const std::uint32_t b = set.triangles[t][(k + 1) % 3];
      if (a != b) sides.push_back({{std::min(a, b), std::max(a, b)}, t});
    }
  }
  std::sort(sides.begin(), sides.end());
  DisjointSets pieces(set.triangles.size());
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].ends == sides[i - 1].ends) pieces.join(sides[i].triangle, sides[i - 1].triangle);
  }
  std::vector<std::uint32_t> with_border;
  auto side = sides.begin();
  for (const EdgeUse& use : set.chain) {  // both are ascending by positions
    while (side != sides.end() && side->ends < surface.edges[use.edge]) ++side;
    if (side != sides.end() && side->ends == surface.edges[use.edge])
      with_border.push_back(pieces.find(side->triangle));
  }
  std::sort(with_border.begin(), with_border.end());
  return std::unique(with_border.begin(), with_border.end()) - with_border.begin();
}

/// E - V + components of edges that are used `uses(edge)` times: their independent loops.
template <class Edges, class Uses>
std::int64_t count_loops(const MeshSurface& surface, const Edges& edges, const Uses& uses) {
  Components components(surface, edges);
  std::int64_t loops = 0;
  for (const auto& edge : edges) {
    const std::int64_t count = std::abs(std::int64_t{uses(edge)});
    if (count == 0) continue;
    const auto& [a, b] = surface.edges[edge.edge];
    loops += count - (components.join(a, b) ? 1 : 0);  // V - components is the number of joins that tied two together
  }
  return loops;
}

/// The first reason why what comes does not stand for what goes; empty if it does.
std::string refuse_parts(const MeshSurface& surface, std::span<const Exchange> exchanges) {
  Components components(surface, exchanges);
  std::vector<std::uint8_t> is_anchored(components.size(), 0);
  std::int64_t removed = 0;
  std::int64_t added = 0;
  for (const Exchange& exchange : exchanges) {
    components.join(surface.edges[exchange.edge][0], surface.edges[exchange.edge][1]);
    removed += std::abs(std::int64_t{exchange.removed});
    added += std::abs(std::int64_t{exchange.added});
  }
  if (added > removed) {
    return std::to_string(added) + " edges of border come for " + std::to_string(removed) + " that go, such as " +
           edge_text(surface, exchanges.back().edge);
  }
  for (const Exchange& exchange : exchanges) {
    if (exchange.removed != 0) is_anchored[components.find(surface.edges[exchange.edge][0])] = 1;
  }
  std::int64_t new_loops = 0;
  std::uint32_t last_edge = 0;
  for (const Exchange& exchange : exchanges) {
    std::uint8_t& is_seen = is_anchored[components.find(surface.edges[exchange.edge][0])];
    if (is_seen != 0) continue;
    is_seen = 1;
    ++new_loops;
    last_edge = exchange.edge;
  }
  if (new_loops <= count_loops(surface, exchanges, [](const Exchange& e) { return e.removed; })) return {};
  return "edge " + edge_text(surface, last_edge) + " of the coarser set opens a border where the finer set has none";
}

}  // namespace

std::int64_t count_holes(const MeshSurface& surface, const ClusterSet& set) {
  return count_loops(surface, set.chain, [](const EdgeUse& use) { return use.net; }) -
         count_pieces_with_border(surface, set);
}

std::vector<Exchange> exchanges_of(std::span<const EdgeUse> finer, std::span<const EdgeUse> coarser) {
  std::vector<Exchange> exchanges;
  for_each_edge(finer, coarser, [&](std::uint32_t edge, std::int32_t f, std::int32_t c) {
    if (f != c) exchanges.push_back(exchange_of(edge, f, c));
  });
  return exchanges;
}

std::string refuse_exchange(const MeshSurface& surface, const BorderSet& border, std::span<const Exchange> exchanges,
                            const ClusterSet& finer, const ClusterSet& coarser) {
  for (const Exchange& exchange : exchanges) {
    if (exchange.removed == 0 || border.allows(exchange.edge, exchange.removed)) continue;
    return "edge " + edge_text(surface, exchange.edge) + " of the finer set, used " + std::to_string(exchange.removed) +
           " times, is missing in the coarser set and no border of the source";
  }
  std::string reason = refuse_parts(surface, exchanges);
  if (!reason.empty()) return reason;
  const std::int64_t before = count_holes(surface, finer);
  const std::int64_t after = count_holes(surface, coarser);
  if (after <= before) return {};
  return "the coarser set has " + std::to_string(after - before) +
         " holes more than the finer set, of which one may be at " + edge_text(surface, exchanges.back().edge);
}

}  // namespace meshlode::judge
