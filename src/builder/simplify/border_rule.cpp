// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/border_rule.h"

#include <algorithm>
#include <compare>
#include <cstdlib>

#include "base/disjoint_sets.h"

namespace meshlode::builder {

namespace {

/// A triangle's use of an edge between positions low < high.
struct SideUse {
  std::uint32_t low, high;
  std::uint32_t triangle;
  std::int32_t sign;  ///< +1 from low to high
  auto operator<=>(const SideUse&) const = default;
};

/// An edge of the border: used more often one way than the other.
struct BorderEdge {
  std::uint32_t low, high;
  std::int32_t net;  ///< never 0
  bool operator==(const BorderEdge&) const = default;
};

/// The border of a set of triangles, and how it hangs on the surface.
struct Border {
  std::vector<BorderEdge> edges;  ///< ascending
  std::int64_t pieces = 0;        ///< of the surface, connected across edges, that have a border
};

bool precedes(const Vec3i& p, const Vec3i& q) {
  if (p.x != q.x) return p.x < q.x;
  return p.y != q.y ? p.y < q.y : p.z < q.z;
}

template <class Surface>
Border find_border(const Surface& surface, const std::vector<std::uint32_t>& name) {
  std::vector<SideUse> uses;
  uses.reserve(3 * surface.triangles.size());
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = name[surface.wedge_position[surface.triangles[t][k]]];
      const std::uint32_t b = name[surface.wedge_position[surface.triangles[t][(k + 1) % 3]]];
      if (a != b) uses.push_back({std::min(a, b), std::max(a, b), t, a < b ? 1 : -1});
    }
  }
  std::sort(uses.begin(), uses.end());
  Border border;
  DisjointSets pieces(surface.triangles.size());
  std::vector<std::uint32_t> at_border;
  for (std::size_t i = 0; i < uses.size();) {
    const SideUse& first = uses[i];
    std::int32_t net = 0;
    for (; i < uses.size() && uses[i].low == first.low && uses[i].high == first.high; ++i) {
      net += uses[i].sign;
      pieces.join(first.triangle, uses[i].triangle);
    }
    if (net == 0) continue;
    border.edges.push_back({first.low, first.high, net});
    at_border.push_back(first.triangle);
  }
  for (std::uint32_t& triangle : at_border) triangle = pieces.find(triangle);
  std::sort(at_border.begin(), at_border.end());
  border.pieces = std::unique(at_border.begin(), at_border.end()) - at_border.begin();
  return border;
}

/// The border's independent loops less one for each piece that it goes around.
std::int64_t count_holes(const Border& border, std::size_t position_count) {
  DisjointSets connected(position_count);
  std::int64_t holes = -border.pieces;
  for (const BorderEdge& edge : border.edges) {
    holes += std::abs(edge.net) - (connected.join(edge.low, edge.high) ? 1 : 0);
  }
  return holes;
}

struct Exchange {
  std::uint32_t low, high;
  std::int64_t gone, come;  ///< uses
};

/// What one border has and the other has not, edge by edge.
std::vector<Exchange> exchanges_of(const std::vector<BorderEdge>& finer, const std::vector<BorderEdge>& coarser) {
  std::vector<Exchange> out;
  const auto add = [&](const BorderEdge& at, std::int32_t before, std::int32_t after) {
    const auto uses = [](std::int32_t net, int sign) { return std::max(0, sign * net); };
    Exchange exchange{at.low, at.high, 0, 0};
    for (const int sign : {1, -1}) {
      exchange.gone += std::max(0, uses(before, sign) - uses(after, sign));
      exchange.come += std::max(0, uses(after, sign) - uses(before, sign));
    }
    if (exchange.gone != 0 || exchange.come != 0) out.push_back(exchange);
  };
  const auto is_before = [](const BorderEdge& x, const BorderEdge& y) {
    return x.low != y.low ? x.low < y.low : x.high < y.high;
  };
  auto f = finer.begin();
  auto c = coarser.begin();
  while (f != finer.end() || c != coarser.end()) {
    if (c == coarser.end() || (f != finer.end() && is_before(*f, *c))) {
      add(*f, f->net, 0);
      ++f;
    } else if (f == finer.end() || is_before(*c, *f)) {
      add(*c, 0, c->net);
      ++c;
    } else {
      add(*f, f->net, c->net);
      ++f;
      ++c;
    }
  }
  return out;
}

/// In all no more edges come than go, and what comes hangs together with what goes, or is a loop for a loop that goes.
bool stands_for_what_goes(const std::vector<Exchange>& exchanges, std::size_t position_count) {
  DisjointSets together(position_count);
  DisjointSets together_before(position_count);
  std::int64_t balance = 0;
  std::int64_t loops_gone = 0;
  for (const Exchange& exchange : exchanges) {
    together.join(exchange.low, exchange.high);
    balance += exchange.come - exchange.gone;
    if (exchange.gone != 0) loops_gone += exchange.gone - (together_before.join(exchange.low, exchange.high) ? 1 : 0);
  }
  if (balance > 0) return false;
  std::vector<std::uint8_t> has_lost(position_count, 0);
  for (const Exchange& exchange : exchanges) {
    if (exchange.gone != 0) has_lost[together.find(exchange.low)] = 1;
  }
  std::int64_t loops_new = 0;
  for (const Exchange& exchange : exchanges) {
    std::uint8_t& is_known = has_lost[together.find(exchange.low)];
    if (is_known == 0) ++loops_new;
    is_known = 1;
  }
  return loops_new <= loops_gone;
}

}  // namespace

bool keeps_border(const SimplifyInput& finer, const SimplifyResult& coarser) {
  std::vector<Vec3i> places = finer.positions;
  places.insert(places.end(), coarser.positions.begin(), coarser.positions.end());
  std::sort(places.begin(), places.end(), precedes);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const auto names_of = [&](const std::vector<Vec3i>& positions) {
    std::vector<std::uint32_t> names;
    names.reserve(positions.size());
    for (const Vec3i& p : positions) {
      names.push_back(
          static_cast<std::uint32_t>(std::lower_bound(places.begin(), places.end(), p, precedes) - places.begin()));
    }
    return names;
  };
  const std::vector<std::uint32_t> finer_names = names_of(finer.positions);
  const Border before = find_border(finer, finer_names);
  const Border after = find_border(coarser, names_of(coarser.positions));
  if (before.edges == after.edges) return true;

  const std::vector<Exchange> exchanges = exchanges_of(before.edges, after.edges);
  std::vector<std::uint8_t> is_locked(places.size(), 0);
  for (std::size_t p = 0; p < finer_names.size(); ++p) is_locked[finer_names[p]] |= finer.is_locked[p];
  for (const Exchange& exchange : exchanges) {
    if (exchange.gone != 0 && is_locked[exchange.low] != 0 && is_locked[exchange.high] != 0) return false;
  }
  return stands_for_what_goes(exchanges, places.size()) &&
         count_holes(after, places.size()) <= count_holes(before, places.size());
}

bool keeps_locked_border(const SimplifyInput& finer, const SimplifyResult& coarser) {
  if (finer.is_border_locked.empty()) return true;
  std::vector<Vec3i> places = coarser.positions;
  std::sort(places.begin(), places.end(), precedes);
  return std::all_of(finer.triangles.begin(), finer.triangles.end(), [&](const WedgeTriangle& triangle) {
    const std::uint32_t a = finer.wedge_position[triangle[0]], b = finer.wedge_position[triangle[1]],
                        c = finer.wedge_position[triangle[2]];
    if (a == b || b == c || c == a) return true;
    const auto is_kept = [&](std::uint32_t p) {
      return finer.is_border_locked[p] == 0 ||
             std::binary_search(places.begin(), places.end(), finer.positions[p], precedes);
    };
    return is_kept(a) && is_kept(b) && is_kept(c);
  });
}

SimplifyInput with_locked_border(SimplifyInput input) {
  std::vector<std::uint32_t> names(input.positions.size());
  for (std::uint32_t p = 0; p < names.size(); ++p) names[p] = p;
  for (const BorderEdge& edge : find_border(input, names).edges)
    input.is_locked[edge.low] = input.is_locked[edge.high] = 1;
  return input;
}

}  // namespace meshlode::builder
