// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/surface_bracket.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "judge/metrics/bracket_search.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kTrianglesAtOnce = 256;
constexpr std::size_t kPiecesAtOnce = 1024;  // of those that are open the farthest, or a quarter

/// Triangles near to all vertices that the triangles use.
std::vector<std::uint32_t> find_nearest(const Surface& a, std::span<const std::uint32_t> triangles,
                                        const TriangleTree& tree, double enough, BracketFound& found) {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> near(a.positions.size(), kNoId);
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t v : a.triangles[t]) {
      if (near[v] != kNoId) continue;
      near[v] = 0;
      order.push_back(v);
    }
  }
  std::vector<BracketFound> parts(chunk_count(order.size(), kTrianglesAtOnce));
  parallel_for_each_chunk(order.size(), kTrianglesAtOnce, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::uint32_t hint = kNoId;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3d& p = a.positions[order[i]];
      const NearestPoint nearest = tree.near_enough(enough * enough, p, hint);
      near[order[i]] = hint = nearest.triangle;
      if (nearest.is_nearest) parts[chunk].meet(std::sqrt(nearest.distance2), p);
    }
  });
  for (const BracketFound& part : parts) found.add(part);
  return near;
}

/// Looks at `count` pieces, each with its share of what is left of the budget: what is open of them is left in `found`.
template <class PieceAt>
std::vector<NearParts> look_at_all(std::size_t count, const PieceAt& piece_at, const BracketTarget& b, double enough,
                                   std::uint64_t budget, BracketFound& found) {
  const std::uint64_t most = budget > found.splits ? 1 + (budget - found.splits) / count : 0;
  std::vector<BracketFound> parts(chunk_count(count, kTrianglesAtOnce));
  std::vector<NearParts> near(count);
  parallel_for_each_chunk(count, kTrianglesAtOnce, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    BracketSearch search(b, enough);
    for (std::size_t i = begin; i < end; ++i) near[i] = search.look_at(piece_at(i, search), most, parts[chunk]);
  });
  for (const BracketFound& part : parts) found.add(part);
  return near;
}

/// Takes the farthest of them.
std::vector<BracketPiece> take_farthest(std::vector<BracketPiece>& open) {
  std::stable_sort(open.begin(), open.end(),
                   [](const BracketPiece& p, const BracketPiece& q) { return p.upper > q.upper; });
  const auto end =
      open.begin() + static_cast<std::ptrdiff_t>(std::min(open.size(), std::max(kPiecesAtOnce, open.size() / 4)));
  std::vector<BracketPiece> taken(open.begin(), end);
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
  BracketFound found;
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
    std::erase_if(found.open, [&](const BracketPiece& p) { return p.upper <= enough; });
    if (found.open.empty() || found.splits >= options.budget) break;
    std::vector<BracketPiece> taken = take_farthest(found.open);
    const auto taken_at = [&](std::size_t i, const BracketSearch& search) {
      search.renew(taken[i]);
      return taken[i];
    };
    (void)look_at_all(taken.size(), taken_at, b, enough, options.budget, found);
  }
  out.lower = std::max(0.0, found.lower);
  out.worst = found.worst;
  out.upper = std::max(out.lower, enough);
  for (const BracketPiece& piece : found.open) out.upper = std::max(out.upper, piece.upper);
  out.undecided = found.open.size();
  out.splits = found.splits;
  return out;
}

}  // namespace meshlode::judge
