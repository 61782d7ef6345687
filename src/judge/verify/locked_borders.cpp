// SPDX-License-Identifier: GPL-3.0-or-later
// A group's coarser set must have the border vertices that its finer set has. Then a cut has those that level 0 has:
// going from level 0 to the cut by one group after the other, none is lost. Vertices count where a triangle has them
// that has three different corners on the grid: where the grid collapsed all of a vertex's triangles, level 0 draws
// nothing there, and coarser levels have no such triangles (L508).
#include "judge/verify/locked_borders.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "base/random.h"

namespace meshlode::judge {

namespace {

constexpr std::uint32_t kRandomCuts = 16;

bool precedes(const Vec3d& p, const Vec3d& q) {
  return std::tuple(p.x, p.y, p.z) < std::tuple(q.x, q.y, q.z);
}

using PointPair = std::pair<std::uint32_t, std::uint32_t>;

/// The ends of edges that are there once. `edges` are sorted.
std::vector<std::uint32_t> ends_of_single(const std::vector<PointPair>& edges) {
  std::vector<std::uint32_t> ends;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool is_single = (i == 0 || edges[i] != edges[i - 1]) && (i + 1 == edges.size() || edges[i] != edges[i + 1]);
    if (!is_single) continue;
    ends.push_back(edges[i].first);
    ends.push_back(edges[i].second);
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

class LockedBorder {
 public:
  LockedBorder(const run::Asset& asset, const MeshSurface& surface, const std::vector<GridPoint>& border, RuleLog& log)
      : asset_(asset), surface_(surface), log_(log), is_border_(surface.positions.size(), 0) {
    for (const GridPoint& point : border) mark(point);
    for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
      of_cluster_.push_back(border_of(c));
      if (own_group(c) == format::kNone) level0_.push_back(c);
    }
    finer_.resize(surface.group_count);
    for (std::uint32_t c = 0; c < surface.cluster_count; ++c) finer_[coarser_group(c)].push_back(c);
  }

  void check_groups(LockedTotals& totals) {
    for (std::uint32_t g = 0; g < surface_.group_count; ++g) {
      if (is_terminal(g)) continue;
      ++totals.groups;
      report_missing(in(finer_[g]), in(surface_.made[g]),
                     [&] { return place("mesh", surface_.mesh.value, "group", surface_.first_group + g); });
    }
  }

  void check_random_cuts(LockedTotals& totals) {
    const std::vector<std::uint32_t> all = in(level0_);
    SplitMix64 random(1);
    for (std::uint32_t i = 0; i < kRandomCuts; ++i) {
      ++totals.cuts;
      report_missing(all, in(random_cut(random, (i + 1.0) / kRandomCuts)),
                     [&] { return place("mesh", surface_.mesh.value, "random cut", i); });
    }
  }

 private:
  void mark(const GridPoint& point) {
    const auto precedes_point = [](const Vec3i& p, const GridPoint& q) { return GridPoint{p.x, p.y, p.z} < q; };
    const auto found = std::lower_bound(surface_.positions.begin(), surface_.positions.end(), point, precedes_point);
    const bool is_there =
        found != surface_.positions.end() && GridPoint{found->x, found->y, found->z} == point;  // or V101 says so
    if (is_there) is_border_[static_cast<std::size_t>(found - surface_.positions.begin())] = 1;
  }

  [[nodiscard]] const format::ClusterRecord& record(std::uint32_t c) const {
    return asset_.clusters()[surface_.first_cluster + c];
  }
  /// Of the mesh, or kNone.
  [[nodiscard]] std::uint32_t own_group(std::uint32_t c) const {
    const std::uint32_t group = record(c).own_group;
    return group == format::kNone ? group : group - surface_.first_group;
  }
  [[nodiscard]] std::uint32_t coarser_group(std::uint32_t c) const {
    return record(c).coarser_group - surface_.first_group;
  }
  [[nodiscard]] bool is_terminal(std::uint32_t g) const {
    return (asset_.groups()[surface_.first_group + g].flags & format::kGroupTerminal) != 0;
  }

  [[nodiscard]] std::vector<std::uint32_t> border_of(std::uint32_t c) const {
    std::vector<std::uint32_t> found;
    const std::uint32_t* position = &surface_.vertex_position[surface_.first_vertex[c]];
    for (const auto& t : surface_.triangles(c)) {
      const std::array<std::uint32_t, 3> p{position[t[0]], position[t[1]], position[t[2]]};
      if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
      for (const std::uint32_t corner : p) {
        if (is_border_[corner] != 0) found.push_back(corner);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// The border vertices of clusters, ascending.
  [[nodiscard]] std::vector<std::uint32_t> in(std::span<const std::uint32_t> clusters) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t c : clusters) found.insert(found.end(), of_cluster_[c].begin(), of_cluster_[c].end());
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Groups from fine to coarse (L301 to L306), each replaced by chance once all that it stands on are.
  [[nodiscard]] std::vector<std::uint32_t> random_cut(SplitMix64& random, double share) const {
    std::vector<std::uint8_t> is_replaced(surface_.group_count, 0);
    const auto is_reached = [&](std::uint32_t c) {
      return own_group(c) == format::kNone || is_replaced[own_group(c)] != 0;
    };
    for (std::uint32_t g = surface_.group_count; g-- > 0;) {
      const bool may_be = !is_terminal(g) && std::all_of(finer_[g].begin(), finer_[g].end(), is_reached);
      is_replaced[g] = random.chance(share) && may_be ? 1 : 0;
    }
    std::vector<std::uint32_t> drawn;
    for (std::uint32_t c = 0; c < surface_.cluster_count; ++c) {
      if (is_reached(c) && is_replaced[coarser_group(c)] == 0) drawn.push_back(c);
    }
    return drawn;
  }

  template <class Where>
  void report_missing(const std::vector<std::uint32_t>& wanted, const std::vector<std::uint32_t>& there,
                      const Where& where) {
    std::vector<std::uint32_t> missing;
    std::set_difference(wanted.begin(), wanted.end(), there.begin(), there.end(), std::back_inserter(missing));
    log_.expect(missing.empty(), Rule::kV114, where, [&] {
      return std::to_string(missing.size()) + " of " + std::to_string(wanted.size()) +
             " vertices of the locked border are missing, the first at " + position_text(surface_, missing.front());
    });
  }

  const run::Asset& asset_;
  const MeshSurface& surface_;
  RuleLog& log_;
  std::vector<std::uint8_t> is_border_;  ///< per position
  std::vector<std::vector<std::uint32_t>> of_cluster_, finer_;
  std::vector<std::uint32_t> level0_;
};

}  // namespace

std::vector<Vec3d> find_open_border(const TriangleCorners& drawn) {
  std::vector<Vec3d> places;
  places.reserve(3 * drawn.size());
  for (std::size_t t = 0; t < drawn.size(); ++t) {
    for (const Vec3d& corner : drawn[t]) places.push_back(corner);
  }
  std::sort(places.begin(), places.end(), precedes);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const auto name_of = [&](const Vec3d& p) {
    return static_cast<std::uint32_t>(std::lower_bound(places.begin(), places.end(), p, precedes) - places.begin());
  };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t t = 0; t < drawn.size(); ++t) {
    const auto [p, q, r] = drawn[t];
    const std::uint32_t a = name_of(p), b = name_of(q), c = name_of(r);
    triangles.push_back(std::min({std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}));
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  std::vector<PointPair> edges;
  for (const auto& [a, b, c] : triangles) {
    for (const auto& [from, to] : {PointPair(a, b), PointPair(b, c), PointPair(c, a)})
      edges.emplace_back(std::minmax(from, to));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Vec3d> border;
  for (const std::uint32_t end : ends_of_single(edges)) border.push_back(places[end]);
  return border;
}

void check_locked_border(const run::Asset& asset, const MeshSurface& surface, const std::vector<GridPoint>& border,
                         LockedTotals& totals, RuleLog& log) {
  log.check(Rule::kV114);
  ++totals.meshes;
  totals.vertices += border.size();
  LockedBorder locked(asset, surface, border, log);
  locked.check_groups(totals);
  locked.check_random_cuts(totals);
}

}  // namespace meshlode::judge
