// SPDX-License-Identifier: GPL-3.0-or-later
// Generalised strips are paths in the graph of triangles that share an edge: each step leaves through one of the two
// edges that it did not come in by. A cluster is covered with few paths, greedily (the neighbour with the fewest ways
// out first, as Akeley's tomesh did), and a path's far ends near what was used last, so that references stay short.
// Several covers are tried with different tie breaks; the one with the fewest bits stays. (Strips with fan bits and
// reuse references: Kuth et al. 2024, Towards Practical Meshlet Compression.)
#include "build/encode/strips.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <tuple>

namespace meshlode::build {

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
    for (; end < edges.size() && edges[end].block == edges[i].block && edges[end].low_high == edges[i].low_high;
         ++end) {
      if (!edges[end].is_descending) split = end + 1;
    }
    for (std::size_t k = 0; i + k < split && split + k < end;
         ++k) {  // where more than two meet: pairs, as far as they go
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

/// What a trial leaves: the arrays of Strips, without their allocations.
struct Cover {
  std::vector<std::uint32_t> first_triangle;
  std::vector<std::uint8_t> turns, slots, vertex_order;
  std::vector<std::uint32_t> references;
  std::uint32_t reference_bits = 1;

  void clear() {
    first_triangle.clear();
    turns.clear();
    slots.clear();
    vertex_order.clear();
    references.clear();
    reference_bits = 1;
  }
};

std::uint32_t count_bits(std::size_t triangles, std::size_t strips, std::size_t slots, std::size_t references,
                         std::uint32_t reference_bits) {
  const auto restart_bits = static_cast<std::size_t>(std::bit_width(triangles - 1U));
  return static_cast<std::uint32_t>(triangles + slots + (strips - 1U) * restart_bits + references * reference_bits);
}
std::uint32_t count_bits(const Cover& cover) {
  return count_bits(cover.turns.size(), cover.first_triangle.size(), cover.slots.size(), cover.references.size(),
                    cover.reference_bits);
}

/// Everything that choices look at is kept up to date instead of computed: there are many more looks than changes, and
/// the trials are most of what encoding takes.
class Striper {
 public:
  Striper(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block, const Adjacency& neighbours,
          std::uint32_t vertex_count)
      : triangles_(triangles),
        block_(block),
        neighbours_(neighbours),
        vertex_count_(vertex_count),
        first_use_(vertex_count + std::size_t{1}),
        state_(triangles.size()) {
    for (const LocalTriangle& t : triangles) {
      for (const std::uint8_t v : t) ++first_use_[v + std::size_t{1}];
    }
    for (std::size_t v = 0; v < vertex_count; ++v) first_use_[v + 1] += first_use_[v];
    uses_.resize(3 * triangles.size());
    std::vector<std::uint32_t> next = first_use_;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint8_t v : triangles[t]) uses_[next[v]++] = static_cast<std::uint16_t>(t);
    }
  }

  const Cover& run(std::uint32_t trial) {
    start(trial);
    for (std::size_t begin = 0; begin < triangles_.size();) {
      std::size_t end = begin;
      while (end < triangles_.size() && block_[end] == block_[begin]) ++end;
      for (std::size_t done = begin; done < end;) {
        find_path(begin, end, trial);
        emit(trial);
        done += path_.size();
      }
      begin = end;
    }
    for (const std::uint32_t d : out_.references) {
      out_.reference_bits = std::max(out_.reference_bits, static_cast<std::uint32_t>(std::bit_width(d)));
    }
    return out_;
  }

 private:
  /// A triangle as choices see it.
  struct State {
    std::uint16_t oldest;      ///< number of the vertex that was named first; kNobody: none
    std::uint8_t free_degree;  ///< neighbours in no path yet
    std::uint8_t tie;          ///< decides between equals, another in every trial
    bool is_used;

    /// Fewest ways out first, or what was left behind longest: that makes the longest references.
    [[nodiscard]] std::uint32_t by_degree() const {
      return std::uint32_t{free_degree} << 24U | std::uint32_t{oldest} << 8U | tie;
    }
    [[nodiscard]] std::uint32_t by_age() const {
      return std::uint32_t{oldest} << 16U | std::uint32_t{free_degree} << 8U | tie;
    }
  };

  void start(std::uint32_t trial) {
    Coin coin(trial + 1);
    out_.clear();
    number_.assign(vertex_count_, kNobody);
    for (std::size_t t = 0; t < state_.size(); ++t) {
      std::uint8_t degree = 0;
      for (const Neighbour n : neighbours_[t])
        degree = static_cast<std::uint8_t>(degree + (n.triangle != kNobody ? 1 : 0));
      state_[t] = {static_cast<std::uint16_t>(kNobody), degree, static_cast<std::uint8_t>(coin.next() >> 24U), false};
    }
  }

  [[nodiscard]] bool is_free(Neighbour n) const { return n.triangle != kNobody && !state_[n.triangle].is_used; }

  void use(std::size_t t) {
    state_[t].is_used = true;
    for (const Neighbour n : neighbours_[t]) {
      if (n.triangle != kNobody) --state_[n.triangle].free_degree;
    }
  }

  [[nodiscard]] std::size_t choose_start(std::size_t begin, std::size_t end, std::uint32_t trial) const {
    std::size_t best = end;
    std::uint32_t best_key = ~0U;
    for (std::size_t t = begin; t < end; ++t) {
      if (state_[t].is_used) continue;
      const std::uint32_t key = trial % 2 == 0 ? state_[t].by_degree() : state_[t].by_age();
      if (key < best_key) {
        best = t;
        best_key = key;
      }
    }
    return best;
  }

  /// The edge to leave `t` by, other than `in`.
  [[nodiscard]] std::uint8_t choose_exit(std::size_t t, std::uint8_t in) const {
    std::uint8_t best = kOpen;
    std::uint32_t best_key = ~0U;
    for (std::uint8_t e = 0; e < 3; ++e) {
      const Neighbour next = neighbours_[t][e];
      if (e == in || !is_free(next)) continue;
      const std::uint32_t key = state_[next.triangle].by_degree();
      if (key < best_key) {
        best = e;
        best_key = key;
      }
    }
    return best;
  }

  /// Appends to path_.
  void walk(std::size_t t, std::uint8_t in) {
    while (true) {
      use(t);
      const std::uint8_t out = choose_exit(t, in);
      path_.push_back({static_cast<std::uint16_t>(t), in, out});
      if (out == kOpen) return;
      const Neighbour next = neighbours_[t][out];
      t = next.triangle;
      in = next.edge;
    }
  }

  void turn_path() {
    std::reverse(path_.begin(), path_.end());
    for (Step& step : path_) std::swap(step.in, step.out);
  }

  void find_path(std::size_t begin, std::size_t end, std::uint32_t trial) {
    path_.clear();
    const std::size_t first = choose_start(begin, end, trial);
    walk(first, kOpen);
    // The other way from the start, as far as it goes.
    const std::uint8_t back = choose_exit(first, path_.front().out);
    if (back == kOpen) return;
    path_.front().in = back;
    turn_path();
    walk(neighbours_[first][back].triangle, neighbours_[first][back].edge);
  }

  void name_vertex(std::uint8_t v) {
    out_.slots.push_back(v);
    const auto fresh = static_cast<std::uint32_t>(out_.vertex_order.size());
    if (number_[v] != kNobody) {
      out_.references.push_back(fresh - 1U - number_[v]);
      return;
    }
    number_[v] = fresh;
    out_.vertex_order.push_back(v);
    for (std::uint32_t i = first_use_[v]; i < first_use_[v + std::size_t{1}]; ++i) {
      State& state = state_[uses_[i]];
      state.oldest = std::min(state.oldest, static_cast<std::uint16_t>(fresh));
    }
  }

  void emit(std::uint32_t trial) {
    // From whichever end has the older vertices.
    if (state_[path_.back().triangle].oldest < state_[path_.front().triangle].oldest) turn_path();
    out_.first_triangle.push_back(static_cast<std::uint32_t>(out_.turns.size()));
    Step& first = path_.front();
    // The first triangle comes in by either edge that it does not leave by.
    const std::uint8_t out = first.out == kOpen ? std::uint8_t{2} : first.out;
    first.in = static_cast<std::uint8_t>((out + (trial / 2 % 2 == 0 ? 1 : 2)) % 3);
    bool turn = false;
    for (const Step& step : path_) {
      const LocalTriangle& t = triangles_[step.triangle];
      if (&step == path_.data()) {
        name_vertex(t[step.in]);
        name_vertex(t[(step.in + 1) % 3]);
      }
      name_vertex(t[(step.in + 2) % 3]);
      out_.turns.push_back(turn ? 1 : 0);
      turn = step.out == (step.in + 1) % 3;
    }
  }

  std::span<const LocalTriangle> triangles_;
  std::span<const std::uint32_t> block_;
  const Adjacency& neighbours_;
  std::uint32_t vertex_count_;
  std::vector<std::uint32_t> first_use_;  ///< of each vertex, in uses_
  std::vector<std::uint16_t> uses_;       ///< triangles
  std::vector<State> state_;
  std::vector<std::uint32_t> number_;  ///< new number of each old vertex
  std::vector<Step> path_;
  Cover out_;
};

}  // namespace

std::uint32_t Strips::bit_count() const {
  return count_bits(turns.size(), first_triangle.size(), slots.size(), references.size(), reference_bits);
}

Strips make_strips(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block,
                   std::uint32_t vertex_count, const StripOptions& options) {
  assert(!triangles.empty() && triangles.size() == block.size());
  const Adjacency neighbours = find_neighbours(triangles, block);
  Striper striper(triangles, block, neighbours, vertex_count);
  Cover best;
  for (std::uint32_t trial = 0; trial < options.trials; ++trial) {
    const Cover& cover = striper.run(trial);
    if (trial == 0 || count_bits(cover) < count_bits(best)) best = cover;
  }
  Strips out;
  out.first_triangle = std::move(best.first_triangle);
  out.turns.assign(best.turns.begin(), best.turns.end());
  out.slots = std::move(best.slots);
  out.vertex_order = std::move(best.vertex_order);
  out.references = std::move(best.references);
  out.reference_bits = best.reference_bits;
  return out;
}

}  // namespace meshlode::build
