// SPDX-License-Identifier: GPL-3.0-or-later
// I6 on open borders, group by group: whatever is collapsed, what another group may share stays, no border comes from
// nowhere and no hole opens. The facts are counted here once more, by maps and by search.
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/border_rule.h"
#include "builder/simplify/simplify.h"
#include "support/border_chain.h"
#include "support/open_surface.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

using test::IntegerMesh;
using test::Random;
using testing_support::Chain;
using testing_support::Point;
using testing_support::point;

using Triangles = std::vector<std::array<Point, 3>>;

template <class Surface>
Triangles triangles_of(const Surface& surface) {
  Triangles out;
  for (const WedgeTriangle& t : surface.triangles) {
    out.push_back({point(surface.positions[surface.wedge_position[t[0]]]),
                   point(surface.positions[surface.wedge_position[t[1]]]),
                   point(surface.positions[surface.wedge_position[t[2]]])});
  }
  return out;
}

Chain border_of(const Triangles& triangles) {
  Chain chain;
  for (const auto& t : triangles) testing_support::add_triangle(chain, t);
  return chain;
}

int count_uses(const Chain& chain) {
  int uses = 0;
  for (const auto& [edge, net] : chain) uses += std::abs(net);
  return uses;
}

/// Groups of the nodes 0 … count - 1 that `neighbours` ties together; the name of each node's group.
std::vector<int> flood(const std::vector<std::vector<std::size_t>>& neighbours) {
  std::vector<int> group(neighbours.size(), -1);
  int count = 0;
  for (std::size_t seed = 0; seed < neighbours.size(); ++seed) {
    if (group[seed] != -1) continue;
    std::vector<std::size_t> open{seed};
    group[seed] = count;
    while (!open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      for (const std::size_t next : neighbours[node]) {
        if (group[next] != -1) continue;
        group[next] = count;
        open.push_back(next);
      }
    }
    ++count;
  }
  return group;
}

int count_holes(const Triangles& triangles) {
  const Chain border = border_of(triangles);
  std::map<Point, std::size_t> ends;
  for (const auto& [edge, net] : border) {
    ends.emplace(edge.first, ends.size());
    ends.emplace(edge.second, ends.size());
  }
  std::vector<std::vector<std::size_t>> along(ends.size());
  for (const auto& [edge, net] : border) {
    along[ends[edge.first]].push_back(ends[edge.second]);
    along[ends[edge.second]].push_back(ends[edge.first]);
  }
  const std::vector<int> part = flood(along);
  const int parts = static_cast<int>(std::set<int>(part.begin(), part.end()).size());

  std::map<std::pair<Point, Point>, std::vector<std::size_t>> on_edge;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      on_edge[std::minmax(triangles[t][k], triangles[t][(k + 1) % 3])].push_back(t);
    }
  }
  std::vector<std::vector<std::size_t>> across(triangles.size());
  for (const auto& [edge, users] : on_edge) {
    if (edge.first == edge.second) continue;
    for (const std::size_t user : users) {
      across[user].push_back(users[0]);
      across[users[0]].push_back(user);
    }
  }
  const std::vector<int> piece = flood(across);
  std::set<int> with_border;
  for (const auto& [edge, net] : border) with_border.insert(piece[on_edge[edge][0]]);
  return count_uses(border) - static_cast<int>(ends.size()) + parts - static_cast<int>(with_border.size());
}

/// A group of the mesh's triangles on one side of a plane; what the other side uses too is locked.
SimplifyInput group_of(const IntegerMesh& mesh, Random& random) {
  SimplifyInput input;
  input.positions = mesh.positions;
  // What lies on one point of the grid is one position, as in the whole build.
  std::map<Point, std::uint32_t> first;
  std::vector<std::uint32_t> name;
  for (std::uint32_t p = 0; p < mesh.positions.size(); ++p)
    name.push_back(first.emplace(testing_support::point(mesh.positions[p]), p).first->second);
  input.is_locked.assign(mesh.positions.size(), 0);
  for (std::uint32_t p = 0; p < mesh.positions.size(); ++p) {
    input.wedge_position.push_back(p);
    input.witnesses.push_back({{mesh.positions[p]}, 1});
  }
  input.is_wedge_shared.assign(mesh.positions.size(), 0);
  const bool is_whole = random.below(3) == 0;
  const std::int64_t limit = static_cast<std::int64_t>(random.below(2 * mesh.triangles.size())) / 2;
  std::vector<std::uint8_t> here(mesh.positions.size(), 0), there(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    const WedgeTriangle triangle{name[c[0]], name[c[1]], name[c[2]]};
    const bool is_here = is_whole || std::cmp_less_equal(t, limit);
    for (const std::uint32_t v : triangle) (is_here ? here : there)[v] = 1;
    if (is_here) input.triangles.push_back(triangle);
  }
  for (std::size_t p = 0; p < here.size(); ++p) input.is_locked[p] = here[p] & there[p];
  input.triangle_material.assign(input.triangles.size(), 0);
  return input;
}

/// What no result may break, in words; empty if nothing.
std::string fault_of(const SimplifyInput& input, const SimplifyResult& result) {
  const Triangles finer = triangles_of(input);
  const Triangles coarser = triangles_of(result);
  for (const auto& t : coarser) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return "two corners in one place";
  }
  const Chain before = border_of(finer);
  const Chain after = border_of(coarser);
  if (before == after) return {};
  std::set<Point> locked;
  for (std::size_t p = 0; p < input.positions.size(); ++p) {
    if (input.is_locked[p] != 0) locked.insert(testing_support::point(input.positions[p]));
  }
  for (const auto& [edge, net] : before) {
    if (locked.count(edge.first) == 0 || locked.count(edge.second) == 0) continue;
    const auto found = after.find(edge);
    const int now = found == after.end() ? 0 : found->second;
    if (now * net < 0 || std::abs(now) < std::abs(net)) return "a shared edge is lost";
  }
  if (count_uses(after) > count_uses(before)) return "more border than before";
  if (count_holes(coarser) > count_holes(finer)) return "more holes than before";
  return {};
}

TEST(OpenBorder, HolesAreLoopsThatGoAroundNoPiece) {
  const Point a{0, 0, 0}, b{9, 0, 0}, c{0, 9, 0}, d{-9, 0, 0}, e{0, -9, 0};
  EXPECT_EQ(count_holes({{a, b, c}}), 0) << "a disc";
  EXPECT_EQ(count_holes({{a, b, c}, {a, d, e}}), 0) << "two that touch";
  const Point b2{3, 1, 0}, c2{1, 3, 0}, a2{1, 1, 0};
  EXPECT_EQ(count_holes({{a, b, b2}, {a, b2, a2}, {b, c, c2}, {b, c2, b2}, {c, a, a2}, {c, a2, c2}}), 1) << "a ring";
  EXPECT_EQ(count_holes({{a, b, c}, {a, c, b}}), 0) << "closed";
}

TEST(OpenBorder, NoCollapseOpensAHoleOrTakesASharedEdge) {
  constexpr int kSeeds = test::kIsSanitized ? 400 : 1500;
  int reduced = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Random random(seed);
    const SimplifyInput input =
        group_of(test::make_open_surface(test::random_surface_options(random, 10), random), random);
    SimplifyOptions options;
    options.target_triangles = static_cast<std::uint32_t>(input.triangles.size() / (1 + random.below(12)));
    options.may_relax_topology = random.below(4) != 0;
    options.may_relax_flips = random.below(3) == 0;
    options.keep_area = random.below(4) == 0;
    const SimplifyResult result = simplify_group(input, options);
    EXPECT_EQ(fault_of(input, result), "") << "seed " << seed;
    EXPECT_TRUE(keeps_border(input, result)) << "seed " << seed;
    reduced += 4 * result.triangles.size() < 3 * input.triangles.size() ? 1 : 0;
  }
  EXPECT_GT(reduced, kSeeds / 2) << "nothing is proven where nothing is collapsed";
}

}  // namespace
}  // namespace meshlode::builder
