// SPDX-License-Identifier: GPL-3.0-or-later
// The shapes are what they say: closed or open, oriented outwards, with the area and volume of their closed forms.
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::lab {
namespace {

using namespace scene;

using Key = std::tuple<double, double, double>;

/// Oriented edges by position: how often a → b is there.
std::map<std::pair<Key, Key>, int> oriented_edges(const Primitive& shape) {
  std::map<std::pair<Key, Key>, int> edges;
  const auto key = [&](std::uint32_t v) {
    const Vec3d& p = shape.positions.at(v);
    return Key{p.x, p.y, p.z};
  };
  for (std::size_t t = 0; t + 2 < shape.indices.size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      const Key a = key(shape.indices[t + k]), b = key(shape.indices[t + (k + 1) % 3]);
      if (a != b) ++edges[{a, b}];
    }
  }
  return edges;
}

/// Oriented edges that have no opposite.
std::size_t count_border(const Primitive& shape) {
  const auto edges = oriented_edges(shape);
  std::size_t border = 0;
  for (const auto& [edge, count] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    const int opposite = other == edges.end() ? 0 : other->second;
    if (count > opposite) border += static_cast<std::size_t>(count - opposite);
  }
  return border;
}

double volume_of(const Primitive& shape) {
  double six = 0.0;
  for (std::size_t t = 0; t + 2 < shape.indices.size(); t += 3) {
    const Vec3d& a = shape.positions[shape.indices[t]];
    six += glm::dot(a, glm::cross(shape.positions[shape.indices[t + 1]], shape.positions[shape.indices[t + 2]]));
  }
  return six / 6.0;
}

TEST(Samples, SineAndCosineAgreeWithTheMathLibrary) {
  for (int i = -400; i <= 400; ++i) {
    const double turns = i / 97.0;
    EXPECT_NEAR(sin_turns(turns), std::sin(2.0 * std::numbers::pi * turns), 1e-14);
    EXPECT_NEAR(cos_turns(turns), std::cos(2.0 * std::numbers::pi * turns), 1e-14);
  }
  EXPECT_EQ(sin_turns(0.5), 0.0);
  EXPECT_EQ(cos_turns(0.25), 0.0);
  EXPECT_EQ(sin_turns(0.25), 1.0);
}

TEST(Samples, ClosedShapesAreClosedAndFaceOutwards) {
  EXPECT_EQ(count_border(make_sphere(7)), 0u);
  EXPECT_NEAR(volume_of(make_sphere(40)), 4.0 / 3.0 * std::numbers::pi, 0.01);
  EXPECT_EQ(count_border(make_cube(5)), 0u);
  EXPECT_NEAR(volume_of(make_cube(5)), 8.0, 1e-12);
  EXPECT_EQ(count_border(make_torus(31, 17)), 0u);
  EXPECT_NEAR(volume_of(make_torus(200, 100)), 2.0 * std::numbers::pi * std::numbers::pi * 0.35 * 0.35, 0.01);
  EXPECT_EQ(count_border(make_blade(9)), 0u);
  EXPECT_NEAR(volume_of(make_blade(9, 1e-3)), 2e-3, 1e-12);
  EXPECT_EQ(count_border(make_double_cone(12)), 0u);
  EXPECT_NEAR(volume_of(make_double_cone(400)), 2.0 * std::numbers::pi / 3.0, 1e-3);
  EXPECT_EQ(count_border(make_box_soup(50)), 0u);
  EXPECT_GT(volume_of(make_box_soup(50)), 0.0);
}

TEST(Samples, SharedVerticesAreCountedByEuler) {
  EXPECT_EQ(make_sphere(6).positions.size(), 6u * 36u + 2u);
  EXPECT_EQ(make_sphere(6).indices.size(), 36u * 36u);
  EXPECT_EQ(make_torus(8, 5).positions.size(), 40u);
}

TEST(Samples, OpenShapesHaveTheBorderTheyShould) {
  EXPECT_EQ(count_border(make_plane(6)), 24u);
  EXPECT_EQ(count_border(make_terrain(9, 5)), 28u);
  // Each sheet of n x n cells has 4n border edges; along the common line no sheet is opposite to another.
  EXPECT_EQ(count_border(make_three_sheets(4)), 48u);
}

TEST(Samples, ThreeSheetsMeetInOneLine) {
  const auto edges = oriented_edges(make_three_sheets(4));
  const auto line = edges.find({Key{0.0, 0.0, 0.25}, Key{0.0, 0.0, 0.0}});
  ASSERT_NE(line, edges.end());
  EXPECT_EQ(line->second, 3);
}

TEST(Samples, MoebiusStripHasOneSideAndOneBorder) {
  // Not orientable: some edges are run twice in the same direction.
  int same_direction = 0;
  std::map<std::pair<Key, Key>, int> undirected;
  for (const auto& [edge, count] : oriented_edges(make_moebius(24, 2))) {
    if (count == 2) ++same_direction;
    undirected[std::minmax(edge.first, edge.second)] += count;
  }
  EXPECT_EQ(same_direction, 2);
  std::map<Key, int> border_degree;
  for (const auto& [edge, count] : undirected) {
    EXPECT_LE(count, 2);
    if (count != 1) continue;
    ++border_degree[edge.first];
    ++border_degree[edge.second];
  }
  EXPECT_EQ(border_degree.size(), 48u);  // one loop twice round
  for (const auto& [point, degree] : border_degree) EXPECT_EQ(degree, 2);
}

TEST(Samples, RockAndCrystalsAreClosedByPositionWithSeams) {
  const Primitive rock = make_rock(12);
  EXPECT_EQ(count_border(rock), 0u);
  EXPECT_EQ(rock.indices.size(), 36u * 144u);
  EXPECT_GT(volume_of(rock), 1.0);
  EXPECT_EQ(rock.positions.size(), 6u * 169u);  // wedges apart along every cube edge
  const Primitive crystal = make_crystal(4, 3);
  EXPECT_EQ(count_border(crystal), 0u);
  EXPECT_GT(volume_of(crystal), 0.0);
  for (const Primitive* shape : {&rock, &crystal}) {
    ASSERT_EQ(shape->normals.size(), shape->positions.size());
    for (const Vec3f& n : shape->normals) EXPECT_NEAR(glm::length(n), 1.0F, 1e-6F);
  }
}

TEST(Samples, SliversAreThinAndLieFlat) {
  const Primitive slivers = make_slivers(10, 1e5);
  ASSERT_EQ(slivers.indices.size(), 30u);
  for (std::size_t t = 0; t < slivers.indices.size(); t += 3) {
    const Vec3d& a = slivers.positions[slivers.indices[t]];
    const Vec3d cross =
        glm::cross(slivers.positions[slivers.indices[t + 1]] - a, slivers.positions[slivers.indices[t + 2]] - a);
    EXPECT_GT(cross.y, 0.0);
    EXPECT_LT(cross.y, 3e-5);
  }
}

TEST(Samples, DuplicatesAndZeroAreasAreThere) {
  EXPECT_EQ(make_duplicates(3).indices.size() / 3, 108u + 36u);
  const Primitive zero = make_zero_areas(3);
  std::size_t none = 0;
  for (std::size_t t = 0; t < zero.indices.size(); t += 3) {
    const Vec3d& a = zero.positions[zero.indices[t]];
    const Vec3d cross = glm::cross(zero.positions[zero.indices[t + 1]] - a, zero.positions[zero.indices[t + 2]] - a);
    if (cross == Vec3d(0.0)) ++none;
  }
  EXPECT_EQ(none, 11u);
}

TEST(Samples, FarPlaneIsFarAndItsFeaturesAreSmall) {
  const Primitive plane = make_far_plane(20);
  double low = 1e300, high = -1e300;
  for (const Vec3d& p : plane.positions) {
    low = std::min(low, p.y);
    high = std::max(high, p.y);
    EXPECT_NEAR(p.x, 1e6, 0.51);
  }
  EXPECT_GT(high - low, 5e-4);
  EXPECT_LT(high - low, 2.1e-3);
}

TEST(Samples, LoosePiecesShareNoVertex) {
  const Primitive pieces = make_loose_pieces(1000);
  EXPECT_GE(pieces.indices.size() / 3, 1000u);
  for (const std::uint32_t index : pieces.indices) ASSERT_LT(index, pieces.positions.size());
  std::vector<int> uses(pieces.positions.size());
  for (const std::uint32_t index : pieces.indices) ++uses[index];
  for (const int count : uses) {
    EXPECT_GE(count, 1);
    EXPECT_LE(count, 3);
  }
}

TEST(Samples, SplitNormalsGiveEveryCornerItsOwnVertex) {
  const Primitive split = with_split_normals(make_sphere(3));
  EXPECT_EQ(split.positions.size(), split.indices.size());
  EXPECT_EQ(split.normals.size(), split.positions.size());
  EXPECT_EQ(count_border(split), 0u);
}

TEST(Samples, ScaledShapesKeepTheirForm) {
  for (const double factor : {1e-6, 1e9}) {
    EXPECT_NEAR(volume_of(scaled(make_cube(2), factor)) / (factor * factor * factor), 8.0, 1e-9);
  }
}

TEST(Samples, TreeWoodIsOpenTubesThatFaceOutwardsWithASeamAlongEach) {
  const Primitive wood = make_tree_wood(12);
  EXPECT_EQ(wood.uvs[0].size(), wood.positions.size());
  // Ten tubes: a trunk of 12 cells around and nine limbs of six, open at both ends and closed along their seams.
  EXPECT_EQ(count_border(wood), 2U * 12U + 9U * 2U * 6U);
  for (std::size_t t = 0; t < wood.indices.size(); t += 3) {
    const std::uint32_t* v = &wood.indices[t];
    const Vec3d n =
        glm::cross(wood.positions[v[1]] - wood.positions[v[0]], wood.positions[v[2]] - wood.positions[v[0]]);
    ASSERT_GT(glm::length(n), 0.0);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(glm::length(wood.normals[v[k]]), 1.0F, 1e-5F);
      EXPECT_GT(glm::dot(n, Vec3d(wood.normals[v[k]])), 0.0) << "normals are on the side that is seen";
    }
  }
}

TEST(Samples, TreeLeavesAreCardsAroundItsLimbs) {
  const Primitive leaves = make_tree_leaves(50);
  EXPECT_EQ(leaves.positions.size(), 4U * 50U);
  EXPECT_EQ(leaves.indices.size(), 6U * 50U);
  const Primitive wood = make_tree_wood(12);
  for (std::size_t v = 0; v < leaves.positions.size(); ++v) {
    double nearest = 1e9;
    for (const Vec3d& p : wood.positions) nearest = std::min(nearest, glm::length(p - leaves.positions[v]));
    EXPECT_LT(nearest, 0.4);
  }
}

}  // namespace
}  // namespace meshlode::lab
