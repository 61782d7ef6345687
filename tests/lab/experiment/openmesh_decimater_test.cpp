// SPDX-License-Identifier: GPL-3.0-or-later
// The contract of simplify.h, kept around a decimater that knows nothing of it.
#include "lab/experiment/openmesh_decimater.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/prepare/prepare.h"
#include "builder/simplify/border_rule.h"
#include "builder/simplify/two_charts.h"
#include "lab/samples/samples.h"
#include "support/border_chain.h"
#include "support/sanitized.h"
#include "support/simplify_input.h"

namespace meshlode::lab {
namespace {

using namespace builder;

using testing_support::add_triangle;
using testing_support::Chain;
using testing_support::point;
using testing_support::Point;

SimplifyInput as_input(const scene::Primitive& shape, const AttributeLayout& layout = {}) {
  return test::as_input(*prepare_mesh(lab::as_mesh(shape), layout, {}));
}

template <class Surface>
Point corner(const Surface& surface, const WedgeTriangle& t, std::size_t k) {
  return point(surface.positions[surface.wedge_position[t[k % 3]]]);
}

template <class Surface>
Chain border_of(const Surface& surface) {
  Chain chain;
  for (const WedgeTriangle& t : surface.triangles) {
    add_triangle(chain, {corner(surface, t, 0), corner(surface, t, 1), corner(surface, t, 2)});
  }
  return chain;
}

/// Locks all of the border, as where other groups go on.
void lock_border(SimplifyInput& input) {
  std::set<Point> ends;
  for (const auto& [edge, net] : border_of(input)) ends.insert({edge.first, edge.second});
  for (std::size_t p = 0; p < input.positions.size(); ++p) {
    if (ends.contains(point(input.positions[p]))) input.is_locked[p] = 1;
  }
}

SimplifyResult simplify(const SimplifyInput& input, std::uint32_t target, bool may_relax_flips = false) {
  SimplifyOptions options;
  options.target_triangles = target;
  options.may_relax_flips = may_relax_flips;
  return simplify_group_by_openmesh(input, options);
}

SimplifyResult halve(const SimplifyInput& input) {
  return simplify(input, static_cast<std::uint32_t>(input.triangles.size() / 2));
}

/// What no result may break, in words; empty if nothing.
std::string fault_of(const SimplifyInput& input, const SimplifyResult& result) {
  if (result.triangles.size() != result.triangle_material.size()) return "a material a triangle";
  if (result.witnesses.size() != result.positions.size()) return "witnesses of each position";
  const std::size_t stride = input.layout.stride();
  if (result.wedge_attributes.size() != stride * result.wedge_position.size()) return "attributes of each wedge";
  std::set<Point> known;
  for (const Vec3i& p : input.positions) known.insert(point(p));
  for (const Vec3i& p : result.positions) {
    if (!known.contains(point(p))) return "a vertex where none was";
  }
  for (const Witnesses& w : result.witnesses) {
    if (w.count == 0 || w.count > Witnesses::kCapacity) return "one to three witnesses";
  }
  std::set<std::uint32_t> materials(input.triangle_material.begin(), input.triangle_material.end());
  for (std::size_t t = 0; t < result.triangles.size(); ++t) {
    const WedgeTriangle& c = result.triangles[t];
    if (*std::max_element(c.begin(), c.end()) >= result.wedge_position.size()) return "a wedge that is not there";
    if (!materials.contains(result.triangle_material[t])) return "a material that was not there";
    for (std::size_t k = 0; k < 3; ++k) {
      if (corner(result, c, k) == corner(result, c, k + 1)) return "two corners in one place";
    }
  }
  if (!std::isfinite(result.quadric_error) || result.quadric_error < 0.0) return "an error that is none";
  if (!keeps_border(input, result)) return "another border";
  return {};
}

/// Wedges at locked positions, by what they say.
template <class Surface>
std::set<std::pair<Point, std::vector<float>>> wedges_at(const Surface& surface, const std::set<Point>& places,
                                                         std::size_t stride) {
  std::set<std::pair<Point, std::vector<float>>> out;
  for (std::size_t w = 0; w < surface.wedge_position.size(); ++w) {
    const Point p = point(surface.positions[surface.wedge_position[w]]);
    const auto first = surface.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(w * stride);
    if (places.contains(p)) out.emplace(p, std::vector<float>(first, first + static_cast<std::ptrdiff_t>(stride)));
  }
  return out;
}

using Side = std::pair<Point, Point>;
using Values = std::pair<std::vector<float>, std::vector<float>>;  ///< at both ends of a side

/// Of the sides that one triangle alone has, what their ends' wedges say.
template <class Surface>
std::map<Side, Values> single_sides(const Surface& surface, std::size_t stride) {
  std::map<Side, std::vector<Values>> all;
  const auto values = [&](std::uint32_t w) {
    const auto first = surface.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(w * stride);
    return std::vector<float>(first, first + static_cast<std::ptrdiff_t>(stride));
  };
  for (const WedgeTriangle& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point from = corner(surface, t, k), to = corner(surface, t, k + 1);
      Values at{values(t[k]), values(t[(k + 1) % 3])};
      if (to < from) std::swap(at.first, at.second);
      all[std::minmax(from, to)].push_back(std::move(at));
    }
  }
  std::map<Side, Values> out;
  for (const auto& [side, uses] : all) {
    if (uses.size() == 1) out[side] = uses[0];
  }
  return out;
}

/// Sides along which another group would be shaded otherwise than before.
std::size_t count_torn(const SimplifyInput& input, const SimplifyResult& result, const std::set<Point>& locked) {
  const std::size_t stride = input.layout.stride();
  const std::map<Side, Values> before = single_sides(input, stride), after = single_sides(result, stride);
  std::size_t torn = 0;
  for (const auto& [side, values] : before) {
    const auto at = after.find(side);
    if (at == after.end() || !locked.contains(side.first) || !locked.contains(side.second)) continue;
    torn += at->second != values ? 1 : 0;
  }
  return torn;
}

TEST(OpenMeshDecimater, ACurvedPatchReachesItsTargetAndKeepsItsLockedBorder) {
  AttributeLayout layout;
  layout.has_normal = true;
  SimplifyInput input = as_input(lab::with_smooth_normals(lab::make_terrain(24, 24)), layout);
  lock_border(input);
  std::set<Point> locked;
  for (std::size_t p = 0; p < input.positions.size(); ++p) {
    if (input.is_locked[p] != 0) locked.insert(point(input.positions[p]));
  }
  input.is_wedge_shared.assign(input.wedge_position.size(), 0);
  for (std::size_t w = 0; w < input.wedge_position.size(); ++w) {
    input.is_wedge_shared[w] = input.is_locked[input.wedge_position[w]];
  }
  const SimplifyResult result = halve(input);
  EXPECT_EQ(fault_of(input, result), "");
  EXPECT_EQ(border_of(result), border_of(input));
  EXPECT_LE(result.triangles.size(), input.triangles.size() / 2);
  EXPECT_GE(result.triangles.size() + 2, input.triangles.size() / 2) << "and goes no further";
  EXPECT_EQ(result.reason, StuckReason::kNotStuck);
  EXPECT_GT(result.quadric_error, 0.0);
  EXPECT_EQ(wedges_at(result, locked, 3), wedges_at(input, locked, 3));
}

TEST(OpenMeshDecimater, ASphereStaysNearTheSphere) {
  const SimplifyInput input = as_input(lab::make_sphere(20));
  const SimplifyResult result = simplify(input, 300);
  EXPECT_EQ(fault_of(input, result), "");
  EXPECT_LE(result.triangles.size(), 300U);
  EXPECT_TRUE(border_of(result).empty());
  for (const WedgeTriangle& t : result.triangles) {
    Vec3d middle(0.0);
    for (const std::uint32_t w : t)
      middle += Vec3d(result.positions[result.wedge_position[w]]) * input.grid.step() / 3.0;
    EXPECT_NEAR(glm::length(middle), 1.0, 0.08);
  }
  EXPECT_GT(result.quadric_error, 1e-4);
  EXPECT_LT(result.quadric_error, 0.05);
}

/// Also where roundings make its errors a little less than nothing.
TEST(OpenMeshDecimater, AFlatPatchCostsNothing) {
  for (const bool is_tilted : {false, true}) {
    SimplifyInput input = as_input(lab::make_plane(16));
    lock_border(input);
    for (Vec3i& p : input.positions) p.y = is_tilted ? p.x + 3 * p.z : p.y;
    const SimplifyResult result = simplify(input, 1);
    EXPECT_EQ(fault_of(input, result), "");
    EXPECT_LE(result.triangles.size(), 66U) << "64 vertices on the border and hardly one inside";
    EXPECT_LT(result.quadric_error, input.grid.step());
    EXPECT_EQ(result.reason, StuckReason::kLocked);
  }
}

/// A free vertex between two locked ones: were it to go, an open edge would lie where another group may have one.
TEST(OpenMeshDecimater, NoOpenEdgeComesBetweenLockedVertices) {
  SimplifyInput input;
  input.positions = {{0, 0, 0}, {100, 0, 0}, {200, 0, 0}, {100, 100, 0}, {0, 100, 0}, {200, 100, 0}};
  input.is_locked = {1, 0, 1, 1, 1, 1};
  input.triangles = {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}, {2, 5, 3}};
  for (std::uint32_t v = 0; v < 6; ++v) {
    input.witnesses.push_back({{input.positions[v]}, 1});
    input.wedge_position.push_back(v);
  }
  input.is_wedge_shared.assign(6, 0);
  input.triangle_material.assign(4, 0);
  const SimplifyResult kept = simplify(input, 1);
  EXPECT_EQ(border_of(kept), border_of(input));
  EXPECT_EQ(kept.reason, StuckReason::kLocked);
  input.is_locked[2] = 0;
  EXPECT_LT(simplify(input, 1).triangles.size(), 4U);
}

TEST(OpenMeshDecimater, NoTextureCrossesItsSeam) {
  const scene::Primitive cut = make_two_charts(16);
  AttributeLayout layout;
  layout.uv_set_count = 1;
  const SimplifyInput input = as_input(cut, layout);
  const SimplifyResult result = simplify(input, 64);
  EXPECT_EQ(fault_of(input, result), "");
  EXPECT_LE(result.triangles.size(), 64U) << "along the seam it may go";
  // A wedge is what it was where it was, and a triangle is of one chart.
  std::set<Point> everywhere;
  for (const Vec3i& p : result.positions) everywhere.insert(point(p));
  const auto before = wedges_at(input, everywhere, 2), after = wedges_at(result, everywhere, 2);
  EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()));
  for (const WedgeTriangle& t : result.triangles) {
    EXPECT_EQ(result.wedge_attributes[2 * t[0]] > 5.0F, result.wedge_attributes[2 * t[1]] > 5.0F);
    EXPECT_EQ(result.wedge_attributes[2 * t[0]] > 5.0F, result.wedge_attributes[2 * t[2]] > 5.0F);
  }
}

TEST(OpenMeshDecimater, CreasesOfSplitNormalsDoNotStopIt) {
  AttributeLayout layout;
  layout.has_normal = true;
  const SimplifyInput input = as_input(lab::with_split_normals(lab::make_sphere(16)), layout);
  const SimplifyResult result = halve(input);
  EXPECT_EQ(fault_of(input, result), "");
  EXPECT_LE(result.triangles.size(), input.triangles.size() / 2);
}

TEST(OpenMeshDecimater, MaterialsKeepTheirBorder) {
  SimplifyInput input = as_input(lab::make_sphere(12));
  const auto height = [](const auto& surface, const WedgeTriangle& t) {
    return corner(surface, t, 0)[1] + corner(surface, t, 1)[1] + corner(surface, t, 2)[1];
  };
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    input.triangle_material[t] = height(input, input.triangles[t]) > 0 ? 1 : 0;
  }
  const SimplifyResult result = halve(input);
  EXPECT_EQ(fault_of(input, result), "");
  EXPECT_LE(result.triangles.size(), input.triangles.size() / 2);
  const auto upper = [](auto surface) {
    std::vector<WedgeTriangle> kept;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      if (surface.triangle_material[t] == 1) kept.push_back(surface.triangles[t]);
    }
    surface.triangles = kept;
    return border_of(surface);
  };
  EXPECT_EQ(upper(result), upper(input));
}

/// What OpenMesh refuses or aborts at: edges of three sheets, cones tip to tip, needles, triangles without area and
/// twice over, and a band with one side.
TEST(OpenMeshDecimater, WhatItDoesNotTakeIsCarriedThrough) {
  const scene::Primitive shapes[] = {lab::make_three_sheets(12), lab::make_double_cone(80), lab::make_slivers(200),
                                     lab::make_moebius(60, 6),   lab::make_duplicates(10),  lab::make_zero_areas(10),
                                     lab::make_blade(16),        lab::make_box_soup(40)};
  SplitMix64 random(42);
  for (const scene::Primitive& shape : shapes) {
    for (int trial = 0; trial < (test::kIsSanitized ? 2 : 4); ++trial) {
      SimplifyInput input = as_input(shape);
      const std::size_t kept = trial == 0 ? input.triangles.size() : 1 + random.below(input.triangles.size());
      input.triangles.resize(kept);
      input.triangle_material.resize(kept);
      const bool is_open = trial == 1;
      if (!is_open) lock_border(input);
      const SimplifyResult result = simplify(input, static_cast<std::uint32_t>(kept / 3), trial == 2);
      EXPECT_EQ(fault_of(input, result), "") << "trial " << trial;
      if (!is_open) {
        EXPECT_EQ(border_of(result), border_of(input)) << "trial " << trial;
      }
      EXPECT_LE(result.triangles.size(), kept);
    }
  }
}

/// Sheets between the points of a small lattice, with holes, and triangles from anywhere to anywhere, any vertex
/// locked: all that can go wrong with edges at once.
SimplifyInput random_soup(SplitMix64& random) {
  SimplifyInput input;
  const auto side = 3 + static_cast<std::uint32_t>(random.below(3));
  const std::uint32_t count = side * side * side;
  const std::uint64_t locks = random.below(4);
  for (std::uint32_t v = 0; v < count; ++v) {
    const auto place = [](std::uint32_t i) { return 100 * static_cast<int>(i); };
    input.positions.emplace_back(place(v % side), place(v / side % side), place(v / side / side));
    input.is_locked.push_back(random.below(8) < locks ? 1 : 0);
    input.witnesses.push_back({{input.positions[v]}, 1});
  }
  input.layout.has_normal = random.below(2) == 0;
  input.layout.uv_set_count = static_cast<std::uint32_t>(random.below(2));
  for (std::uint32_t w = 0; w < 2 * count; ++w) {
    input.wedge_position.push_back(w / 2);
    input.is_wedge_shared.push_back(input.is_locked[w / 2]);
    for (std::uint32_t i = 0; i < input.layout.stride(); ++i) {
      input.wedge_attributes.push_back(static_cast<float>(random.below(100)));
    }
  }
  const std::uint64_t holes = random.below(3), seams = random.below(3), others = random.below(3);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    WedgeTriangle t{a, b, c};
    for (std::uint32_t& v : t) v = 2 * v + (random.below(16) < seams ? 1 : 0);
    input.triangles.push_back(t);
    input.triangle_material.push_back(random.below(64) < others ? 1 : 0);
  };
  for (std::uint32_t v = 0; v < count; ++v) {
    if (v % side + 1 == side || v / side % side + 1 == side || random.below(8) < holes) continue;
    add(v, v + 1, v + side + 1);
    if (random.below(8) >= holes) add(v, v + side + 1, v + side);
  }
  for (std::uint64_t i = random.below(6); i > 0; --i) {
    const auto a = static_cast<std::uint32_t>(random.below(count)), b = static_cast<std::uint32_t>(random.below(count));
    const auto c = static_cast<std::uint32_t>(random.below(count));
    if (a != b && b != c && c != a) add(a, b, c);
  }
  return input;
}

TEST(OpenMeshDecimater, RandomSoupsKeepTheContract) {
  SplitMix64 random(7);
  constexpr int kSoups = test::kIsSanitized ? 100 : 400;
  int simplified = 0;
  for (int i = 0; i < kSoups; ++i) {
    const SimplifyInput input = random_soup(random);
    const SimplifyResult result = simplify(input, 1, i % 2 == 0);
    ASSERT_EQ(fault_of(input, result), "") << "soup " << i;
    simplified += result.triangles.size() < input.triangles.size() ? 1 : 0;
    std::set<Point> locked;
    for (std::size_t p = 0; p < input.positions.size(); ++p) {
      if (input.is_locked[p] != 0) locked.insert(point(input.positions[p]));
    }
    const std::size_t stride = input.layout.stride();
    if (stride == 0) continue;
    const auto before = wedges_at(input, locked, stride), after = wedges_at(result, locked, stride);
    ASSERT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()))
        << "soup " << i << ": a locked vertex has attributes of another";
    ASSERT_EQ(count_torn(input, result, locked), 0U) << "soup " << i;
  }
  EXPECT_GT(simplified, kSoups / 2);
}

/// Random surfaces proper: patches of a torus with random holes and locks.
TEST(OpenMeshDecimater, PatchesWithHolesKeepTheContract) {
  SplitMix64 random(11);
  const SimplifyInput whole = as_input(lab::make_torus(24, 12));
  for (int i = 0; i < (test::kIsSanitized ? 20 : 60); ++i) {
    SimplifyInput input = whole;
    std::vector<WedgeTriangle> kept;
    const std::uint64_t holes = random.below(6);
    for (const WedgeTriangle& t : input.triangles) {
      if (random.below(12) >= holes) kept.push_back(t);
    }
    input.triangles = kept;
    input.triangle_material.assign(kept.size(), 0);
    const std::uint64_t locks = random.below(4);
    for (std::uint8_t& lock : input.is_locked) lock = random.below(8) < locks ? 1 : 0;
    const SimplifyResult result =
        simplify(input, static_cast<std::uint32_t>(random.below(kept.size() + 1)), i % 3 == 0);
    ASSERT_EQ(fault_of(input, result), "") << "patch " << i;
  }
}

TEST(OpenMeshDecimater, ItGivesTheSameEachTime) {
  AttributeLayout layout;
  layout.has_normal = true;
  const scene::Primitive rock = lab::with_smooth_normals(lab::make_rock(16));
  const SimplifyInput one = as_input(rock, layout), other = as_input(rock, layout);  // at other addresses
  const SimplifyResult first = halve(one), second = halve(other);
  EXPECT_EQ(first.triangles, second.triangles);
  EXPECT_EQ(first.wedge_attributes, second.wedge_attributes);
  EXPECT_EQ(first.positions, second.positions);
  EXPECT_EQ(first.quadric_error, second.quadric_error);
}

TEST(OpenMeshDecimater, EverythingLockedIsLeftAloneAndSaysSo) {
  SimplifyInput input = as_input(lab::make_sphere(6));
  input.is_locked.assign(input.is_locked.size(), 1);
  const SimplifyResult result = halve(input);
  EXPECT_EQ(result.triangles.size(), input.triangles.size());
  EXPECT_EQ(result.reason, StuckReason::kLocked);
}

TEST(OpenMeshDecimater, LoosePiecesAreAReasonAndNothingIsFine) {
  const SimplifyInput pieces = as_input(lab::make_loose_pieces(90));
  EXPECT_EQ(simplify(pieces, 4).reason, StuckReason::kComponents);
  SimplifyInput nothing;
  EXPECT_TRUE(simplify(nothing, 0).triangles.empty());
  SimplifyInput flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.is_locked.assign(3, 0);
  for (std::uint32_t v = 0; v < 3; ++v) {
    flat.witnesses.push_back({{flat.positions[v]}, 1});
    flat.wedge_position.push_back(v);
  }
  flat.is_wedge_shared.assign(3, 0);
  flat.triangles = {{0, 1, 2}};
  flat.triangle_material = {0};
  EXPECT_EQ(fault_of(flat, simplify(flat, 0)), "");
}

}  // namespace
}  // namespace meshlode::lab
