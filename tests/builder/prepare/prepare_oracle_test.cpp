// SPDX-License-Identifier: GPL-3.0-or-later
// Welding and needles against their definitions: what is equal is one and nothing else is, whatever the order; and a
// needle's corner goes to the nearest free cell that the grid's own bound allows, if there is one.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/prepare/corners.h"
#include "builder/prepare/median_edge.h"
#include "builder/prepare/prepare.h"
#include "builder/prepare/separate_needles.h"
#include "builder/prepare/zero_area.h"
#include "lab/samples/samples.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::RandomSource;
using Spot = std::tuple<double, double, double>;
using GridCell = std::tuple<int, int, int>;

/// A corner as the source has it: where, on which grid point, and its attributes' bits.
struct SourceCorner {
  Spot exact;
  GridCell cell;
  std::vector<std::uint32_t> attributes;
  auto operator<=>(const SourceCorner&) const = default;
};
/// Beginning with the least corner; then the material.
using SourceTriangle = std::pair<std::array<SourceCorner, 3>, std::uint32_t>;

Spot spot(const Vec3d& p) {
  return {p.x, p.y, p.z};
}
GridCell grid_cell(const Vec3i& q) {
  return {q.x, q.y, q.z};
}
std::uint32_t bits_of(float value) {
  return std::bit_cast<std::uint32_t>(value == 0.0F ? 0.0F : value);
}

/// Two primitives of few places and few attribute values, so that equal corners and equal triangles come up; the second
/// has neither colours nor its first set of coordinates.
scene::SourceMesh random_mesh(RandomSource& random, double unit) {
  const auto value = [&] { return std::array{0.0F, -0.0F, 0.25F, 1.0F}[random.below(4)]; };
  scene::SourceMesh mesh;
  for (const bool is_first : {true, false}) {
    scene::Primitive primitive;
    primitive.material = MaterialId(is_first ? 3U : 1U + random.below(3));
    const std::uint32_t count = 12 + random.below(30);
    for (std::uint32_t v = 0; v < count; ++v) {
      Vec3d p;
      // On a lattice of four points a side, or within a thousandth of a step beside one of those.
      for (int k = 0; k < 3; ++k) p[k] = unit * (std::floor(4.0 * random.unit()) + (random.chance(0.2) ? 1e-9 : 0.0));
      primitive.positions.push_back(random.chance(0.1) ? -p : p);
      primitive.normals.push_back(Vec3f(value(), value(), 1.0F));
      if (is_first) primitive.uvs[0].push_back(Vec2f(value(), value()));
      primitive.uvs[1].push_back(Vec2f(value(), 0.5F));
      if (is_first) primitive.colors.push_back(Vec4f(value(), 1.0F, 1.0F, value()));
    }
    for (std::uint32_t i = 3 * (20 + random.below(60)); i > 0; --i) primitive.indices.push_back(random.below(count));
    mesh.primitives.push_back(std::move(primitive));
  }
  return mesh;
}

AttributeLayout all_attributes() {
  AttributeLayout layout;
  layout.has_normal = true;
  layout.uv_set_count = 2;
  layout.uv_set_source = {1, 0};
  layout.has_color = true;
  return layout;
}

SourceTriangle in_order(std::array<SourceCorner, 3> corners, std::uint32_t material) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return {corners, material};
}

std::vector<SourceTriangle> triangles_of(const scene::SourceMesh& source, const PreparedMesh& mesh) {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> indices;
  std::vector<SourceTriangle> all;
  for (const scene::Primitive& primitive : source.primitives) {
    for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
      std::array<SourceCorner, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = primitive.indices[t + k];
        SourceCorner& corner = corners[k];
        const Vec3d relative = primitive.positions[v] + 0.0 - mesh.origin;
        corner.exact = spot(relative + 0.0);
        corner.cell = grid_cell(mesh.grid.quantize(relative));
        const auto add = [&](float x) { corner.attributes.push_back(bits_of(x)); };
        for (int axis = 0; axis < 3; ++axis) add(primitive.normals[v][axis]);
        for (const std::size_t set : {1U, 0U}) {
          const std::vector<Vec2f>& uvs = primitive.uvs[set];
          for (int axis = 0; axis < 2; ++axis) add(uvs.empty() ? 0.0F : uvs[v][axis]);
        }
        for (int axis = 0; axis < 4; ++axis) add(primitive.colors.empty() ? 1.0F : primitive.colors[v][axis]);
        indices.push_back(static_cast<std::uint32_t>(positions.size()));
        positions.push_back(primitive.positions[v]);
      }
      all.push_back(in_order(corners, primitive.material.value));
    }
  }
  const std::vector<std::uint8_t> is_undrawn = find_undrawn(positions, indices);
  std::vector<SourceTriangle> drawn;
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (is_undrawn[t] == 0) drawn.push_back(all[t]);
  }
  return drawn;
}

SourceTriangle triangle_of(const PreparedMesh& mesh, std::size_t t) {
  const std::size_t stride = mesh.layout.stride();
  std::array<SourceCorner, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t wedge = mesh.triangles[t][k];
    corners[k].exact = spot(mesh.exact_positions[mesh.exact_triangles[t][k]] + 0.0);
    corners[k].cell = grid_cell(mesh.positions[mesh.wedge_position[wedge]]);
    for (std::size_t j = 0; j < stride; ++j)
      corners[k].attributes.push_back(std::bit_cast<std::uint32_t>(mesh.wedge_attributes[wedge * stride + j]));
  }
  return in_order(corners, mesh.triangle_material[t]);
}

TEST(PrepareOracle, IsTheSourceWithWhatIsEqualMadeOne) {
  RandomSource random(181);
  std::uint64_t duplicates = 0, collapsed = 0;
  for (int round = 0; round < 300; ++round) {
    const scene::SourceMesh source = random_mesh(random, round % 3 == 0 ? 1.0 : 1e-3);
    PrepareOptions options;
    options.separates_needles = false;               // each vertex on its own point
    if (round % 2 == 1) options.grid_step = 0x1p-2;  // all within a step: triangles collapse
    const auto prepared = prepare_mesh(source, all_attributes(), options);
    ASSERT_TRUE(prepared.ok()) << prepared.error().message();
    const PreparedMesh& mesh = *prepared;
    const std::vector<SourceTriangle> drawn = triangles_of(source, mesh);
    const std::set<SourceTriangle> expected(drawn.begin(), drawn.end());
    std::set<SourceTriangle> found;
    std::uint64_t without_area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const SourceTriangle triangle = triangle_of(mesh, t);
      EXPECT_TRUE(found.insert(triangle).second) << "each once";
      std::array<glm::i64vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = glm::i64vec3(mesh.positions[mesh.wedge_position[mesh.triangles[t][k]]]);
      const glm::i64vec3 u = p[1] - p[0], v = p[2] - p[0];
      without_area += u.y * v.z == u.z * v.y && u.z * v.x == u.x * v.z && u.x * v.y == u.y * v.x ? 1 : 0;
    }
    ASSERT_EQ(found, expected) << "seed 181, round " << round;
    EXPECT_EQ(mesh.dropped_duplicate, drawn.size() - expected.size());
    EXPECT_EQ(mesh.grid_collapsed, without_area);
    EXPECT_EQ(mesh.source_triangles, mesh.dropped_degenerate + drawn.size());
    duplicates += mesh.dropped_duplicate;
    collapsed += without_area;
    // Positions, wedges and exact positions: each once as well.
    std::set<GridCell> cells;
    for (const Vec3i& q : mesh.positions) EXPECT_TRUE(cells.insert(grid_cell(q)).second);
    std::set<std::pair<std::uint32_t, std::vector<std::uint32_t>>> wedges;
    const std::size_t stride = mesh.layout.stride();
    for (std::size_t w = 0; w < mesh.wedge_position.size(); ++w) {
      std::vector<std::uint32_t> attributes;
      for (std::size_t j = 0; j < stride; ++j)
        attributes.push_back(std::bit_cast<std::uint32_t>(mesh.wedge_attributes[w * stride + j]));
      EXPECT_TRUE(wedges.insert({mesh.wedge_position[w], attributes}).second);
    }
    // How far a vertex was moved at most, and the diagonal of what is drawn.
    long double moved2 = 0.0L;
    glm::vec<3, long double> low(1e9L), high(-1e9L);
    for (const auto& [corners, material] : drawn) {
      for (const SourceCorner& corner : corners) {
        const auto [x, y, z] = corner.exact;
        const auto [i, j, k] = corner.cell;
        const glm::vec<3, long double> at(x, y, z), off = glm::vec<3, long double>(mesh.grid.decode({i, j, k})) - at;
        moved2 = std::max(moved2, glm::dot(off, off));
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
    }
    const auto moved = static_cast<double>(std::sqrt(moved2));
    EXPECT_NEAR(mesh.level0_deviation, moved, 1e-15 * moved + 1e-18) << "seed 181, round " << round;
    const auto diagonal = static_cast<double>(std::sqrt(glm::dot(high - low, high - low)));
    EXPECT_NEAR(mesh.diagonal, diagonal, 1e-15 * diagonal + 1e-16) << "seed 181, round " << round;
  }
  EXPECT_GT(duplicates, 100U);
  EXPECT_GT(collapsed, 100U);
}

// The origin lies on the grid, within half a step of the middle of the box, on every axis.
TEST(PrepareOracle, TheOriginIsTheGridPointNearestToTheMiddle) {
  RandomSource random(182);
  for (int round = 0; round < 300; ++round) {
    const Vec3d at = random.in_cube(1000.0), size(random.unit() + 0.1, random.unit() + 0.1, random.unit() + 0.1);
    scene::Primitive shape;
    for (int k = 0; k < 4; ++k) shape.positions.push_back(at + size * Vec3d(k & 1, (k >> 1) & 1, k == 3 ? 1 : 0));
    shape.indices = {0, 1, 2, 1, 3, 2};
    const auto mesh = prepare_mesh(lab::as_mesh(shape), {}, {});
    ASSERT_TRUE(mesh.ok());
    const double step = mesh->grid.step();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(std::floor(mesh->origin[axis] / step), mesh->origin[axis] / step);
      const double middle = at[axis] + 0.5 * size[axis];
      EXPECT_LE(std::fabs(mesh->origin[axis] - middle), 0.5 * step * (1.0 + 1e-9) + 1e-12);
    }
    const auto plan = plan_grid(lab::as_mesh(shape), {});
    ASSERT_TRUE(plan.ok());
    EXPECT_NEAR(plan->largest_side, std::max({size.x, size.y, size.z}), 1e-12);
    EXPECT_EQ(plan->grid.step(), step);
  }
}

double distance2_in_steps(const Vec3d& p, double step, const GridCell& cell) {
  const auto [x, y, z] = cell;
  const Vec3d off = p / step - Vec3d(x, y, z);
  return glm::dot(off, off);
}

struct NeedleEdge {
  std::uint32_t a, b;
};

/// Edges within one cell whose third corner is four cells away or more.
std::vector<NeedleEdge> needle_edges(const std::vector<Vec3d>& positions, const std::vector<std::uint32_t>& triangles,
                                     const std::vector<Vec3i>& cells) {
  std::vector<NeedleEdge> needles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::size_t t = i - i % 3;
    const std::uint32_t a = triangles[i], b = triangles[t + (i + 1) % 3], tip = triangles[t + (i + 2) % 3];
    const Vec3i along = glm::abs(cells[tip] - cells[a]);
    if (cells[a] == cells[b] && positions[a] != positions[b] && std::max({along.x, along.y, along.z}) >= 4)
      needles.push_back({a, b});
  }
  return needles;
}

/// Cells beside its own that a corner may move to: away from the other corner, and within the grid's bound.
std::vector<GridCell> allowed_cells(const std::vector<Vec3d>& positions, double step, const Vec3i& cell,
                                    std::uint32_t v, std::uint32_t other) {
  std::vector<GridCell> allowed;
  for (int axis = 0; axis < 3; ++axis) {
    const int side = positions[v][axis] / step - cell[axis] > 0.0 ? 1 : -1;
    if (!((positions[v][axis] - positions[other][axis]) * side > 0.0)) continue;
    Vec3i to = cell;
    to[axis] += side;
    if (std::abs(to[axis]) <= format::kMaxGridCoordinate &&
        distance2_in_steps(positions[v], step, grid_cell(to)) <= 0.75)
      allowed.push_back(grid_cell(to));
  }
  return allowed;
}

TEST(PrepareOracle, ANeedleAloneGoesToTheNearestCellThatIsAllowed) {
  RandomSource random(183);
  int moved = 0, stayed = 0;
  for (int round = 0; round < 4000; ++round) {
    format::PositionGrid grid;
    grid.log2 = static_cast<int>(random.below(40)) - 20;
    const double step = grid.step();
    const Vec3d cell = Vec3d(std::floor(random.between(-50.0, 50.0)), std::floor(random.between(-50.0, 50.0)), 3.0);
    const double width = random.chance(0.3) ? 0.02 : 0.499;
    std::vector<Vec3d> positions{(cell + random.in_cube(width)) * step, (cell + random.in_cube(width)) * step};
    Vec3d tip = cell;
    tip[round % 3] += round % 2 == 0 ? 4.0 : -4.0;
    positions.push_back(tip * step);
    std::vector<std::uint32_t> triangles{0, 1, 2};
    std::rotate(triangles.begin(), triangles.begin() + round % 3, triangles.end());
    std::vector<Vec3i> cells;
    for (const Vec3d& p : positions) cells.push_back(grid.quantize(p));
    ASSERT_EQ(cells[0], cells[1]);
    std::optional<std::pair<double, GridCell>> nearest;
    std::uint32_t who = 0;
    for (const std::uint32_t v : {0U, 1U}) {
      for (const GridCell& to : allowed_cells(positions, step, cells[v], v, 1 - v)) {
        const std::pair<double, GridCell> one{distance2_in_steps(positions[v], step, to), to};
        if (!nearest || one.first < nearest->first) {
          nearest = one;
          who = v;
        }
      }
    }
    const std::vector<Vec3i> before = cells;
    const std::uint64_t kept = separate_needles(positions, triangles, grid, cells);
    ASSERT_EQ(kept, nearest ? 1U : 0U) << "seed 183, round " << round;
    for (std::uint32_t v = 0; v < 3; ++v) {
      ASSERT_EQ(grid_cell(cells[v]), nearest && v == who ? nearest->second : grid_cell(before[v]))
          << "seed 183, round " << round;
    }
    ++(nearest ? moved : stayed);
    // One cell nearer, and it is no needle.
    positions[2] = (tip - (tip - cell) * 0.25) * step;
    cells = {before[0], before[1], grid.quantize(positions[2])};
    ASSERT_EQ(separate_needles(positions, triangles, grid, cells), 0U) << "seed 183, round " << round;
    ASSERT_EQ(cells[0], cells[1]);
  }
  EXPECT_GT(moved, 1000);
  EXPECT_GT(stayed, 300);
}

TEST(PrepareOracle, NeedlesAmongOthersMoveOnlyToFreeCellsAndWhereverTheyCan) {
  RandomSource random(184);
  std::uint64_t moved = 0, stayed = 0;
  for (int round = 0; round < 300; ++round) {
    format::PositionGrid grid;
    const double step = grid.step();
    // Crowded: corners within three cells a side, tips ten cells above.
    std::vector<Vec3d> positions;
    std::vector<std::uint32_t> triangles;
    const std::uint32_t count = 5 + random.below(20);
    for (std::uint32_t n = 0; n < count; ++n) {
      const Vec3d cell(random.below(3), random.below(3), random.below(2));
      for (int k = 0; k < 2; ++k) positions.push_back(cell + random.in_cube(0.499));
      positions.push_back(Vec3d(random.below(3), random.below(3), 12.0));
      for (std::uint32_t k = 0; k < 3; ++k) triangles.push_back(3 * n + k);
      if (n > 0 && random.chance(0.3)) positions[3 * n] = positions[3 * random.below(n)];  // vertices in one place
    }
    positions.push_back(Vec3d(1.0, 1.0, 1.0));  // used by nobody
    std::vector<Vec3i> cells;
    for (const Vec3d& p : positions) cells.push_back(grid.quantize(p));
    const std::vector<Vec3i> before = cells;
    const std::vector<NeedleEdge> needles = needle_edges(positions, triangles, cells);
    const std::uint64_t kept = separate_needles(positions, triangles, grid, cells);
    std::set<GridCell> taken;
    std::map<Spot, GridCell> of_position;
    for (std::uint32_t v = 0; v + 1 < positions.size(); ++v) {
      taken.insert(grid_cell(before[v]));
      taken.insert(grid_cell(cells[v]));
      const auto [at, is_new] = of_position.try_emplace(spot(positions[v]), grid_cell(cells[v]));
      ASSERT_EQ(at->second, grid_cell(cells[v])) << "one place, one cell: seed 184, round " << round;
      if (cells[v] == before[v]) continue;
      ++moved;
      const Vec3i way = glm::abs(cells[v] - before[v]);
      ASSERT_EQ(way.x + way.y + way.z, 1);
      ASSERT_LE(distance2_in_steps(positions[v], step, grid_cell(cells[v])), 0.75);
      for (std::uint32_t other = 0; other + 1 < positions.size(); ++other) {
        ASSERT_NE(cells[v], before[other]) << "the cell was free";
        ASSERT_TRUE(positions[other] == positions[v] || cells[v] != cells[other]) << "and nobody else went there";
      }
    }
    ASSERT_EQ(cells.back(), before.back());
    std::uint64_t apart = 0;
    for (const NeedleEdge& needle : needles) {
      if (cells[needle.a] != cells[needle.b]) {
        ++apart;
        continue;
      }
      ++stayed;
      for (const auto& [v, other] : {std::pair{needle.a, needle.b}, std::pair{needle.b, needle.a}}) {
        for (const GridCell& to : allowed_cells(positions, step, before[v], v, other))
          ASSERT_TRUE(taken.count(to) != 0) << "seed 184, round " << round;
      }
    }
    ASSERT_EQ(kept, apart) << "seed 184, round " << round;
  }
  EXPECT_GT(moved, 500U);
  EXPECT_GT(stayed, 300U);
}

TEST(PrepareOracle, ANeedleAtTheEndOfTheGridStaysOnIt) {
  format::PositionGrid grid;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      Vec3d end(0.0), inner(0.0);
      end[axis] = sign * (format::kMaxGridCoordinate + 0.45);
      inner[axis] = sign * (format::kMaxGridCoordinate + 0.4);
      const std::vector<Vec3d> positions{end, inner, Vec3d(0.0)};
      const std::vector<std::uint32_t> triangles{0, 1, 2};
      std::vector<Vec3i> cells;
      for (const Vec3d& p : positions) cells.push_back(grid.quantize(p));
      ASSERT_EQ(std::abs(cells[0][axis]), format::kMaxGridCoordinate);
      EXPECT_EQ(separate_needles(positions, triangles, grid, cells), 0U);
      EXPECT_EQ(cells[0], cells[1]);
    }
  }
}

// The last extent that 24 bits hold is taken, and the next double is not; so it is with the range of steps.
TEST(GridLimits, AreTheLastThatFit) {
  for (const std::uint32_t mantissa : {1U, 3U, 255U}) {
    PrepareOptions options;
    options.grid_step = mantissa * 0x1p-5;
    const double most = std::floor(static_cast<double>(format::kMaxGridCoordinate) / mantissa) * options.grid_step;
    EXPECT_TRUE(choose_grid(most, 2.0 * most, 0.0, options).ok()) << mantissa;
    EXPECT_FALSE(choose_grid(std::nextafter(most, 2.0 * most), 2.0 * most, 0.0, options).ok()) << mantissa;
  }
  for (const auto& [log2, is_held] :
       {std::pair{-1000, true}, std::pair{-1001, false}, std::pair{1000, true}, std::pair{1001, false}}) {
    PrepareOptions options;
    options.grid_step = std::ldexp(1.0, log2);
    EXPECT_EQ(choose_grid(options.grid_step, 2.0 * options.grid_step, 0.0, options).ok(), is_held) << log2;
  }
  constexpr double kMost = format::kMaxGridCoordinate / 4.0;
  for (const double half : {kMost, std::nextafter(kMost, HUGE_VAL)}) {
    const auto grid = choose_grid(half, 1.5 * half, 1e-15 * half, {});
    ASSERT_TRUE(grid.ok());
    EXPECT_EQ(grid->log2, half > kMost ? 1 : 0) << half;
  }
  EXPECT_LE(choose_grid(1.7e308, 1.7e308, 1.0, {})->log2, 1000) << "however large";
  EXPECT_GE(choose_grid(1e-305, 1e-305, 1e-307, {})->log2, -1000) << "however small";
}

scene::Primitive one_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  scene::Primitive shape;
  shape.positions = {a, b, c};
  shape.indices = {0, 1, 2};
  return shape;
}

TEST(GridLimits, OfTheFormatAndOfSquaresAreTheLastThatFit) {
  const auto refusal = [](double size, double step) {
    PrepareOptions options;
    options.grid_step = step;
    const auto mesh =
        prepare_mesh(lab::as_mesh(one_triangle({0, 0, 0}, {size, 0, 0}, {0, size * 0x1p-20, 0})), {}, options);
    return mesh.ok() ? std::string() : mesh.error().detail;
  };
  EXPECT_EQ(refusal(0x1p-110, 0x1p-126), "");
  EXPECT_NE(refusal(0x1p-110, 0x1p-127).find("leaves the range of floats"), std::string::npos);
  EXPECT_EQ(refusal(0x1p115, 0x1p104), "");
  EXPECT_NE(refusal(0x1p115, 0x1p105).find("leaves the range of floats"), std::string::npos);
  // So flat that the diagonal is the longest side to the last bit: at 2^-500 its square is whole, and the grid is what
  // has no such step.
  const auto detail = [](double size) {
    return prepare_mesh(lab::as_mesh(one_triangle({0, 0, 0}, {size, 0, 0}, {0, size * 0x1p-40, 0})), {}, {})
        .error()
        .detail;
  };
  for (const double size : {0x1p-500, 0x1.8p-500}) EXPECT_NE(detail(size).find("step"), std::string::npos) << size;
  for (const double size : {std::nextafter(0x1p-500, 0.0), 0x1.8p-501})
    EXPECT_NE(detail(size).find("vanishes"), std::string::npos) << size;
}

// Of a given step eight bits are kept, odd, so that there is one spelling.
TEST(GridLimits, AGivenStepHasAMantissaOfEightBits) {
  RandomSource random(188);
  for (int round = 0; round < 1000; ++round) {
    PrepareOptions options;
    options.grid_step = random.log_between(1e-6, 1e6);
    const auto grid = choose_grid(options.grid_step, options.grid_step, 0.0, options);
    ASSERT_TRUE(grid.ok());
    EXPECT_EQ(grid->mantissa % 2, 1U) << "seed 188, round " << round;
    EXPECT_LT(grid->mantissa, 256U) << "seed 188, round " << round;
    EXPECT_NEAR(grid->step(), options.grid_step, options.grid_step * 0x1.001p-8) << "seed 188, round " << round;
  }
}

// A step that was given holds needles in place, however small it is.
TEST(PrepareOracle, OnAGivenStepNoNeedleMoves) {
  for (const double unit : {1.0, 0x1p-60}) {
    PrepareOptions options;
    options.grid_step = unit * 0x1p-4;
    const auto mesh =
        prepare_mesh(lab::as_mesh(one_triangle(Vec3d(0.01, 0.01, 0.0) * unit, Vec3d(0.02, 0.015, 0.0) * unit,
                                               Vec3d(0.0, 0.0, 9.0) * unit)),
                     {}, options);
    ASSERT_TRUE(mesh.ok());
    EXPECT_EQ(mesh->grid_collapsed, 1U) << unit;
  }
}

// Corners that are level along an axis do not part along it: nothing says which way.
TEST(PrepareOracle, LevelCornersDoNotPartAlongTheirAxis) {
  RandomSource random(185);
  for (int round = 0; round < 600; ++round) {
    format::PositionGrid grid;
    Vec3d a = random.in_cube(0.49), b = random.in_cube(0.49);
    const int level = round % 3, other = (round + 1) % 3;
    b[level] = a[level];
    if (round % 2 == 0) b[other] = a[other];
    const std::vector<Vec3d> positions{a, b, Vec3d(0.0, 0.0, 9.0)};
    const std::vector<std::uint32_t> triangles{0, 1, 2};
    std::vector<Vec3i> cells(2, Vec3i(0));
    cells.push_back(Vec3i(0, 0, 9));
    (void)separate_needles(positions, triangles, grid, cells);
    for (const std::uint32_t v : {0U, 1U}) {
      ASSERT_EQ(cells[v][level], 0) << "seed 185, round " << round;
      ASSERT_TRUE(round % 2 == 1 || cells[v][other] == 0) << "seed 185, round " << round;
    }
  }
}

// Lengths scale by powers of two to the last bit, of short lists and long ones.
TEST(MedianEdgeScale, IsExactUnderPowersOfTwo) {
  RandomSource random(186);
  for (const std::uint32_t count : {5U, 30000U}) {
    scene::Primitive shape;
    for (std::uint32_t t = 0; t < count; ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        shape.positions.push_back(random.in_cube(1.0));
        shape.indices.push_back(3 * t + k);
      }
    }
    const double median = median_edge_length(gather_corners(lab::as_mesh(shape), {}));
    for (const double scale : {0x1p-100, 0x1p-30, 0x1p20}) {
      EXPECT_EQ(median_edge_length(gather_corners(lab::as_mesh(lab::scaled(shape, scale)), {})), median * scale);
    }
  }
}

// Normals that the file lacks have length one, of triangles without area and of such as overflow too; 0 has no sign.
TEST(CornersOfAnyTriangle, HaveANormalOfLengthOneAndNoNegativeZero) {
  AttributeLayout layout;
  layout.has_normal = true;
  for (const double size : {0.0, 1e-300, 1.0, 1e150, 1e300}) {
    const Corners corners =
        gather_corners(lab::as_mesh(one_triangle({-0.0, -0.0, -0.0}, {size, -0.0, 0.0}, {-0.0, size, size})), layout);
    for (std::uint32_t v = 0; v < 3; ++v) {
      const float* n = corners.attributes_of(v, 3);
      EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0F, 1e-6F) << size;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_FALSE(std::signbit(corners.positions[v][axis]) && corners.positions[v][axis] == 0.0) << size;
        EXPECT_FALSE(std::signbit(n[axis]) && n[axis] == 0.0F) << size;
      }
    }
  }
}

// Multiples of one direction lie on a line, though neither their differences nor the products of these are exact; half
// a bit aside they do not.
TEST(ZeroAreaRounding, DecidesWhereDifferencesAndProductsRound) {
  RandomSource random(187);
  for (int round = 0; round < 20000; ++round) {
    Vec3d direction;
    for (int axis = 0; axis < 3; ++axis)
      direction[axis] = (random.chance(0.5) ? 1.0 : -1.0) * std::floor(random.between(0x1p47, 0x1p50));
    const double unit = std::ldexp(1.0, round % 4 == 0   ? -1000
                                        : round % 4 == 1 ? -560
                                                         : static_cast<int>(random.below(300)) - 150);
    const std::array<double, 6> factors{-7.0, -5.0, -3.0, 3.0, 5.0, 7.0};
    std::array<Vec3d, 3> p;
    const std::uint32_t first = random.below(6);
    for (std::uint32_t k = 0; k < 3; ++k) p[k] = direction * (factors[(first + k * (1 + round % 2)) % 6] * unit);
    ASSERT_TRUE(are_collinear(p[0], p[1], p[2])) << "seed 187, round " << round;
    const std::uint32_t moved = random.below(3), axis = random.below(3);
    p[moved][static_cast<int>(axis)] = std::nextafter(p[moved][static_cast<int>(axis)], HUGE_VAL);
    ASSERT_FALSE(are_collinear(p[0], p[1], p[2])) << "seed 187, round " << round;
  }
}

}  // namespace
}  // namespace meshlode::builder
