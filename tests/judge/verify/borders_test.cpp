// SPDX-License-Identifier: GPL-3.0-or-later
// The border proof on surfaces drawn by hand: what may be exchanged on an open border, and what may not.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "drawn_surface.h"
#include "judge/validate/borders.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::judge {
namespace {

using test::Corner;
using test::Patch;
using test::Triangle;

BorderProof prove(const std::vector<Patch>& finer, const Patch& coarser, const std::vector<Patch>& rest = {}) {
  const run::Asset asset = test::asset_of(finer, coarser, rest);
  const auto clusters = run::decode_all(asset);
  EXPECT_TRUE(clusters.ok());
  return prove_borders(asset, build_surface(asset, MeshId(0U), *clusters));
}

/// A fan around the origin of the plane: the square's rim in `steps` straight pieces per side, oriented upwards.
Patch square(int steps, int size = 8) {
  std::vector<Corner> rim;
  const int d = 2 * size / steps;
  for (int i = 0; i < steps; ++i) rim.push_back({-size + i * d, -size, 0});
  for (int i = 0; i < steps; ++i) rim.push_back({size, -size + i * d, 0});
  for (int i = 0; i < steps; ++i) rim.push_back({size - i * d, size, 0});
  for (int i = 0; i < steps; ++i) rim.push_back({-size, size - i * d, 0});
  Patch patch;
  for (std::size_t i = 0; i < rim.size(); ++i) patch.push_back({Corner{0, 0, 0}, rim[i], rim[(i + 1) % rim.size()]});
  return patch;
}

/// The rest of a closed surface over the square: the same rim, oriented downwards, around a lower point.
Patch lid(int steps, int size = 8) {
  Patch patch = square(steps, size);
  for (Triangle& triangle : patch) {
    triangle[0] = {0, 0, -5};
    std::swap(triangle[1], triangle[2]);
  }
  return patch;
}

/// The surface of asset_of(one patch, one patch), but the finer cluster's border is a path of 3 * `links` edges that,
/// in their order, tie the links from the last to the first: each lower position meets the path as it is so far. The
/// last edge of all hangs on the last link, which sets linked by name have by then put `links` deep. The triangles are
/// nowhere.
MeshSurface path_surface(const run::Asset& asset, std::uint32_t links) {
  MeshSurface surface;
  surface.mesh = MeshId(0U);
  surface.cluster_count = asset.meshes()[0].cluster_count;
  surface.group_count = asset.meshes()[0].group_count;
  for (std::uint32_t i = 0; i < 3 * links + 2; ++i) surface.positions.push_back({static_cast<std::int32_t>(i), 0, 0});
  const auto left = [&](std::uint32_t i) { return links + 2 * (links - 1 - i); };
  for (std::uint32_t i = 0; i < links; ++i) {
    surface.edges.push_back({i, left(i)});
    surface.edges.push_back({i, left(i) + 1});
  }
  surface.edges.push_back({links - 1, 3 * links});
  for (std::uint32_t i = links - 1; i > 0; --i) surface.edges.push_back({left(i) + 1, left(i - 1)});
  surface.edges.push_back({3 * links, 3 * links + 1});
  surface.made.resize(surface.group_count);
  surface.first_vertex.assign(surface.cluster_count + 1, 0);
  surface.vertex_position.assign(256, 0);
  surface.first_use.assign(1, 0);
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const std::uint32_t own = asset.clusters()[c].own_group;
    if (own != format::kNone) {
      surface.made[own].push_back(c);
    } else {
      for (std::uint32_t e = 0; e < surface.edges.size(); ++e) surface.uses.push_back({e, 1});
    }
    surface.first_use.push_back(static_cast<std::uint32_t>(surface.uses.size()));
  }
  return surface;
}

// Components were linked without their sizes and found by recursion, as deep as the path: a file of 5.6 MB overflowed
// the stack.
TEST(BorderProof, APathAsLongAsAFileLikesIsNoDeeperForTheProof) {
  const run::Asset asset = test::asset_of({square(1)}, square(1));
  MeshSurface surface = path_surface(asset, 400000);
  const MeshSurface own = build_surface(asset, MeshId(0U), *run::decode_all(asset));
  surface.first_triangle = own.first_triangle;
  surface.triangle_vertices = own.triangle_vertices;
  ASSERT_TRUE(std::is_sorted(surface.edges.begin(), surface.edges.end()));
  const BorderProof proof = prove_borders(asset, surface);
  EXPECT_EQ(proof.groups, 1U);
  EXPECT_FALSE(proof.border.is_closed);
  EXPECT_TRUE(proof.violations.empty());
}

TEST(BorderProof, TheSameBorderOfAClosedSurfacePasses) {
  Patch coarser = square(4);
  for (Triangle& triangle : coarser) triangle[0] = {1, 1, 3};  // another inside, the same rim
  const BorderProof proof = prove({square(4)}, coarser, {lid(4)});
  EXPECT_TRUE(proof.border.is_closed);
  EXPECT_EQ(proof.groups, 1U);
  EXPECT_TRUE(proof.violations.empty());
}

TEST(BorderProof, ASimplifiedRimOfAClosedSurfaceIsACrack) {
  EXPECT_EQ(prove({square(4)}, square(2), {lid(4)}).violations.size(), 1U);
}

TEST(BorderProof, ATJunctionIsACrackThoughNoGapIsSeen) {
  // The same area to the last point, with a vertex of the rim left out on a straight side.
  EXPECT_EQ(prove({square(2)}, square(1), {lid(2)}).violations.size(), 1U);
}

TEST(BorderProof, ASimplifiedRimOfAnOpenSurfacePasses) {
  const BorderProof proof = prove({square(4)}, square(2));
  EXPECT_FALSE(proof.border.is_closed);
  EXPECT_TRUE(proof.violations.empty());
}

TEST(BorderProof, AnOpenRimMayVanish) {
  // Only a far piece of two is left: the rim of the other went with it.
  Patch two = square(2);
  Patch far = square(1, 4);
  for (Triangle& triangle : far) {
    for (Corner& c : triangle) c[0] += 100;
  }
  two.insert(two.end(), far.begin(), far.end());
  EXPECT_TRUE(prove({two}, far).violations.empty());
}

TEST(BorderProof, AnOpenRimMayMoveAsAWhole) {
  EXPECT_TRUE(prove({square(4)}, square(2, 7)).violations.empty());
}

TEST(BorderProof, ARimThatMovesDoesNotHideAHole) {
  Patch ring;  // the moved rim, and a hole inside
  for (const Triangle& t : square(2, 6)) {
    const Corner c{t[1][0] / 2, t[1][1] / 2, 0};
    const Corner d{t[2][0] / 2, t[2][1] / 2, 0};
    ring.push_back({c, t[1], t[2]});
    ring.push_back({c, t[2], d});
  }
  EXPECT_EQ(prove({square(4)}, ring).violations.size(), 1U);
}

TEST(BorderProof, AHoleThatHangsOnASimplifiedRimIsNoPartOfIt) {
  // The rim is simplified and one triangle of the fan is missing: its hole has a rim edge, so it hangs on what changed.
  Patch open = square(2);
  open.pop_back();
  open.push_back({Corner{0, 0, 0}, Corner{-8, 0, 0}, Corner{-4, -2, 0}});
  open.push_back({Corner{-4, -2, 0}, Corner{-8, 0, 0}, Corner{-8, -8, 0}});
  EXPECT_TRUE(prove({square(4)}, square(2)).violations.empty());
  EXPECT_EQ(prove({square(4)}, open).violations.size(), 1U);
}

TEST(BorderProof, APieceThatVanishesDoesNotPayForAHole) {
  // As above, and a card beside the square goes: one loop less, and none of it may be spent on the hole.
  Patch open = square(2);
  open.pop_back();
  open.push_back({Corner{0, 0, 0}, Corner{-8, 0, 0}, Corner{-4, -2, 0}});
  open.push_back({Corner{-4, -2, 0}, Corner{-8, 0, 0}, Corner{-8, -8, 0}});
  Patch card = square(1, 4);
  for (Triangle& triangle : card) {
    for (Corner& c : triangle) c[0] += 100;
  }
  EXPECT_TRUE(prove({square(4), card}, square(2)).violations.empty());
  EXPECT_EQ(prove({square(4), card}, open).violations.size(), 1U);
}

TEST(BorderProof, ANeckMayShrinkToAPoint) {
  // Two quads that meet in an edge become two triangles that meet in a vertex, and everything has moved. What was one
  // loop of border is two, around two pieces: no hole.
  const Patch two_quads{{Corner{-30, -10, 0}, Corner{0, -4, 0}, Corner{0, 4, 0}},
                        {Corner{-30, -10, 0}, Corner{0, 4, 0}, Corner{-30, 10, 0}},
                        {Corner{0, -4, 0}, Corner{30, -10, 0}, Corner{30, 10, 0}},
                        {Corner{0, -4, 0}, Corner{30, 10, 0}, Corner{0, 4, 0}}};
  const Patch two_triangles{{Corner{-29, -9, 0}, Corner{0, 0, 0}, Corner{-29, 9, 0}},
                            {Corner{0, 0, 0}, Corner{29, -9, 0}, Corner{29, 9, 0}}};
  EXPECT_TRUE(prove({two_quads}, two_triangles).violations.empty());
}

TEST(BorderProof, AHoleMayCloseOrJoinTheRim) {
  Patch ring;
  for (const Triangle& t : square(4)) {
    const Corner c{t[1][0] / 2, t[1][1] / 2, 0};
    const Corner d{t[2][0] / 2, t[2][1] / 2, 0};
    ring.push_back({c, t[1], t[2]});
    ring.push_back({c, t[2], d});
  }
  EXPECT_TRUE(prove({ring}, square(2)).violations.empty());
  const Corner a{-8, -8, 0}, b{8, -8, 0}, c{8, 8, 0}, d{-8, 8, 0}, e{2, -2, 0}, f{-2, 2, 0};
  const Patch joined{{a, b, e}, {b, c, e}, {e, c, f}, {c, d, f}, {d, a, f}};
  EXPECT_TRUE(prove({ring}, joined).violations.empty());
  EXPECT_EQ(prove({square(4)}, joined).violations.size(), 1U) << "where there was no hole, there is none to join";
}

TEST(BorderProof, ACrackFromRimToRimIsFound) {
  const Corner low{0, -8, 0}, middle{0, 0, 0}, high{0, 8, 0};
  const Patch parted{{Corner{-8, -8, 0}, low, high},
                     {Corner{-8, -8, 0}, high, Corner{-8, 8, 0}},
                     {low, Corner{8, -8, 0}, middle},
                     {middle, Corner{8, -8, 0}, Corner{8, 8, 0}},
                     {middle, Corner{8, 8, 0}, high}};
  EXPECT_EQ(prove({square(4)}, parted).violations.size(), 1U);
}

TEST(BorderProof, ABorderNeverGetsMoreEdges) {
  // Without a triangle at its rim the square has one border edge less and two more.
  Patch notched = square(2);
  notched.pop_back();
  EXPECT_EQ(prove({square(2)}, notched).violations.size(), 1U);
}

TEST(BorderProof, AHoleInsideAnOpenSurfaceIsNoBorder) {
  // The fan's triangles are split by a smaller square inside; the inner part goes.
  const Patch finer = square(4);
  Patch outer;
  for (std::size_t i = 0; i < finer.size(); ++i) {
    const Corner a = finer[i][1];
    const Corner b = finer[i][2];
    const Corner c{a[0] / 2, a[1] / 2, 0};
    const Corner d{b[0] / 2, b[1] / 2, 0};
    outer.push_back({c, a, b});
    outer.push_back({c, b, d});
  }
  Patch whole = outer;
  for (std::size_t i = 0; i < finer.size(); ++i)
    whole.push_back({Corner{0, 0, 0}, outer[2 * i][0], outer[2 * i + 1][2]});
  EXPECT_TRUE(prove({whole}, whole).violations.empty());
  EXPECT_EQ(prove({whole}, outer).violations.size(), 1U);
}

TEST(BorderProof, ACrackBesideAnOpenBorderIsFound) {
  // Two halves of an open square: the group's half drops a vertex of the seam that the other half keeps.
  const Patch left{{Corner{0, 0, 0}, Corner{0, 4, 0}, Corner{-8, 0, 0}},
                   {Corner{0, 4, 0}, Corner{0, 8, 0}, Corner{-8, 0, 0}}};
  const Patch right{{Corner{0, 4, 0}, Corner{0, 0, 0}, Corner{8, 0, 0}},
                    {Corner{0, 8, 0}, Corner{0, 4, 0}, Corner{8, 0, 0}}};
  EXPECT_TRUE(prove({left}, left, {right}).violations.empty());
  const Patch coarse_left{{Corner{0, 0, 0}, Corner{0, 8, 0}, Corner{-8, 0, 0}}};
  EXPECT_EQ(prove({left}, coarse_left, {right}).violations.size(), 1U);
}

TEST(BorderProof, ATurnedTriangleIsFound) {
  Patch coarser = square(4);
  std::swap(coarser[0][1], coarser[0][2]);
  EXPECT_EQ(prove({square(4)}, coarser, {lid(4)}).violations.size(), 1U);
}

TEST(BorderProof, MembersMeetWithoutABorderBetweenThem) {
  const Patch all = square(4);
  const Patch a(all.begin(), all.begin() + 7);
  const Patch b(all.begin() + 7, all.end());
  EXPECT_TRUE(prove({a, b}, all, {lid(4)}).violations.empty());
}

TEST(BorderProof, SheetsOnOneEdgeAreCounted) {
  // Three sheets on an edge, two of one orientation: the net use is one, and a sheet that goes away is missed.
  const Patch one{{Corner{0, 0, 0}, Corner{0, 8, 0}, Corner{-8, 4, 0}}};
  const Patch two{{Corner{0, 8, 0}, Corner{0, 0, 0}, Corner{8, 4, 0}}};
  const Patch three{{Corner{0, 0, 0}, Corner{0, 8, 0}, Corner{0, 4, 8}}};
  EXPECT_TRUE(prove({one, two}, Patch{one[0], two[0]}, {three}).violations.empty());
  // The edge between the first two is inside the group; without one of them it is open, and no border of the source:
  // the source's net use of it goes the other way.
  EXPECT_EQ(prove({one, three}, one, {two}).violations.size(), 0U);  // one of two equal uses may go: B has one
  EXPECT_EQ(prove({two}, Patch{{Corner{0, 8, 0}, Corner{0, 1, 0}, Corner{8, 4, 0}}}, {one, three}).violations.size(),
            1U);
}

TEST(BorderProof, EdgesWithoutLengthAreLeftOut) {
  // A triangle that the grid collapsed to a line folds onto itself and has no border.
  Patch finer = square(4);
  finer.push_back({Corner{3, 3, 0}, Corner{3, 3, 0}, Corner{5, 5, 0}});
  EXPECT_TRUE(prove({finer}, square(4), {lid(4)}).violations.empty());
}

}  // namespace
}  // namespace meshlode::judge
