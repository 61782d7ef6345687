// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/surface_bracket.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"

namespace meshlode::judge {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kTrianglesAtOnce = 256;
constexpr std::size_t kPiecesAtOnce = 1024;  // of those that are open the farthest, or a quarter

// Of regula falsi. Most places are found in two; where a surface is flat to the last digits it is all the way to them.
constexpr int kMostSteps = 40;
constexpr std::size_t kMostCandidates = 8;  // triangles that a piece may be near to
// Where large triangles cross, a piece comes to have more candidates than this, and a search in the tree looks at
// thousands of triangles for one that the pieces beside it have met already. Three random scenes of such soups take 24,
// 40 and 60 s for 277, 597 and 140 with 32 of them, 25, 37 and 67 s with 16. With 2, 4 and 6 candidates the first takes
// 17, 19 and 21 s on another day, the bunny 8.4, 8.5 and 8.0.
constexpr std::size_t kFewCandidates = 4, kMet = 32;

/// A part of a triangle.
struct Piece {
  std::array<Vec3d, 3> at;
  std::array<std::uint32_t, kMostCandidates> candidates;  ///< triangles of the other surface
  /// Of each corner: a bit for each candidate that is near enough to it.
  std::array<std::uint8_t, 3> near{};
  std::uint8_t count = 0;
  double upper = kInfinity;  ///< of an open piece
};

struct Found {
  double lower = -1.0;
  Vec3d worst{0.0};
  std::uint64_t splits = 0;
  std::vector<Piece> open;

  void meet(double distance, const Vec3d& at) {
    if (distance > lower) {
      lower = distance;
      worst = at;
    }
  }
  void add(const Found& part) {
    meet(part.lower, part.worst);
    splits += part.splits;
    open.insert(open.end(), part.open.begin(), part.open.end());
  }
};

/// The largest number whose root is not above `distance`: what is compared squared is so as distances are. A corner
/// that was met at a distance is then near enough wherever that is, and each round of a search has something to split.
double square_of(double distance) {
  double square = distance * distance;
  while (std::sqrt(square) > distance) square = std::nextafter(square, 0.0);
  for (double next = square; square < kInfinity && std::sqrt(next) <= distance;) {
    square = next;
    next = std::nextafter(square, kInfinity);
  }
  return square;
}

/// Looks at pieces of one surface, to find whether another is nearer than `known` everywhere.
class BracketSearch {
 public:
  BracketSearch(const BracketTarget& b, double known)
      : b_(b.surface), tree_(b.tree), parts_(b.parts), known_(known), known2_(square_of(known)) {}

  /// A triangle with the nearest triangles of its corners.
  Piece piece_of(const std::array<Vec3d, 3>& at, const std::array<std::uint32_t, 3>& nearest) const {
    Piece piece;
    piece.at = at;
    for (const std::uint32_t k : nearest) add(piece, k);
    return piece;
  }

  /// What is near was asked with another limit.
  void renew(Piece& piece) const {
    piece.near = {};
    for (std::size_t k = 0; k < piece.count; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (is_near(piece.at[c], piece.candidates[k])) piece.near[c] |= static_cast<std::uint8_t>(1U << k);
      }
    }
  }

  /// Splits a piece until all of it is near enough, or `most` splits are done; what is open then is left in `found`.
  NearParts look_at(const Piece& first, std::uint64_t most, Found& found) {
    NearParts near;
    stack_.assign(1, first);
    const std::uint64_t end = found.splits + most;
    while (!stack_.empty()) {
      const Piece piece = stack_.back();
      stack_.pop_back();
      if (const std::uint32_t all = piece.near[0] & piece.near[1] & piece.near[2]; all != 0) {
        near.add(part_of(piece.candidates[first_of(all)]));
        continue;
      }
      // A corner that is near to nothing stays so for as long as `known` is what it is.
      const bool is_far = piece.near[0] == 0 || piece.near[1] == 0 || piece.near[2] == 0;
      if (is_far || found.splits == end) {
        found.open.push_back(piece);
        found.open.back().upper = upper_of(piece);
        near.give_up();
        continue;
      }
      ++found.splits;
      split(piece, found);
    }
    return near;
  }

 private:
  [[nodiscard]] static std::size_t first_of(std::uint32_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits));
  }
  [[nodiscard]] std::uint32_t part_of(std::uint32_t triangle) const { return parts_.empty() ? 0 : parts_[triangle]; }

  [[nodiscard]] double distance2(const Vec3d& p, std::uint32_t k) const {
    const auto& t = b_.triangles[k];
    return distance2_to_triangle(p, b_.positions[t[0]], b_.positions[t[1]], b_.positions[t[2]]);
  }

  [[nodiscard]] bool is_near(const Vec3d& p, std::uint32_t k) const {
    const auto& t = b_.triangles[k];
    return is_near_triangle(p, b_.positions[t[0]], b_.positions[t[1]], b_.positions[t[2]], known2_);
  }

  [[nodiscard]] double upper_of(const Piece& piece) const {
    double least = kInfinity;
    for (std::size_t k = 0; k < piece.count; ++k) {
      double most = 0.0;
      for (const Vec3d& p : piece.at) most = std::max(most, distance2(p, piece.candidates[k]));
      least = std::min(least, most);
    }
    return std::min(piece.upper, std::sqrt(least));
  }

  /// The candidates that are near enough to a point.
  [[nodiscard]] std::uint8_t near_of(const Piece& piece, const Vec3d& p) const {
    std::uint8_t near = 0;
    for (std::size_t k = 0; k < piece.count; ++k) {
      if (is_near(p, piece.candidates[k])) near |= static_cast<std::uint8_t>(1U << k);
    }
    return near;
  }

  /// Adds a candidate, where there is no room in place of one that says least. Returns its place.
  std::size_t add(Piece& piece, std::uint32_t triangle) const {
    std::size_t place = 0;
    while (place < piece.count && piece.candidates[place] != triangle) ++place;
    if (place < piece.count) return place;
    if (place == kMostCandidates) {
      int least = 4;
      for (std::size_t k = 0; k < kMostCandidates; ++k) {
        int corners = 0;
        for (const std::uint8_t near : piece.near) {
          if ((near >> k & 1U) != 0) corners += near == 1U << k ? 4 : 1;  // not a corner's only one
        }
        if (corners >= least) continue;
        least = corners;
        place = k;
      }
    } else {
      ++piece.count;
    }
    piece.candidates[place] = triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      const bool is_in = is_near(piece.at[c], triangle);
      const auto bit = static_cast<std::uint8_t>(1U << place);
      piece.near[c] = static_cast<std::uint8_t>(is_in ? piece.near[c] | bit : piece.near[c] & ~bit);
    }
    return place;
  }

  /// One that is near enough to a point.
  [[nodiscard]] std::uint32_t find_met(const Vec3d& p) const {
    for (std::size_t k = 0; k < std::min(next_met_, kMet); ++k) {
      if (is_near(p, met_[k])) return met_[k];
    }
    return kNoId;
  }

  /// A triangle that is near enough to a point becomes a candidate, or where there is none the nearest.
  std::uint8_t ask(Piece& piece, const Vec3d& p, std::uint32_t hint, Found& found) {
    std::uint32_t triangle = piece.count > kFewCandidates ? find_met(p) : kNoId;
    if (triangle == kNoId) {
      NearestPoint nearest = tree_.any_within(known2_, p, hint);
      if (nearest.triangle == kNoId) {
        nearest = tree_.nearest(p, hint);
        found.meet(std::sqrt(nearest.distance2), p);
      }
      triangle = nearest.triangle;
      met_[next_met_++ % kMet] = triangle;
    }
    add(piece, triangle);
    return near_of(piece, p);
  }

  void split(Piece piece, Found& found) {
    std::size_t edge = 3;
    double longest = -1.0;
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3d way = piece.at[(e + 1) % 3] - piece.at[e];
      const double length2 = glm::dot(way, way);
      if ((piece.near[e] & piece.near[(e + 1) % 3]) != 0 || !(length2 > longest)) continue;
      longest = length2;
      edge = e;
    }
    if (edge == 3) return split_inside(piece, found);
    Vec3d x;
    const std::uint8_t near = cross_edge(piece, edge, x, found);
    put(piece, (edge + 1) % 3, x, near);
    put(piece, edge, x, near);
  }

  /// The part in which x is in place of a corner.
  void put(const Piece& piece, std::size_t corner, const Vec3d& x, std::uint8_t near) {
    stack_.push_back(piece);
    stack_.back().at[corner] = x;
    stack_.back().near[corner] = near;
  }

  /// A point of an edge on which one candidate is near to the one half, and one to the other, if there is one. By
  /// regula falsi (Illinois) on the difference of the distances.
  std::uint8_t cross_edge(Piece& piece, std::size_t edge, Vec3d& x, Found& found) {
    const Vec3d p = piece.at[edge], q = piece.at[(edge + 1) % 3];
    const std::uint32_t of_p = piece.candidates[first_of(piece.near[edge])];
    const std::uint32_t of_q = piece.candidates[first_of(piece.near[(edge + 1) % 3])];
    const auto difference = [&](const Vec3d& at) {
      return std::sqrt(distance2(at, of_p)) - std::sqrt(distance2(at, of_q));
    };
    // Each end is next to its own triangle.
    double low = 0.0, high = 1.0, at_low = -std::sqrt(distance2(p, of_q)), at_high = std::sqrt(distance2(q, of_p));
    bool is_asked = false;
    int side = 0;
    std::uint8_t near = 0;
    for (int step = 0; step < kMostSteps; ++step) {
      double s = at_low < 0.0 && at_high > 0.0 ? low - at_low * (high - low) / (at_high - at_low) : 0.5 * (low + high);
      s = std::clamp(s, low + 0.02 * (high - low), high - 0.02 * (high - low));
      x = p + (q - p) * s;
      near = near_of(piece, x);
      // Again, for `ask` may have put another candidate in the place of one.
      const std::uint8_t of_low = piece.near[edge], of_high = piece.near[(edge + 1) % 3];
      if ((near & of_low) != 0 && (near & of_high) != 0) return near;
      if (near == 0 && !is_asked) {
        const std::uint8_t count = piece.count;
        near = ask(piece, x, of_p, found);
        is_asked = true;
        if (near == 0) return near;
        if (piece.count != count) return near;
        if ((near & piece.near[edge]) != 0 && (near & piece.near[(edge + 1) % 3]) != 0) return near;
      }
      const double f = difference(x);
      if (std::abs(f) < 1e-4 * known_ || high - low < 1e-14) break;
      // What is near says more than which of the two is nearer.
      if ((near & of_low) != 0 || ((near & of_high) == 0 && f < 0.0)) {
        low = s;
        at_low = f;
        if (side == 1) at_high *= 0.5;
        side = 1;
      } else {
        high = s;
        at_high = f;
        if (side == 2) at_low *= 0.5;
        side = 2;
      }
    }
    if (near != 0) x = 0.5 * p + 0.5 * q;  // there is no such place
    return ask(piece, x, of_p, found);
  }

  /// Each edge is near to one triangle, and the whole to none. Seldom.
  void split_inside(Piece& piece, Found& found) {
    const auto& [p, q, r] = piece.at;
    const Vec3d x = (p + q + r) / 3.0;
    std::uint8_t near = near_of(piece, x);
    if (near == 0) near = ask(piece, x, piece.candidates[0], found);
    for (std::size_t c = 0; c < 3; ++c) put(piece, c, x, near);
  }

  const Surface& b_;
  const TriangleTree& tree_;
  std::span<const std::uint32_t> parts_;
  double known_, known2_;
  std::vector<Piece> stack_;
  std::array<std::uint32_t, kMet> met_{};  ///< what searches of the tree found last
  std::size_t next_met_ = 0;
};

/// A triangle so near to a vertex, as a share of what is near enough, will do: where all of a part is smaller than
/// floats of the whole tell apart, the boxes of the tree do not say which is nearest. Random scene 940040 takes 51
/// processor seconds so, and more than 120 with 0; a quarter is no quicker.
constexpr double kNearVertex = 0.0625;

/// Triangles near to all vertices that the triangles use.
std::vector<std::uint32_t> find_nearest(const Surface& a, std::span<const std::uint32_t> triangles,
                                        const TriangleTree& tree, double enough, Found& found) {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> near(a.positions.size(), kNoId);
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t v : a.triangles[t]) {
      if (near[v] != kNoId) continue;
      near[v] = 0;
      order.push_back(v);
    }
  }
  const double near2 = kNearVertex * kNearVertex * enough * enough;
  std::vector<Found> parts(chunk_count(order.size(), kTrianglesAtOnce));
  parallel_for_each_chunk(order.size(), kTrianglesAtOnce, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::uint32_t hint = kNoId;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3d& p = a.positions[order[i]];
      const NearestPoint nearest = tree.near_enough(near2, p, hint);
      near[order[i]] = hint = nearest.triangle;
      if (nearest.distance2 > near2) parts[chunk].meet(std::sqrt(nearest.distance2), p);
    }
  });
  for (const Found& part : parts) found.add(part);
  return near;
}

/// Looks at `count` pieces, each with its share of what is left of the budget: what is open of them is left in `found`.
template <class PieceAt>
std::vector<NearParts> look_at_all(std::size_t count, const PieceAt& piece_at, const BracketTarget& b, double enough,
                                   std::uint64_t budget, Found& found) {
  const std::uint64_t most = budget > found.splits ? 1 + (budget - found.splits) / count : 0;
  std::vector<Found> parts(chunk_count(count, kTrianglesAtOnce));
  std::vector<NearParts> near(count);
  parallel_for_each_chunk(count, kTrianglesAtOnce, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    BracketSearch search(b, enough);
    for (std::size_t i = begin; i < end; ++i) near[i] = search.look_at(piece_at(i, search), most, parts[chunk]);
  });
  for (const Found& part : parts) found.add(part);
  return near;
}

/// Takes the farthest of them.
std::vector<Piece> take_farthest(std::vector<Piece>& open) {
  std::stable_sort(open.begin(), open.end(), [](const Piece& p, const Piece& q) { return p.upper > q.upper; });
  const auto end =
      open.begin() + static_cast<std::ptrdiff_t>(std::min(open.size(), std::max(kPiecesAtOnce, open.size() / 4)));
  std::vector<Piece> taken(open.begin(), end);
  open.erase(open.begin(), end);
  return taken;
}

}  // namespace

void NearParts::add(std::uint32_t part) {
  if (count > kMost) return;
  const auto end = parts.begin() + count;
  if (std::find(parts.begin(), end, part) != end) return;
  if (count < kMost) parts[count] = part;
  ++count;
}

Bracket bracket_one_way(const Surface& a, std::span<const std::uint32_t> triangles, const BracketTarget& b,
                        const BracketOptions& options) {
  Bracket out;
  Found found;
  const std::vector<std::uint32_t> nearest = find_nearest(a, triangles, b.tree, options.enough, found);
  if (triangles.empty()) {
    out.upper = options.enough;
    return out;
  }
  const auto triangle_at = [&](std::size_t i, const BracketSearch& search) {
    const auto& [p, q, r] = a.triangles[triangles[i]];
    return search.piece_of({a.positions[p], a.positions[q], a.positions[r]}, {nearest[p], nearest[q], nearest[r]});
  };
  double enough = options.enough;
  out.near = look_at_all(triangles.size(), triangle_at, b, enough, options.budget, found);
  while (true) {
    if (found.lower > options.enough) enough = found.lower * (1.0 + options.tolerance);
    std::erase_if(found.open, [&](const Piece& p) { return p.upper <= enough; });
    if (found.open.empty() || found.splits >= options.budget) break;
    std::vector<Piece> taken = take_farthest(found.open);
    const auto taken_at = [&](std::size_t i, const BracketSearch& search) {
      search.renew(taken[i]);
      return taken[i];
    };
    (void)look_at_all(taken.size(), taken_at, b, enough, options.budget, found);
  }
  out.lower = std::max(0.0, found.lower);
  out.worst = found.worst;
  out.upper = std::max(out.lower, enough);
  for (const Piece& piece : found.open) out.upper = std::max(out.upper, piece.upper);
  out.undecided = found.open.size();
  out.splits = found.splits;
  return out;
}

}  // namespace meshlode::judge
