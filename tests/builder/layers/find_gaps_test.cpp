// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps against closed forms: flat sheets at known distances.
#include "builder/layers/find_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "builder/deviation/surface_tree.h"
#include "builder/gap_label.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

using scene::Primitive;
using scene::Scene;

constexpr std::uint32_t kCells = 12;
constexpr double kReachOfDiagonal = 0.02;  // as in find_gaps.cpp

/// A sheet of 2 x 2 in the xz plane that faces +y.
Primitive sheet(double y, bool faces_down = false) {
  Primitive out = lab::make_plane(kCells);
  for (Vec3d& p : out.positions) p.y = y;
  for (std::size_t i = 0; faces_down && i < out.indices.size(); i += 3) std::swap(out.indices[i], out.indices[i + 1]);
  out.material = MaterialId(0U);
  return out;
}

/// One mesh. Each primitive has a colour of its own.
Scene scene_of(std::vector<Primitive> primitives) {
  scene::SourceMesh mesh;
  mesh.primitives = std::move(primitives);
  for (std::uint32_t i = 0; i < mesh.primitives.size(); ++i) mesh.primitives[i].material = MaterialId(i);
  const std::size_t colors = mesh.primitives.size();
  Scene scene = lab::as_scene(std::move(mesh));
  scene.materials.resize(colors);
  return scene;
}

/// A mesh and an instance for each.
Scene scene_of_meshes(std::vector<Primitive> primitives) {
  Scene scene = lab::as_scene(lab::as_mesh(std::move(primitives[0])));
  for (std::uint32_t i = 1; i < primitives.size(); ++i) {
    scene.meshes.push_back(lab::as_mesh(std::move(primitives[i])));
    scene::SceneInstance instance = scene.instances[0];
    instance.mesh = MeshId(i);
    scene.instances.push_back(instance);
  }
  return scene;
}

std::vector<MeshGaps> gaps_of(const Scene& scene) {
  return find_gaps(scene, std::vector<std::uint8_t>(scene.meshes.size(), 1));
}

/// How many triangles have a gap; each of them `gap`, within what a code rounds.
std::size_t count_gaps(const MeshGaps& gaps, double gap) {
  std::size_t count = 0;
  for (const std::uint8_t code : gaps.codes) {
    if (code == 0) continue;
    ++count;
    const GapPair pair = GapPair::of_byte(code);
    const double found = gap_of_code(std::max(pair.above, pair.below), gaps.reach);
    EXPECT_GE(found, gap / 1.5);
    EXPECT_LE(found, gap * 1.5);
  }
  return count;
}

TEST(FindGaps, CodesAreTheNearestPowerInRatio) {
  EXPECT_EQ(code_of_gap(1.0, 1.0), 1U);
  EXPECT_EQ(code_of_gap(1.0001, 1.0), 0U);
  EXPECT_EQ(code_of_gap(std::numeric_limits<double>::quiet_NaN(), 1.0), 0U);
  EXPECT_EQ(code_of_gap(0.0, 1.0), kNarrowestGap);
  for (std::uint32_t code = 1; code < kNarrowestGap; ++code) {
    EXPECT_EQ(code_of_gap(gap_of_code(code, 3.0), 3.0), code);
    EXPECT_EQ(code_of_gap(0.75 * gap_of_code(code, 3.0), 3.0), code);
    EXPECT_EQ(code_of_gap(0.65 * gap_of_code(code, 3.0), 3.0), code + 1);
  }
  const std::uint32_t label = with_gaps(with_gaps(17, {9, 15}), {3, 11});
  EXPECT_EQ(material_of(label), 17U);
  EXPECT_EQ(gap_pair_of(label).above, 3U);
  EXPECT_EQ(gap_pair_of(label).below, 11U);
  GapPair pair = gap_pair_of(label);
  pair.narrow({5, 2});
  EXPECT_EQ(pair.above, 5U);
  EXPECT_EQ(pair.below, 11U);
}

TEST(FindGaps, TwoSheetsOfOneMeshHaveTheGapBetweenThem) {
  const std::vector<MeshGaps> gaps = gaps_of(scene_of({sheet(0.0), sheet(0.01)}));
  EXPECT_NEAR(gaps[0].reach, kReachOfDiagonal * std::sqrt(8.0001), 1e-9);
  ASSERT_EQ(gaps[0].codes.size(), 4U * kCells * kCells);
  // Large triangles have four rays each.
  EXPECT_EQ(count_gaps(gaps[0], 0.01), gaps[0].codes.size());
}

/// Whether all gaps of the mesh are on that side, and there are some.
void expect_side(const MeshGaps& gaps, bool is_above) {
  EXPECT_FALSE(gaps.codes.empty());
  for (const std::uint8_t code : gaps.codes) {
    const GapPair pair = GapPair::of_byte(code);
    EXPECT_EQ(pair.above != 0, is_above && code != 0);
    EXPECT_EQ(pair.below != 0, !is_above && code != 0);
  }
}

TEST(FindGaps, EachSheetHasTheGapOnTheSideOfTheOther) {
  const Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01)});
  expect_side(gaps_of(scene)[0], true);
  expect_side(gaps_of(scene)[1], false);
  // Alone: what rays of the other meet is told the side that they come from.
  expect_side(find_gaps(scene, std::vector<std::uint8_t>{1, 0})[0], true);
  expect_side(find_gaps(scene, std::vector<std::uint8_t>{0, 1})[1], false);
  Scene turned = scene;  // upside down, and mirrored: by their own normals nothing changes
  const Mat4d over(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  const Mat4d mirrored(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  for (const Mat4d& moved : {over, mirrored, over * mirrored}) {
    for (scene::SceneInstance& instance : turned.instances) instance.transform = moved;
    expect_side(gaps_of(turned)[0], true);
    expect_side(gaps_of(turned)[1], false);
  }
  // Two sheets that face each other: each is above the other, by its normal.
  Scene facing = scene_of_meshes({sheet(0.0), sheet(0.01, true)});
  facing.materials[0].double_sided = true;
  for (const MeshGaps& gaps : gaps_of(facing)) expect_side(gaps, true);
}

TEST(FindGaps, ASheetBetweenTwoHasTheGapAboveAloneUnlessItsBackIsSeen) {
  Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01), sheet(0.02)});
  expect_side(gaps_of(scene)[0], true);
  expect_side(gaps_of(scene)[1], true);
  expect_side(gaps_of(scene)[2], false);
  scene.materials[0].double_sided = true;
  const std::vector<MeshGaps> gaps = gaps_of(scene);
  for (const std::uint8_t code : gaps[1].codes) {
    EXPECT_NE(GapPair::of_byte(code).above, 0U);
    EXPECT_NE(GapPair::of_byte(code).below, 0U);
  }
}

TEST(FindGaps, SoHaveSheetsOfTwoMeshes) {
  const std::vector<MeshGaps> gaps = gaps_of(scene_of_meshes({sheet(0.0), sheet(0.01)}));
  for (const MeshGaps& of_mesh : gaps) EXPECT_EQ(count_gaps(of_mesh, 0.01), 2U * kCells * kCells);
}

TEST(FindGaps, NoGapIsFoundWithoutAnotherLayer) {
  const auto are_none = [](const std::vector<MeshGaps>& gaps) {
    return std::all_of(gaps.begin(), gaps.end(), [](const MeshGaps& g) { return g.codes.empty(); });
  };
  EXPECT_TRUE(are_none(gaps_of(scene_of({lab::make_sphere(12)}))));
  EXPECT_TRUE(are_none(gaps_of(scene_of({lab::make_torus(24, 12)}))));
  EXPECT_TRUE(are_none(gaps_of(scene_of({lab::make_cube(4)}))));
  EXPECT_TRUE(are_none(gaps_of(scene_of({lab::make_blade(12, 1e-3)}))));      // the back of a thin thing is no layer
  EXPECT_TRUE(are_none(gaps_of(scene_of({sheet(0.0), sheet(0.2)}))));         // beyond the reach
  EXPECT_TRUE(are_none(gaps_of(scene_of({sheet(0.0), sheet(0.01, true)}))));  // faces the other way
  EXPECT_TRUE(are_none(gaps_of(scene_of({sheet(0.0), sheet(1e-7)}))));        // in one plane, as far as the grid knows
  EXPECT_TRUE(are_none(gaps_of(Scene{})));
}

TEST(FindGaps, SurfacesOfOneMeshThatLookTheSameHaveNone) {
  const std::size_t both = 4U * kCells * kCells;
  Scene scene = scene_of({sheet(0.0), sheet(0.01)});
  scene.meshes[0].primitives[1].material = MaterialId(0U);
  EXPECT_TRUE(gaps_of(scene)[0].codes.empty());
  // What varies over a surface is seen to be hidden: a texture, of whatever kind, and vertex colours.
  Scene textured = scene;
  textured.materials[0].textures.emplace_back();
  EXPECT_EQ(count_gaps(gaps_of(textured)[0], 0.01), both);
  textured = scene;
  textured.materials[0].uv_sets_used = 1;  // of which nothing more is known
  EXPECT_EQ(count_gaps(gaps_of(textured)[0], 0.01), both);
  Scene colored = scene;
  for (Primitive& primitive : colored.meshes[0].primitives) primitive.colors.resize(primitive.positions.size());
  EXPECT_EQ(count_gaps(gaps_of(colored)[0], 0.01), both);
  colored.meshes[0].primitives[0].colors.clear();
  EXPECT_EQ(count_gaps(gaps_of(colored)[0], 0.01), both);
  // Between others of another colour each has the gap to these.
  Scene three = scene_of({sheet(0.0), sheet(0.01), sheet(0.02)});
  three.meshes[0].primitives[2].material = MaterialId(0U);
  EXPECT_EQ(count_gaps(gaps_of(three)[0], 0.01), both + both / 2);
  three.meshes[0].primitives[1].material = MaterialId(0U);
  three.meshes[0].primitives[2].material = MaterialId(2U);
  const std::vector<MeshGaps> gaps = gaps_of(three);
  expect_side({gaps[0].reach, {gaps[0].codes.begin() + both, gaps[0].codes.end()}}, false);
  // Instances of a mesh look the same, other meshes need not.
  Scene twice = scene_of({sheet(0.0)});
  twice.instances.push_back(twice.instances[0]);
  twice.instances[1].transform[3].y = 0.01;
  EXPECT_TRUE(gaps_of(twice)[0].codes.empty());
  twice.meshes.push_back(lab::as_mesh(lab::scaled(sheet(0.5), 0.1)));
  EXPECT_TRUE(gaps_of(twice)[0].codes.empty());
  twice.meshes[0].primitives[0].colors.resize(twice.meshes[0].primitives[0].positions.size());
  EXPECT_EQ(count_gaps(gaps_of(twice)[0], 0.01), both / 2);
}

TEST(FindGaps, BothSidesOfADoubleSidedMaterialCount) {
  Scene scene = scene_of({sheet(0.0), sheet(0.01, true)});
  scene.materials[1].double_sided = true;
  EXPECT_EQ(count_gaps(gaps_of(scene)[0], 0.01), 4U * kCells * kCells);
}

/// Gaps of every mesh, which are `gap` in each one's own frame.
void expect_gaps(const Scene& scene, std::span<const double> gap) {
  const std::vector<MeshGaps> gaps = gaps_of(scene);
  for (std::size_t i = 0; i < gaps.size(); ++i) EXPECT_EQ(count_gaps(gaps[i], gap[i]), 2U * kCells * kCells) << i;
}

TEST(FindGaps, InstancesMeetWhereTheyStandHoweverTheyAreTurnedScaledAndMirrored) {
  Scene scene = scene_of_meshes({sheet(0.0), sheet(0.005)});
  // The upper one at twice its size: its gap of 0.01 is half of that in its own frame.
  const Mat4d doubled(2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  scene.instances[1].transform = doubled;
  std::vector<Primitive>& lower = scene.meshes[0].primitives;
  for (Vec3d& p : lower[0].positions) p *= Vec3d(2.0, 1.0, 2.0);
  const double expected[] = {0.01, 0.005};
  expect_gaps(scene, expected);
  // All of it turned and moved; then mirrored, which turns the facing of both.
  const Mat4d turned(0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 30.0, -2.0, 5.0, 1.0);
  const Mat4d mirrored(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  for (const Mat4d& moved : {turned, mirrored, turned * mirrored}) {
    Scene there = scene;
    for (scene::SceneInstance& instance : there.instances) instance.transform = moved * instance.transform;
    expect_gaps(there, expected);
  }
  // One of them alone mirrored, along the sheet: it faces down then, as far as the renderer knows.
  Scene one = scene;
  one.instances[1].transform = one.instances[1].transform * mirrored;
  expect_gaps(one, expected);  // its corners turn the other way too, so that up stays up
  Scene flipped = scene_of_meshes({sheet(0.0), sheet(0.01)});
  flipped.instances[1].transform =
      Mat4d(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.02, 0.0, 1.0);
  for (const MeshGaps& gaps : gaps_of(flipped)) EXPECT_TRUE(gaps.codes.empty());
}

TEST(FindGaps, WhatIsDeformedMeetsItselfAlone) {
  Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01)});
  scene.meshes[1].is_deformed = true;
  for (const MeshGaps& gaps : gaps_of(scene)) EXPECT_TRUE(gaps.codes.empty());
  Scene alone = scene_of({sheet(0.0), sheet(0.01)});
  alone.meshes[0].is_deformed = true;
  EXPECT_EQ(count_gaps(gaps_of(alone)[0], 0.01), 4U * kCells * kCells);
}

TEST(FindGaps, MeshesThatNobodyAsksAboutAreMetAllTheSame) {
  const Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01)});
  const std::vector<MeshGaps> gaps = find_gaps(scene, std::vector<std::uint8_t>{0, 1});
  EXPECT_TRUE(gaps[0].codes.empty());
  EXPECT_EQ(count_gaps(gaps[1], 0.01), 2U * kCells * kCells);
}

/// Shells with unlike triangles: some rays meet, some do not.
Scene shells() {
  Scene scene = scene_of_meshes({lab::make_rock(14, 3), lab::make_sphere(17, 1.02), lab::make_sphere(9, 0.97)});
  scene.instances[1].transform[3] = glm::dvec4(0.01, 0.0, 0.0, 1.0);
  return scene;
}

TEST(FindGaps, NothingDependsOnTheOrderOfMeshesInstancesAndTriangles) {
  const Scene scene = shells();
  const std::vector<MeshGaps> gaps = gaps_of(scene);
  const auto count = [](const MeshGaps& g) {
    return g.codes.size() - static_cast<std::size_t>(std::count(g.codes.begin(), g.codes.end(), 0));
  };
  for (const MeshGaps& g : gaps) EXPECT_GT(count(g), 10U);
  Scene other = scene;
  std::swap(other.meshes[0], other.meshes[2]);
  std::reverse(other.instances.begin(), other.instances.end());
  for (scene::SceneInstance& instance : other.instances) instance.mesh = MeshId(2 - instance.mesh.value);
  // Triangles from the last to the first, each turned by a corner.
  std::vector<std::uint32_t>& indices = other.meshes[1].primitives[0].indices;
  std::vector<std::uint32_t> turned;
  for (std::size_t t = indices.size() / 3; t-- > 0;) {
    turned.insert(turned.end(), {indices[3 * t + 1], indices[3 * t + 2], indices[3 * t]});
  }
  indices = turned;
  std::vector<MeshGaps> again = gaps_of(other);
  std::swap(again[0], again[2]);
  std::reverse(again[1].codes.begin(), again[1].codes.end());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(again[i].codes, gaps[i].codes) << i;
}

TEST(FindGaps, NothingDependsOnTheNumberOfThreads) {
  const Scene scene = shells();
  const std::vector<MeshGaps> gaps = gaps_of(scene);
  const std::vector<MeshGaps> alone = with_threads_at_most(1, [&] { return gaps_of(scene); });
  for (std::size_t i = 0; i < gaps.size(); ++i) EXPECT_EQ(gaps[i].codes, alone[i].codes) << i;
}

TEST(FindGaps, AnyScaleHasTheSameGaps) {
  const Scene scene = shells();
  const std::vector<MeshGaps> gaps = gaps_of(scene);
  for (const double scale : {0x1p-300, 0x1p-20, 0x1p40, 0x1p300}) {
    Scene scaled = scene;
    for (scene::SourceMesh& mesh : scaled.meshes) mesh.primitives[0] = lab::scaled(mesh.primitives[0], scale);
    for (scene::SceneInstance& instance : scaled.instances) instance.transform[3] *= glm::dvec4(Vec3d(scale), 1.0);
    const std::vector<MeshGaps> again = gaps_of(scaled);
    for (std::size_t i = 0; i < gaps.size(); ++i) EXPECT_EQ(again[i].codes, gaps[i].codes) << scale << " " << i;
  }
}

TEST(FindGaps, WhatHasNoAreaAndNoExtentIsPassedOver) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t usual = 4U * kCells * kCells;
  Scene degenerate = scene_of({sheet(0.0), lab::make_zero_areas(4), sheet(0.01)});
  Primitive& ball = degenerate.meshes[0].primitives[1];
  for (Vec3d& p : ball.positions) p = p * 0.1 + Vec3d(0.0, 0.5, 0.0);
  EXPECT_EQ(count_gaps(gaps_of(degenerate)[0], 0.01), usual);
  for (const double bad : {inf, nan, 1e300, -1e308}) {
    Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01), sheet(0.005)});
    scene.meshes[2].primitives[0].positions[0].x = bad;
    const std::vector<MeshGaps> gaps = gaps_of(scene);
    EXPECT_EQ(count_gaps(gaps[0], 0.01), usual / 2) << bad;
    EXPECT_TRUE(gaps[2].codes.empty()) << bad;
  }
  Scene point = scene_of({sheet(0.0)});
  for (Vec3d& p : point.meshes[0].primitives[0].positions) p = Vec3d(1.0);
  EXPECT_TRUE(gaps_of(point)[0].codes.empty());
  // Instances without a way back, or out of the world.
  for (const Mat4d& transform : {Mat4d(0.0), Mat4d(nan), Mat4d(1e300)}) {
    Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01)});
    scene.instances[1].transform = transform;
    for (const MeshGaps& gaps : gaps_of(scene)) EXPECT_TRUE(gaps.codes.empty());
  }
  Scene tiny = scene_of({lab::scaled(sheet(0.0), 1e-310), lab::scaled(sheet(0.01), 1e-310)});
  EXPECT_TRUE(gaps_of(tiny)[0].codes.empty());
  Scene astray = scene_of({sheet(0.0), sheet(0.01)});
  astray.meshes[0].primitives[1].indices[7] = 1U << 30U;
  EXPECT_TRUE(gaps_of(astray)[0].codes.empty());
  Scene empty = scene_of({Primitive{}});
  EXPECT_TRUE(gaps_of(empty)[0].codes.empty());
}

TEST(FindGaps, AThousandInstancesInOnePlaceCostNoMoreThanAFew) {
  Scene scene = scene_of_meshes({sheet(0.0), sheet(0.01)});
  for (int i = 0; i < 1000; ++i) scene.instances.push_back(scene.instances[1]);
  // Rays of each of them look around two, and at so many neighbours; the gap is found as with one.
  const double expected[] = {0.01, 0.01};
  expect_gaps(scene, expected);
}

TEST(VisitAlong, AllThatASegmentMeetsIsVisitedOnce) {
  const Primitive rock = lab::make_rock(12, 5);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t i = 0; i < rock.indices.size(); i += 3) {
    triangles.push_back({rock.indices[i], rock.indices[i + 1], rock.indices[i + 2]});
  }
  SurfaceTree tree;
  tree.build({rock.positions, triangles}, SurfaceTree::Leaves::kMade);
  std::vector<int> visits(triangles.size());
  std::size_t fewest = triangles.size(), most = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    const Vec3d middle = (rock.positions[a] + rock.positions[b] + rock.positions[c]) / 3.0;
    std::fill(visits.begin(), visits.end(), 0);
    // Along an axis and not; through the triangle.
    const Vec3d along = t % 2 == 0 ? Vec3d(0.0, 0.1, 0.0) : Vec3d(0.05, -0.02, 0.03);
    tree.visit_along(middle - along, middle + along, [&](TreeSlot slot) {
      ++visits[tree.triangle_at(slot)];
      return true;
    });
    EXPECT_EQ(visits[t], 1);
    EXPECT_LE(*std::max_element(visits.begin(), visits.end()), 1);
    const auto met = static_cast<std::size_t>(std::count(visits.begin(), visits.end(), 1));
    fewest = std::min(fewest, met);
    most = std::max(most, met);
  }
  EXPECT_GE(fewest, 1U);
  EXPECT_LT(most, triangles.size() / 4);  // it is a tree
  bool any = false;
  tree.visit_along(Vec3d(9.0), Vec3d(10.0), [&](TreeSlot) { return any = true; });
  EXPECT_FALSE(any);
}

}  // namespace
}  // namespace meshlode::builder
