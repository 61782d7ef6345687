// SPDX-License-Identifier: GPL-3.0-or-later
// Generalised strips are paths in the graph of triangles that share an edge: each step leaves through one of the two
// edges that it did not come in by. A cluster is covered with few paths, greedily (the neighbour with the fewest ways
// out first, as Akeley's tomesh did), and a path's far ends near what was used last, so that references stay short.
// Several covers are tried with different tie breaks; the one with the fewest bits stays. (Strips with fan bits and
// reuse references: Kuth et al. 2024, Towards Practical Meshlet Compression.)
#include "builder/encode/strips.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include <meshlode/format.h>

namespace meshlode::builder {

namespace {

constexpr std::size_t kMaxTriangles = format::kMaxClusterTriangles;
constexpr std::size_t kMaxVertices = format::kMaxClusterVertices;
constexpr std::uint16_t kNobody = kMaxTriangles;  ///< as a triangle: a place in the tables that is never free
constexpr std::uint16_t kNotNumbered = 0xFFFFU;

/// Across edge e (corner e to corner e + 1) of a triangle: the triangle that has the edge the other way round.
struct Neighbour {
  std::uint16_t triangle;  ///< kNobody: none
  std::uint8_t edge;
};

/// What all trials at one cluster look at. Tables as large as a cluster can be, on the stack: nothing is allocated.
struct Surface {
  std::span<const LocalTriangle> triangles;
  std::array<std::array<Neighbour, 3>, kMaxTriangles> neighbours;
  std::array<std::uint8_t, kMaxTriangles> degree;          ///< neighbours
  std::array<std::uint16_t, kMaxTriangles> block_end;      ///< where the block of a triangle ends
  std::array<std::uint16_t, kMaxTriangles> blocks_behind;  ///< blocks after that of a triangle
  std::array<std::uint16_t, kMaxVertices + 1> first_use;   ///< of each vertex, in uses
  std::array<std::uint16_t, 3 * kMaxTriangles> uses;       ///< triangles
  std::uint32_t vertex_count = 0;
};

void find_uses(Surface& surface) {
  std::array<std::uint16_t, kMaxVertices + 1> next{};
  for (const LocalTriangle& t : surface.triangles) {
    for (const std::uint8_t v : t) ++next[v + std::size_t{1}];
  }
  for (std::size_t v = 0; v < surface.vertex_count; ++v) {
    next[v + 1] = static_cast<std::uint16_t>(next[v + 1] + next[v]);
  }
  surface.first_use = next;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const std::uint8_t v : surface.triangles[t]) surface.uses[next[v]++] = static_cast<std::uint16_t>(t);
  }
}

/// Half edges as numbers that sort by block, greater vertex, direction, triangle and edge.
namespace half_edge {
constexpr std::uint32_t make(std::uint32_t block, std::uint32_t a, std::uint32_t b, std::size_t triangle,
                             std::size_t edge) {
  return block << 19U | std::max(a, b) << 11U | (a > b ? 1U : 0U) << 10U | static_cast<std::uint32_t>(triangle) << 2U |
         static_cast<std::uint32_t>(edge);
}
constexpr std::uint32_t undirected(std::uint32_t key) {
  return key >> 11U;
}
constexpr bool is_descending(std::uint32_t key) {
  return (key >> 10U & 1U) != 0;
}
constexpr std::uint16_t triangle(std::uint32_t key) {
  return static_cast<std::uint16_t>(key >> 2U & 0xFFU);
}
constexpr std::uint8_t edge(std::uint32_t key) {
  return static_cast<std::uint8_t>(key & 3U);
}
static_assert(kMaxTriangles <= 256 && kMaxVertices <= 256);
}  // namespace half_edge

/// Half edges of one smaller vertex, sorted: those of one edge meet in pairs, as far as they go.
void join(Surface& surface, std::span<const std::uint32_t> edges) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    std::size_t split = i;  // first descending one
    for (; end < edges.size() && half_edge::undirected(edges[end]) == half_edge::undirected(edges[i]); ++end) {
      if (!half_edge::is_descending(edges[end])) split = end + 1;
    }
    for (std::size_t k = 0; i + k < split && split + k < end; ++k) {
      const std::uint32_t a = edges[i + k], b = edges[split + k];
      const std::uint16_t ta = half_edge::triangle(a), tb = half_edge::triangle(b);
      if (ta == tb) continue;
      surface.neighbours[ta][half_edge::edge(a)] = {tb, half_edge::edge(b)};
      surface.neighbours[tb][half_edge::edge(b)] = {ta, half_edge::edge(a)};
      ++surface.degree[ta];
      ++surface.degree[tb];
    }
    i = end;
  }
}

/// After find_blocks.
void find_neighbours(Surface& surface) {
  const std::size_t count = surface.triangles.size();
  constexpr Neighbour kNone{kNobody, 0};
  std::fill_n(surface.neighbours.begin(), count, std::array{kNone, kNone, kNone});
  std::fill_n(surface.degree.begin(), count, std::uint8_t{0});
  // By the smaller vertex first, which leaves a handful to sort.
  std::array<std::uint16_t, kMaxVertices + 1> first{};
  for (const LocalTriangle& t : surface.triangles) {
    for (std::size_t e = 0; e < 3; ++e) ++first[std::min(t[e], t[(e + 1) % 3]) + std::size_t{1}];
  }
  for (std::size_t v = 0; v < surface.vertex_count; ++v) {
    first[v + 1] = static_cast<std::uint16_t>(first[v + 1] + first[v]);
  }
  std::array<std::uint16_t, kMaxVertices + 1> end = first;
  std::array<std::uint32_t, 3 * kMaxTriangles> edges;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = surface.triangles[t][e], b = surface.triangles[t][(e + 1) % 3];
      if (a != b) edges[end[std::min(a, b)]++] = half_edge::make(surface.blocks_behind[t], a, b, t, e);
    }
  }
  for (std::size_t v = 0; v < surface.vertex_count; ++v) {
    std::sort(edges.begin() + first[v], edges.begin() + end[v]);
    join(surface, std::span(edges).subspan(first[v], std::size_t{end[v]} - first[v]));
  }
}

void find_blocks(Surface& surface, std::span<const std::uint32_t> block) {
  std::uint16_t behind = 0;
  for (std::size_t t = block.size(); t-- > 0;) {
    const bool is_last = t + 1 == block.size() || block[t] != block[t + 1];
    if (is_last && t + 1 < block.size()) ++behind;
    surface.block_end[t] = is_last ? static_cast<std::uint16_t>(t + 1) : surface.block_end[t + 1];
    surface.blocks_behind[t] = behind;
  }
}

/// A small generator of its own: the same sequence everywhere (I10).
class Coin {
 public:
  constexpr explicit Coin(std::uint32_t seed) : state_(seed * 2654435761U + 12345U) {}
  constexpr std::uint32_t next() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return state_;
  }

 private:
  std::uint32_t state_;
};

using Ties = std::array<std::uint8_t, kMaxTriangles>;

constexpr Ties toss(std::uint32_t trial, std::size_t count = kMaxTriangles) {
  Ties ties{};
  Coin coin(trial + 1);
  for (std::size_t t = 0; t < count; ++t) ties[t] = static_cast<std::uint8_t>(coin.next() >> 24U);
  return ties;
}
/// The same for every cluster: those of the usual trials are made once.
constexpr std::array<Ties, 8> kFirstTies{toss(0), toss(1), toss(2), toss(3), toss(4), toss(5), toss(6), toss(7)};

struct Step {
  std::uint16_t triangle;
  std::uint8_t in, out;  ///< edges; equal to kOpen at the ends
};
constexpr std::uint8_t kOpen = 3;

std::uint32_t count_bits(std::size_t triangles, std::size_t strips, std::size_t slots, std::size_t references,
                         std::uint32_t reference_bits) {
  const auto restart_bits = static_cast<std::size_t>(std::bit_width(triangles - 1U));
  return static_cast<std::uint32_t>(triangles + slots + (strips - 1U) * restart_bits + references * reference_bits);
}

/// What a trial leaves: the arrays of Strips, without their allocations.
struct Cover {
  std::array<std::uint16_t, kMaxTriangles> first_triangle;
  std::array<std::uint8_t, kMaxTriangles> turns;
  std::array<std::uint8_t, 3 * kMaxTriangles> slots;
  std::array<std::uint8_t, kMaxVertices> vertex_order;
  std::array<std::uint8_t, 3 * kMaxTriangles> references;
  std::size_t strip_count = 0, triangle_count = 0, slot_count = 0, vertex_count = 0, reference_count = 0;
  std::uint32_t largest_reference = 0;

  void clear() {
    strip_count = triangle_count = slot_count = vertex_count = reference_count = 0;
    largest_reference = 0;
  }
  [[nodiscard]] std::uint32_t reference_bits() const {
    return std::max(1U, static_cast<std::uint32_t>(std::bit_width(largest_reference)));
  }
  [[nodiscard]] std::uint32_t bit_count() const {
    return count_bits(triangle_count, strip_count, slot_count, reference_count, reference_bits());
  }
};

/// A triangle as choices see it, in one number: is it in a path, how many neighbours are in none, the number of its
/// vertex that was named first, and what decides between equals, another in every trial. The least is taken: fewest
/// ways out first, or what was left behind longest, because that makes the longest references.
namespace choice {
constexpr std::uint32_t kUsed = 1U << 31U;
constexpr std::uint32_t kDegree = 1U << 26U;
constexpr std::uint32_t kOldestShift = 10;  ///< 16 bits; all ones: none of its vertices is named
constexpr std::uint32_t kOldest = 0xFFFFU << kOldestShift;
constexpr std::uint32_t kTieShift = 2;  ///< 8 bits. Two bits are left for the edge that a choice is about.
constexpr std::uint32_t kNever = ~0U;   ///< beyond an open edge

constexpr std::uint32_t start(std::uint32_t degree, std::uint32_t tie) {
  return degree * kDegree | kOldest | tie << kTieShift;
}
constexpr bool is_free(std::uint32_t key) {
  return key < kUsed;
}
constexpr std::uint32_t oldest(std::uint32_t key) {
  return key & kOldest;
}
constexpr std::uint32_t named(std::uint32_t key, std::uint32_t number) {
  return std::min(key, (key & ~kOldest) | number << kOldestShift);
}
constexpr std::uint32_t by_age(std::uint32_t key) {
  return (key & (kUsed | kOldest)) | (key >> 18U & 0x300U) | (key >> kTieShift & 0xFFU);
}
}  // namespace choice

/// Everything that choices look at is kept up to date instead of computed: there are many more looks than changes, and
/// the trials are most of what encoding takes.
class Striper {
 public:
  explicit Striper(const Surface& surface) : surface_(surface) {}

  /// False: the cover has no fewer bits than `limit`, and is not finished.
  bool run(std::uint32_t trial, std::uint32_t limit, Cover& out) {
    start(trial, out);
    const std::size_t count = surface_.triangles.size();
    for (std::size_t begin = 0; begin < count; begin = surface_.block_end[begin]) {
      const std::size_t end = surface_.block_end[begin];
      for (std::size_t done = begin; done < end;) {
        // The path to come and one for each block behind it are the least that is missing.
        if (least_bits(out.strip_count + 1U + surface_.blocks_behind[begin]) >= limit) return false;
        find_path(begin, end, trial);
        emit(trial);
        done += path_end_;
      }
    }
    return least_bits(out.strip_count) < limit;
  }

 private:
  void start(std::uint32_t trial, Cover& out) {
    out_ = &out;
    out.clear();
    const Ties ties = trial < kFirstTies.size() ? kFirstTies[trial] : toss(trial, surface_.triangles.size());
    std::fill_n(number_.begin(), surface_.vertex_count, kNotNumbered);
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      key_[t] = choice::start(surface_.degree[t], ties[t]);
    }
    key_[kNobody] = choice::kNever;
  }

  /// Bits of a cover of so many strips, with references that are not longer than those so far.
  [[nodiscard]] std::uint32_t least_bits(std::size_t strips) const {
    const std::size_t triangles = surface_.triangles.size();
    const std::size_t slots = std::max<std::size_t>(triangles + 2 * strips, surface_.vertex_count);
    return count_bits(triangles, strips, slots, slots - surface_.vertex_count, out_->reference_bits());
  }

  void use(std::size_t t) {
    key_[t] |= choice::kUsed;
    for (const Neighbour n : surface_.neighbours[t]) key_[n.triangle] -= choice::kDegree;
    key_[kNobody] = choice::kNever;
  }

  [[nodiscard]] std::size_t choose_start(std::size_t begin, std::size_t end, std::uint32_t trial) const {
    const auto age_of = [](std::uint32_t key) { return choice::by_age(key); };
    const auto as_it_is = [](std::uint32_t key) { return key; };
    const std::size_t best = trial % 2 == 0 ? find_least(begin, end, as_it_is) : find_least(begin, end, age_of);
    assert(choice::is_free(key_[best]));
    return best;
  }

  /// The first of the least: in two loops, the long one of which has no branch.
  template <class Value>
  [[nodiscard]] std::size_t find_least(std::size_t begin, std::size_t end, const Value& value_of) const {
    std::uint32_t least = choice::kNever;
    for (std::size_t t = begin; t < end; ++t) least = std::min(least, value_of(key_[t]));
    std::size_t best = begin;
    while (value_of(key_[best]) != least) ++best;
    return best;
  }

  /// The edge to leave `t` by. Whence a path came is in use, and no choice.
  [[nodiscard]] std::uint8_t choose_exit(std::size_t t) const {
    const std::array<Neighbour, 3>& neighbours = surface_.neighbours[t];
    std::uint32_t best = choice::kNever;
    for (std::uint32_t e = 0; e < 3; ++e) best = std::min(best, key_[neighbours[e].triangle] | e);
    return choice::is_free(best) ? static_cast<std::uint8_t>(best & 3U) : kOpen;
  }

  /// Appends to the path.
  void walk(std::size_t t, std::uint8_t in) {
    while (true) {
      use(t);
      const std::uint8_t out = choose_exit(t);
      path_[path_end_++] = {static_cast<std::uint16_t>(t), in, out};
      if (out == kOpen) return;
      const Neighbour next = surface_.neighbours[t][out];
      t = next.triangle;
      in = next.edge;
    }
  }

  void turn_path() {
    std::reverse(path_.begin(), path_.begin() + path_end_);
    for (std::size_t i = 0; i < path_end_; ++i) std::swap(path_[i].in, path_[i].out);
  }

  void find_path(std::size_t begin, std::size_t end, std::uint32_t trial) {
    path_end_ = 0;
    const std::size_t first = choose_start(begin, end, trial);
    walk(first, kOpen);
    // The other way from the start, as far as it goes.
    const std::uint8_t back = choose_exit(first);
    if (back == kOpen) return;
    path_.front().in = back;
    turn_path();
    walk(surface_.neighbours[first][back].triangle, surface_.neighbours[first][back].edge);
  }

  void name_vertex(std::uint8_t v) {
    Cover& out = *out_;
    out.slots[out.slot_count++] = v;
    const auto fresh = static_cast<std::uint32_t>(out.vertex_count);
    if (number_[v] != kNotNumbered) {
      const std::uint32_t distance = fresh - 1U - number_[v];
      out.references[out.reference_count++] = static_cast<std::uint8_t>(distance);
      out.largest_reference = std::max(out.largest_reference, distance);
      return;
    }
    number_[v] = static_cast<std::uint16_t>(fresh);
    out.vertex_order[out.vertex_count++] = v;
    for (std::size_t i = surface_.first_use[v]; i < surface_.first_use[v + std::size_t{1}]; ++i) {
      std::uint32_t& key = key_[surface_.uses[i]];
      key = choice::named(key, fresh);
    }
  }

  void emit(std::uint32_t trial) {
    Cover& out = *out_;
    // From whichever end has the older vertices.
    const auto age_of = [&](const Step& step) { return choice::oldest(key_[step.triangle]); };
    if (age_of(path_[path_end_ - 1]) < age_of(path_.front())) turn_path();
    out.first_triangle[out.strip_count++] = static_cast<std::uint16_t>(out.triangle_count);
    Step& first = path_.front();
    // The first triangle comes in by either edge that it does not leave by.
    const std::uint8_t leave = first.out == kOpen ? std::uint8_t{2} : first.out;
    first.in = static_cast<std::uint8_t>((leave + (trial / 2 % 2 == 0 ? 1 : 2)) % 3);
    name_vertex(surface_.triangles[first.triangle][first.in]);
    name_vertex(surface_.triangles[first.triangle][(first.in + 1) % 3]);
    bool turn = false;
    for (const Step& step : std::span(path_).first(path_end_)) {
      name_vertex(surface_.triangles[step.triangle][(step.in + 2) % 3]);
      out.turns[out.triangle_count++] = turn ? 1 : 0;
      turn = step.out == (step.in + 1) % 3;
    }
  }

  const Surface& surface_;
  std::array<std::uint32_t, kMaxTriangles + 1> key_;  ///< see choice; of kNobody: kNever
  std::array<std::uint16_t, kMaxVertices> number_;    ///< new number of each old vertex
  std::array<Step, kMaxTriangles> path_;
  std::size_t path_end_ = 0;
  Cover* out_ = nullptr;
};

Strips to_strips(const Cover& cover) {
  Strips out;
  out.first_triangle.assign(cover.first_triangle.begin(), cover.first_triangle.begin() + cover.strip_count);
  out.turns.assign(cover.turns.begin(), cover.turns.begin() + cover.triangle_count);
  out.slots.assign(cover.slots.begin(), cover.slots.begin() + cover.slot_count);
  out.vertex_order.assign(cover.vertex_order.begin(), cover.vertex_order.begin() + cover.vertex_count);
  out.references.assign(cover.references.begin(), cover.references.begin() + cover.reference_count);
  out.reference_bits = cover.reference_bits();
  return out;
}

}  // namespace

std::uint32_t Strips::bit_count() const {
  return count_bits(turns.size(), first_triangle.size(), slots.size(), references.size(), reference_bits);
}

Strips make_strips(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block,
                   std::uint32_t vertex_count, const StripOptions& options) {
  assert(!triangles.empty() && triangles.size() == block.size());
  assert(triangles.size() <= kMaxTriangles && vertex_count <= kMaxVertices);
  Surface surface;
  surface.triangles = triangles;
  surface.vertex_count = vertex_count;
  find_uses(surface);
  find_blocks(surface, block);
  find_neighbours(surface);
  Striper striper(surface);
  std::array<Cover, 2> covers;
  Cover* best = &covers[0];
  Cover* tried = &covers[1];
  std::uint32_t best_bits = ~0U;
  for (std::uint32_t trial = 0; trial < options.trials; ++trial) {
    if (!striper.run(trial, best_bits, *tried)) continue;
    std::swap(best, tried);
    best_bits = best->bit_count();
  }
  return to_strips(*best);
}

}  // namespace meshlode::builder
