// SPDX-License-Identifier: GPL-3.0-or-later
// Generalised strips are paths in the graph of triangles that share an edge: each step leaves through one of the two edges
// that it did not come in by. A cluster is covered with few paths, greedily (the neighbour with the fewest ways out first,
// as Akeley's tomesh did), and a path's far ends near what was used last, so that references stay short. Several covers
// are tried with different tie breaks; the one with the fewest bits stays. (Strips with fan bits and reuse references:
// Kuth et al. 2024, Towards Practical Meshlet Compression.)
#include "encode/strips.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <tuple>

namespace meshlode {

namespace {

constexpr std::uint32_t kNobody = 0xFFFFU;

/// Across edge e (corner e to corner e + 1) of a triangle: the triangle that has the edge the other way round.
struct Neighbour {
  std::uint16_t triangle = kNobody;
  std::uint8_t edge = 0;
};
using Adjacency = std::vector<std::array<Neighbour, 3>>;

Adjacency find_neighbours(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block) {
  struct Edge {
    std::uint32_t block;
    std::uint16_t low_high;  ///< both vertices, the smaller first
    bool is_descending;
    std::uint16_t triangle;
    std::uint8_t edge;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = triangles[t][e];
      const std::uint32_t b = triangles[t][(e + 1) % 3];
      if (a == b) continue;
      edges.push_back({block[t], static_cast<std::uint16_t>(std::min(a, b) << 8U | std::max(a, b)), a > b,
                       static_cast<std::uint16_t>(t), static_cast<std::uint8_t>(e)});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
    return std::tie(l.block, l.low_high, l.is_descending, l.triangle, l.edge) <
           std::tie(r.block, r.low_high, r.is_descending, r.triangle, r.edge);
  });
  Adjacency neighbours(triangles.size());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    std::size_t split = i;  // first descending one
    for (; end < edges.size() && edges[end].block == edges[i].block && edges[end].low_high == edges[i].low_high; ++end) {
      if (!edges[end].is_descending) split = end + 1;
    }
    for (std::size_t k = 0; i + k < split && split + k < end; ++k) {  // where more than two meet: pairs, as far as they go
      const Edge& a = edges[i + k];
      const Edge& b = edges[split + k];
      if (a.triangle == b.triangle) continue;
      neighbours[a.triangle][a.edge] = {b.triangle, b.edge};
      neighbours[b.triangle][b.edge] = {a.triangle, a.edge};
    }
    i = end;
  }
  return neighbours;
}

/// A small generator of its own: the same sequence everywhere (I10).
class Coin {
 public:
  explicit Coin(std::uint32_t seed) : state_(seed * 2654435761U + 12345U) {}
  std::uint32_t next() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return state_;
  }

 private:
  std::uint32_t state_;
};

struct Step {
  std::uint16_t triangle;
  std::uint8_t in, out;  ///< edges; equal to kOpen at the ends
};
constexpr std::uint8_t kOpen = 3;

class Striper {
 public:
  Striper(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block, const Adjacency& neighbours,
          std::uint32_t vertex_count)
      : triangles_(triangles), block_(block), neighbours_(neighbours), vertex_count_(vertex_count) {}

  Strips run(std::uint32_t trial) {
    Coin coin(trial + 1);
    out_ = {};
    used_.assign(triangles_.size(), false);
    number_.assign(vertex_count_, kNobody);
    std::size_t begin = 0;
    while (begin < triangles_.size()) {
      std::size_t end = begin;
      while (end < triangles_.size() && block_[end] == block_[begin]) ++end;
      for (std::size_t done = begin; done < end;) {
        const std::vector<Step> path = find_path(begin, end, coin, trial);
        emit(path, trial);
        done += path.size();
      }
      begin = end;
    }
    out_.reference_bits = 1;
    for (const std::uint32_t d : out_.references) {
      out_.reference_bits = std::max(out_.reference_bits, static_cast<std::uint32_t>(std::bit_width(d)));
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool is_free(Neighbour n) const { return n.triangle != kNobody && !used_[n.triangle]; }

  [[nodiscard]] std::uint32_t free_degree(std::size_t t) const {
    std::uint32_t degree = 0;
    for (const Neighbour n : neighbours_[t]) degree += is_free(n) ? 1U : 0U;
    return degree;
  }

  /// How long ago the oldest named vertex of a triangle came up; fresh ones count as now.
  [[nodiscard]] std::uint32_t age(std::size_t t) const {
    std::uint32_t oldest = 0;
    const auto now = static_cast<std::uint32_t>(out_.vertex_order.size());
    for (const std::uint8_t v : triangles_[t]) {
      if (number_[v] != kNobody) oldest = std::max(oldest, now - number_[v]);
    }
    return oldest;
  }

  [[nodiscard]] std::size_t choose_start(std::size_t begin, std::size_t end, Coin& coin, std::uint32_t trial) const {
    std::size_t best = end;
    std::tuple<std::uint32_t, std::uint32_t, std::uint32_t> best_key{};
    for (std::size_t t = begin; t < end; ++t) {
      if (used_[t]) continue;
      const std::uint32_t degree = free_degree(t);
      // Oldest vertices first: what is left behind longest makes the longest references.
      const std::uint32_t old = 1024U - age(t);
      const auto key = trial % 2 == 0 ? std::tuple(degree, old, coin.next()) : std::tuple(old, degree, coin.next());
      if (best == end || key < best_key) {
        best = t;
        best_key = key;
      }
    }
    return best;
  }

  /// The edge to leave `t` by, other than `in`: towards the neighbour with the fewest ways out.
  [[nodiscard]] std::uint8_t choose_exit(std::size_t t, std::uint8_t in, Coin& coin) const {
    std::uint8_t best = kOpen;
    std::tuple<std::uint32_t, std::uint32_t, std::uint32_t> best_key{};
    for (std::uint8_t e = 0; e < 3; ++e) {
      if (e == in || !is_free(neighbours_[t][e])) continue;
      const std::size_t next = neighbours_[t][e].triangle;
      const auto key = std::tuple(free_degree(next), 1024U - age(next), coin.next());
      if (best == kOpen || key < best_key) {
        best = e;
        best_key = key;
      }
    }
    return best;
  }

  std::vector<Step> find_path(std::size_t begin, std::size_t end, Coin& coin, std::uint32_t trial) {
    std::vector<Step> path;
    const std::size_t start = choose_start(begin, end, coin, trial);
    const auto walk = [&](std::size_t t, std::uint8_t in) {
      while (true) {
        used_[t] = true;
        const std::uint8_t out = choose_exit(t, in, coin);
        path.push_back({static_cast<std::uint16_t>(t), in, out});
        if (out == kOpen) return;
        const Neighbour next = neighbours_[t][out];
        t = next.triangle;
        in = next.edge;
      }
    };
    walk(start, kOpen);
    // The other way from the start, as far as it goes.
    const std::uint8_t back = choose_exit(start, path.front().out, coin);
    if (back != kOpen) {
      std::vector<Step> forward = std::move(path);
      path.clear();
      forward.front().in = back;
      walk(neighbours_[start][back].triangle, neighbours_[start][back].edge);
      std::reverse(path.begin(), path.end());
      for (Step& step : path) std::swap(step.in, step.out);
      path.insert(path.end(), forward.begin(), forward.end());
    }
    return path;
  }

  void name_vertex(std::uint8_t v) {
    out_.slots.push_back(v);
    const auto fresh = static_cast<std::uint32_t>(out_.vertex_order.size());
    if (number_[v] == kNobody) {
      number_[v] = fresh;
      out_.vertex_order.push_back(v);
    } else {
      out_.references.push_back(fresh - 1U - number_[v]);
    }
  }

  void emit(std::vector<Step> path, std::uint32_t trial) {
    // From whichever end has the older vertices.
    if (path.size() > 1 && age(path.back().triangle) > age(path.front().triangle)) {
      std::reverse(path.begin(), path.end());
      for (Step& step : path) std::swap(step.in, step.out);
    }
    out_.first_triangle.push_back(static_cast<std::uint32_t>(out_.turns.size()));
    Step& first = path.front();
    // The first triangle comes in by either edge that it does not leave by.
    const std::uint8_t out = first.out == kOpen ? std::uint8_t{2} : first.out;
    first.in = static_cast<std::uint8_t>((out + (trial / 2 % 2 == 0 ? 1 : 2)) % 3);
    bool turn = false;
    for (const Step& step : path) {
      const LocalTriangle& t = triangles_[step.triangle];
      if (&step == path.data()) {
        name_vertex(t[step.in]);
        name_vertex(t[(step.in + 1) % 3]);
      }
      name_vertex(t[(step.in + 2) % 3]);
      out_.turns.push_back(turn);
      turn = step.out == (step.in + 1) % 3;
    }
  }

  std::span<const LocalTriangle> triangles_;
  std::span<const std::uint32_t> block_;
  const Adjacency& neighbours_;
  std::uint32_t vertex_count_;
  Strips out_;
  std::vector<bool> used_;
  std::vector<std::uint32_t> number_;  ///< new number of each old vertex
};

}  // namespace

std::uint32_t Strips::bit_count() const {
  const auto strips = static_cast<std::uint32_t>(first_triangle.size());
  const auto triangles = static_cast<std::uint32_t>(turns.size());
  const auto restart_bits = static_cast<std::uint32_t>(std::bit_width(triangles - 1U));
  return triangles + static_cast<std::uint32_t>(slots.size()) + (strips - 1U) * restart_bits +
         static_cast<std::uint32_t>(references.size()) * reference_bits;
}

Strips make_strips(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block,
                   std::uint32_t vertex_count, const StripOptions& options) {
  assert(!triangles.empty() && triangles.size() == block.size());
  const Adjacency neighbours = find_neighbours(triangles, block);
  Striper striper(triangles, block, neighbours, vertex_count);
  Strips best;
  for (std::uint32_t trial = 0; trial < options.trials; ++trial) {
    Strips strips = striper.run(trial);
    if (trial == 0 || strips.bit_count() < best.bit_count()) best = std::move(strips);
  }
  return best;
}

}  // namespace meshlode
