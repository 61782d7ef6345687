// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/prepare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "builder/gap_label.h"
#include "builder/prepare/corners.h"
#include "builder/prepare/median_edge.h"
#include "builder/prepare/open_border.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

PreparedMesh prepare(const scene::Primitive& shape, const PrepareOptions& options = {},
                     const AttributeLayout& layout = {}) {
  Result<PreparedMesh> mesh = prepare_mesh(lab::as_mesh(shape), layout, options);
  EXPECT_TRUE(mesh.ok()) << (mesh.ok() ? "" : mesh.error().message());
  return mesh.ok() ? std::move(*mesh) : PreparedMesh{};
}

/// The same shape with vertices and triangles in another order, and corners rotated.
scene::Primitive shuffled(const scene::Primitive& shape) {
  scene::Primitive out;
  const std::size_t n = shape.positions.size();
  std::vector<std::uint32_t> to(n);
  std::size_t stride = 7919;
  while (std::gcd(stride, n) != 1) ++stride;
  for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<std::uint32_t>(i * stride % n);
  out.positions.resize(n);
  for (std::size_t i = 0; i < n; ++i) out.positions[to[i]] = shape.positions[i];
  for (std::size_t t = shape.indices.size() / 3; t-- > 0;) {
    for (std::size_t k = 0; k < 3; ++k) out.indices.push_back(to[shape.indices[3 * t + (k + t) % 3]]);
  }
  return out;
}

TEST(Prepare, RenumberingTheInputChangesNothing) {
  const scene::Primitive shape = lab::make_torus(40, 20);
  const PreparedMesh a = prepare(shape);
  const PreparedMesh b = prepare(shuffled(shape));
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.wedge_position, b.wedge_position);
}

/// Small triangles first, then large ones: a sample in the file's order sees a share of each that the order decides.
scene::Primitive two_sizes(std::uint32_t pairs) {
  scene::Primitive shape;
  for (std::uint32_t t = 0; t < 2 * pairs; ++t) {
    const double size = t < pairs ? 1.0 + 1e-5 * t : 64.0 + 1e-3 * t;
    const Vec3d at(100.0 * (t % 200), 100.0 * std::floor(t / 200.0), 0.0);
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    shape.positions.insert(shape.positions.end(), {at, at + Vec3d(size, 0, 0), at + Vec3d(0, size, 0)});
    shape.indices.insert(shape.indices.end(), {first, first + 1, first + 2});
  }
  return shape;
}

TEST(Prepare, RenumberingALargeInputDoesNotChangeTheGridEither) {
  const scene::Primitive shape = two_sizes(22500);
  const auto grid = plan_grid(lab::as_mesh(shape), {}), of_shuffled = plan_grid(lab::as_mesh(shuffled(shape)), {});
  ASSERT_TRUE(grid.ok() && of_shuffled.ok());
  EXPECT_EQ(grid->median_edge, of_shuffled->median_edge);
  EXPECT_EQ(grid->grid.step(), of_shuffled->grid.step());
}

TEST(MedianEdge, IsThatOfAllEdgesThatHaveALength) {
  for (const std::uint32_t pairs : {0U, 1U, 7U, 5000U, 20000U}) {
    scene::Primitive shape = two_sizes(pairs);
    shape.indices.insert(shape.indices.end(), 9 * std::size_t{pairs}, 0);  // edges without a length do not count
    std::vector<double> lengths;
    for (std::size_t i = 0; i < shape.indices.size(); ++i) {
      const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
      const double length = glm::length(shape.positions[shape.indices[next]] - shape.positions[shape.indices[i]]);
      if (length > 0.0) lengths.push_back(length);
    }
    std::sort(lengths.begin(), lengths.end());
    const double expected = lengths.empty() ? 0.0 : lengths[lengths.size() / 2];
    const double median = median_edge_length(gather_corners(lab::as_mesh(shape), {}));
    EXPECT_LE(median, expected * (1.0 + 1e-15)) << pairs;
    EXPECT_GE(median, expected * (1.0 - 0x1p-21)) << pairs;
    EXPECT_EQ(std::ilogb(median), std::ilogb(expected)) << pairs;
    if (pairs < 5000) {
      EXPECT_NEAR(median, expected, 1e-15 * expected) << pairs << ": only of large meshes is it rounded";
    }
  }
}

AttributeLayout with_normals() {
  AttributeLayout layout;
  layout.has_normal = true;
  return layout;
}

TEST(Corners, WhereNormalsAreMissingEachTriangleGetsItsOwnOfLengthOne) {
  for (const double scale : {1e-9, 1.0, 1e9}) {
    const scene::Primitive shape = lab::scaled(lab::make_torus(12, 8), scale);
    const Corners corners = gather_corners(lab::as_mesh(shape), with_normals());
    ASSERT_EQ(corners.positions.size(), shape.indices.size()) << "each corner is a vertex of its own";
    for (std::size_t i = 0; i < shape.indices.size(); ++i) {
      ASSERT_EQ(corners.triangles[i], i);
      ASSERT_EQ(corners.positions[i], shape.positions[shape.indices[i]]);
      const std::size_t t = i / 3 * 3;
      const Vec3d& a = shape.positions[shape.indices[t]];
      const Vec3d u = (shape.positions[shape.indices[t + 1]] - a) / scale,
                  v = (shape.positions[shape.indices[t + 2]] - a) / scale;
      const float* n = corners.attributes_of(static_cast<std::uint32_t>(i), 3);
      EXPECT_LT(glm::length(Vec3d(n[0], n[1], n[2]) - glm::normalize(glm::cross(u, v))), 1e-6) << scale;
    }
  }
}

/// Whether `a` comes before `b` along the Z-curve over cubes of 8 grid points, with x least and z most significant: by
/// the axis whose coordinates differ in the highest bit (Chan 2002). Within a cube by x, y and z.
bool is_before_on_z_curve(const Vec3i& a, const Vec3i& b) {
  const auto bits = [](int value) { return static_cast<std::uint32_t>(value + (1 << 23)) >> 3U; };
  int decisive = 2;
  std::uint32_t most = 0;
  for (const int axis : {2, 1, 0}) {
    const std::uint32_t differs = bits(a[axis]) ^ bits(b[axis]);
    if (most < differs && most < (most ^ differs)) {
      decisive = axis;
      most = differs;
    }
  }
  if (most != 0) return bits(a[decisive]) < bits(b[decisive]);
  return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

TEST(Prepare, PositionsStandInZOrder) {
  for (const scene::Primitive& shape : {lab::make_torus(40, 20), lab::make_far_plane(32)}) {
    const PreparedMesh mesh = prepare(shape);
    for (std::size_t i = 1; i < mesh.positions.size(); ++i) {
      ASSERT_TRUE(is_before_on_z_curve(mesh.positions[i - 1], mesh.positions[i])) << i;
    }
  }
}

TEST(Prepare, WeldsVerticesThatAreOneInSpace) {
  const scene::Primitive shared = lab::make_sphere(6);
  const PreparedMesh mesh = prepare(lab::with_split_normals(shared));
  EXPECT_EQ(mesh.positions.size(), shared.positions.size());
}

TEST(Prepare, KeepsWedgesApartWhereAttributesDiffer) {
  AttributeLayout layout;
  layout.has_normal = true;
  const scene::Primitive shared = lab::make_sphere(6);
  const PreparedMesh mesh = prepare(lab::with_split_normals(shared), {}, layout);
  EXPECT_EQ(mesh.positions.size(), shared.positions.size());
  EXPECT_GT(mesh.wedge_position.size(), 2 * mesh.positions.size());
}

TEST(Prepare, CountsDuplicatesByWindingAndKeepsTheRest) {
  scene::Primitive shape;
  shape.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  shape.indices = {0, 1, 2, 1, 2, 0, 0, 2, 1};  // the same turned, and the other side
  const PreparedMesh mesh = prepare(shape);
  EXPECT_EQ(mesh.source_triangles, 3U);
  EXPECT_EQ(mesh.dropped_duplicate, 1U);
  EXPECT_EQ(mesh.triangles.size(), 2U);
}

TEST(Prepare, CountsTrianglesWithoutAreaAndKeepsThoseAlongAnEdge) {
  scene::Primitive shape;
  shape.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {0, 0, 0}, {2, 0, 0}};
  shape.indices = {0, 1, 2, 0, 4, 1, 1, 1, 2, 0, 3, 1, 0, 1, 5};
  const PreparedMesh mesh = prepare(shape);
  EXPECT_EQ(mesh.dropped_degenerate, 3U) << "two corners in one place, and one that sticks out";
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.grid_collapsed, 1U) << "the one along the edge has no area but its border is not zero";
  EXPECT_DOUBLE_EQ(mesh.diagonal, std::sqrt(2.0)) << "what is no part of the source is not in its box";
}

TEST(Prepare, ATriangleWithoutAreaFarAwayDoesNotCoarsenTheGrid) {
  scene::Primitive shape = lab::make_sphere(5);
  const PreparedMesh before = prepare(shape);
  shape.positions.push_back({1e300, 1e300, 0});
  shape.positions.push_back({1e300, 1e300, 0});
  for (const std::uint32_t v : {0U, 1U, 2U}) shape.indices.push_back(shape.indices[0] + 0 * v);
  const auto first = static_cast<std::uint32_t>(shape.positions.size() - 2);
  for (const std::uint32_t v : {0U, first, first + 1}) shape.indices.push_back(v);
  const PreparedMesh after = prepare(shape);
  EXPECT_EQ(after.dropped_degenerate, 2U);
  EXPECT_EQ(before.positions, after.positions);
  EXPECT_EQ(before.diagonal, after.diagonal);
}

/// A sheet from which a needle stands out: 1 long, and narrower than a cell of the grid, beside other needles' corners.
scene::Primitive sheet_with_needles(int count) {
  scene::Primitive shape = lab::make_plane(8);
  const auto at = [&](double x, double y, double z) {
    shape.positions.emplace_back(x, y, z);
    return static_cast<std::uint32_t>(shape.positions.size() - 1);
  };
  for (int i = 0; i < count; ++i) {
    const double x = 0.1 + 0.01 * i;
    const std::uint32_t a = at(x, 0.5, 0.0);
    const std::uint32_t b = at(x + 3e-6, 0.5 + 1e-6 * (i % 3), 0.0);
    const std::uint32_t tip = at(x, 0.5, 1.0);
    for (const std::uint32_t v : {a, b, tip}) shape.indices.push_back(v);
  }
  return shape;
}

TEST(Prepare, NeedlesNarrowerThanACellKeepTheirTips) {
  const scene::Primitive shape = sheet_with_needles(20);
  const PreparedMesh mesh = prepare(shape);
  ASSERT_GT(mesh.grid.step(), 3e-6) << "or the test says nothing";
  EXPECT_LE(mesh.grid_collapsed, 6U) << "where no corner has a free cell within the grid's bound";
  EXPECT_LE(mesh.level0_deviation, mesh.grid.step() * std::sqrt(0.75) * (1 + 1e-12)) << "the grid's own bound";
  const PreparedMesh other = prepare(shuffled(shape));
  EXPECT_EQ(mesh.positions, other.positions);
  EXPECT_EQ(mesh.triangles, other.triangles);
}

TEST(Prepare, NeedlesOfMeshesThatAbutStayOnTheirGridPoints) {
  PrepareOptions options;
  options.grid_step = 1.0 / 1024;
  const PreparedMesh mesh = prepare(sheet_with_needles(4), options);
  EXPECT_EQ(mesh.grid_collapsed, 4U);
}

TEST(Prepare, NegativeZeroIsZero) {
  scene::Primitive shape;
  shape.positions = {{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {0, -1, 0}};
  shape.indices = {0, 1, 2, 3, 4, 1};
  EXPECT_EQ(prepare(shape).positions.size(), 4U);
}

TEST(Prepare, MovesNoVertexFartherThanItSays) {
  for (const double scale : {1e-6, 1.0, 1e9}) {
    const scene::Primitive shape = lab::scaled(lab::make_sphere(9), scale);
    const PreparedMesh mesh = prepare(shape);
    EXPECT_LE(mesh.level0_deviation, 2.5e-5 * mesh.diagonal * (1 + 1e-12));
    EXPECT_GT(mesh.level0_deviation, 0.0);
    for (const Vec3d& p : shape.positions) {
      double best = std::numeric_limits<double>::infinity();
      for (const Vec3i& q : mesh.positions) {
        best = std::min(best, glm::distance(mesh.origin + mesh.grid.decode(q), p));
      }
      EXPECT_LE(best, mesh.level0_deviation * (1 + 1e-9));
    }
  }
}

TEST(Prepare, KeepsTheFeaturesOfAMeshFarAway) {
  const scene::Primitive shape = lab::make_far_plane(32);  // bumps of 1e-3, a million units out
  const PreparedMesh mesh = prepare(shape);
  EXPECT_EQ(mesh.positions.size(), 33U * 33U);
  EXPECT_LT(mesh.level0_deviation, 1e-4);
  EXPECT_EQ(mesh.grid_collapsed, 0U);
}

TEST(Prepare, MeshesOfOneStepAbut) {
  // Two boxes of a kit that share a face at x = 1: its vertices have the same places in object space, to the bit.
  PrepareOptions options;
  options.grid_step = 0.01;
  const scene::Primitive left = lab::make_cube(4, 1.0);
  scene::Primitive right = left;
  for (Vec3d& p : right.positions) p.x += 2.0;
  const auto face = [](const PreparedMesh& mesh) {
    std::vector<std::array<double, 3>> points;
    for (const Vec3i& q : mesh.positions) {
      const Vec3d p = mesh.origin + mesh.grid.decode(q);
      if (std::abs(p.x - 1.0) < 0.02) points.push_back({p.x, p.y, p.z});
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  const auto a = face(prepare(left, options));
  EXPECT_EQ(a.size(), 25U);
  EXPECT_EQ(a, face(prepare(right, options)));
}

TEST(Prepare, RefusesAGridThatNeedsMoreThan24Bits) {
  PrepareOptions options;
  options.grid_step = 1e-9;
  const auto mesh = prepare_mesh(lab::as_mesh(lab::make_cube(2)), {}, options);
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, ErrorCode::kUnsupported);
}

TEST(Prepare, RefusesExtentsWhoseSquareADoubleCannotHold) {
  // 1e-163 squared is no longer a normal double, 1e-200 squared is zero: neither may become a mesh of one point.
  for (const double scale : {1e-300, 1e-200, 1e-163, 1e-155, 1e160, 1e200}) {
    const auto mesh = prepare_mesh(lab::as_mesh(lab::scaled(lab::make_cube(2), scale)), {}, {});
    ASSERT_FALSE(mesh.ok()) << scale;
    EXPECT_EQ(mesh.error().code, ErrorCode::kUnsupported) << scale;
    EXPECT_FALSE(plan_grid(lab::as_mesh(lab::scaled(lab::make_cube(2), scale)), {}).ok()) << scale;
  }
  for (const double scale : {1e-30, 1e30}) {
    const auto mesh = prepare_mesh(lab::as_mesh(lab::scaled(lab::make_cube(2), scale)), {}, {});
    ASSERT_TRUE(mesh.ok()) << scale;
    EXPECT_EQ(mesh->triangles.size(), std::size_t{6 * 2 * 2 * 2}) << scale;
  }
}

TEST(Prepare, RefusesWhatTheFormatCannotHoldBeforeAnythingIsBuilt) {
  const auto refusal = [](const scene::Primitive& shape) {
    const auto mesh = prepare_mesh(lab::as_mesh(shape), {}, {});
    const auto plan = plan_grid(lab::as_mesh(shape), {});
    EXPECT_EQ(mesh.ok(), plan.ok());
    if (mesh.ok()) return std::string();
    EXPECT_EQ(mesh.error().code, ErrorCode::kUnsupported);
    EXPECT_EQ(mesh.error().message(), plan.error().message());
    return mesh.error().detail;
  };
  for (const double scale : {1e-37, 1e37}) {
    EXPECT_EQ(refusal(lab::scaled(lab::make_cube(2), scale)), "the grid's step leaves the range of floats");
  }
  // Short edges ask for a step that would do; it is the extent that is too large.
  scene::Primitive outlier = lab::make_cube(2);
  outlier.positions[0] = {1e36, 0.0, 0.0};
  EXPECT_EQ(refusal(outlier), "");
  for (const double far : {1.4e36, 1e37, 1e38}) {
    outlier.positions[0] = {far, 0.0, 0.0};
    EXPECT_NE(refusal(outlier), "") << far;
  }
  outlier.positions[0] = {1e37, 0.0, 0.0};
  EXPECT_EQ(refusal(outlier), "its extent leaves the range of culling spheres: more than 1.3e36");
}

TEST(Prepare, RefusesPositionsThatAreNotFinite) {
  scene::Primitive shape = lab::make_cube(2);
  shape.positions[3].y = std::numeric_limits<double>::quiet_NaN();
  const auto mesh = prepare_mesh(lab::as_mesh(shape), {}, {});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, ErrorCode::kInvalid);
}

TEST(Prepare, StrayVerticesDoNotCoarsenTheGrid) {
  scene::Primitive shape = lab::make_sphere(5);
  const PreparedMesh before = prepare(shape);
  shape.positions.push_back({1e12, 0, 0});
  const PreparedMesh after = prepare(shape);
  EXPECT_EQ(before.grid.log2, after.grid.log2);
  EXPECT_EQ(before.positions, after.positions);
}

TEST(Prepare, AnEmptyMeshAndASinglePointAreFine) {
  EXPECT_TRUE(prepare(scene::Primitive{}).triangles.empty());
  scene::Primitive point;
  point.positions = {{1, 2, 3}};
  point.indices = {0, 0, 0};
  const PreparedMesh mesh = prepare(point);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_EQ(mesh.dropped_degenerate, 1U);
}

TEST(Prepare, CountsPiecesByWhatTouches) {
  EXPECT_EQ(prepare(lab::make_sphere(4)).piece_count, 1U);
  EXPECT_EQ(prepare(lab::make_box_soup(37)).piece_count, 37U);
  EXPECT_EQ(prepare(lab::make_double_cone(12)).piece_count, 1U) << "two cones that share their tip";
}

/// Three squares side by side, each with vertices of its own; the middle one is there twice.
TEST(OpenBorder, IsWhereOneTriangleHasAnEdgeWhateverVerticesAreCalled) {
  Corners corners;
  const auto square = [&](double x) {
    const auto first = static_cast<std::uint32_t>(corners.positions.size());
    for (const Vec3d& p : {Vec3d(x, 0, 0), Vec3d(x + 1, 0, 0), Vec3d(x + 1, 1, 0), Vec3d(x, 1, 0)})
      corners.positions.push_back(p);
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) corners.triangles.push_back(first + k);
  };
  for (const double x : {0.0, 1.0, 2.0, 1.0}) square(x);
  corners.positions.emplace_back(9.0);  // of no triangle
  std::vector<std::uint8_t> is_used(corners.positions.size(), 1);
  is_used.back() = 0;
  std::vector<Vec3i> points;
  for (const Vec3d& p : corners.positions) points.emplace_back(2.0 * p);
  std::vector<Vec3i> positions;
  for (int x = 0; x <= 3; ++x) {
    for (int y = 0; y <= 1; ++y) positions.emplace_back(2 * x, 2 * y, 0);
  }
  positions.emplace_back(18);
  EXPECT_EQ(find_open_border(corners, is_used, points, positions),
            (std::vector<std::uint8_t>{1, 1, 1, 1, 1, 1, 1, 1, 0}));
  // A row above: what lies between is inside.
  for (const double x : {0.0, 1.0, 2.0}) {
    square(x);
    for (std::size_t v = corners.positions.size() - 4; v < corners.positions.size(); ++v) {
      corners.positions[v].y += 1.0;
      points.emplace_back(2.0 * corners.positions[v]);
      is_used.push_back(1);
    }
  }
  EXPECT_EQ(find_open_border(corners, is_used, points, positions),
            (std::vector<std::uint8_t>{1, 1, 1, 0, 1, 0, 1, 1, 0}));
}

TEST(Prepare, ATriangleWithoutAGapTakesTheNarrowestAroundIt) {
  const scene::Primitive sheet = lab::make_plane(4);
  std::vector<std::uint8_t> gaps(sheet.indices.size() / 3, 0);
  const GapPair narrow = GapPair::of_byte(0x35), wide = GapPair::of_byte(0x12);
  gaps[0] = wide.byte();
  gaps[1] = narrow.byte();
  PrepareOptions options;
  options.gaps = gaps;
  options.gap_reach = 1.0;
  const PreparedMesh mesh = prepare(sheet, options);
  int of_narrow = 0, of_wide = 0, of_neither = 0;
  for (const std::uint32_t label : mesh.triangle_material) {
    const std::uint8_t found = gap_pair_of(label).byte();
    of_narrow += found == narrow.byte() ? 1 : 0;
    of_wide += found == wide.byte() ? 1 : 0;
    of_neither += found == 0 ? 1 : 0;
  }
  EXPECT_GE(of_wide, 1) << "who has a gap keeps it";
  EXPECT_GT(of_narrow, 3);
  EXPECT_GT(of_neither, 8) << "no farther than the next triangle";
}

TEST(ChooseGrid, EdgesSpanEightStepsAndNoMoreThanSixteen) {
  for (const double edge : {1e-4, 0.9e-4, 0.6e-4}) {
    const auto grid = choose_grid(1.0, 3.0, edge, {});
    ASSERT_TRUE(grid.ok());
    EXPECT_GE(edge / grid->step(), 8.0) << edge;
    EXPECT_LT(edge / grid->step(), 16.0) << edge;
  }
}

TEST(ChooseGrid, AGivenStepIsASmallOddMantissa) {
  PrepareOptions options;
  options.grid_step = 0.75;
  const auto grid = choose_grid(1.0, 2.0, 0.1, options);
  ASSERT_TRUE(grid.ok());
  EXPECT_EQ(grid->mantissa, 3U);
  EXPECT_EQ(grid->log2, -2);
  options.grid_step = 0.01;
  EXPECT_NEAR(choose_grid(1.0, 2.0, 0.1, options)->step(), 0.01, 0.01 * 0.004);
}

// The largest step below the budget often has a mantissa of eight bits, which leave 16 for coordinates: a budget that
// 24 bits can keep is kept with a shorter one.
TEST(ChooseGrid, APositionErrorThatTwentyFourBitsCanKeepIsNotRefused) {
  PrepareOptions options;
  for (double error = 1e-4; error > 2.1e-7; error *= 0.98) {
    options.position_error = error;
    const auto grid = choose_grid(1.0, std::sqrt(12.0), 0.01, options);
    ASSERT_TRUE(grid) << error;
    EXPECT_LE(grid->step() * std::sqrt(3.0) / 2.0, error);
    EXPECT_GT(grid->step() * std::sqrt(3.0) / 2.0, error / 2.0) << error;
    EXPECT_LE(grid->mantissa / grid->step(), 0x1p23) << error;
  }
  options.position_error = 5e-8;
  EXPECT_FALSE(choose_grid(1.0, std::sqrt(12.0), 0.01, options));
}

TEST(ChooseGrid, APositionErrorIsKeptAndNearlyUsed) {
  for (const double error : {1e-4, 0.001, 1.0 / 1600.0, 0.37, 5.0}) {
    PrepareOptions options;
    options.position_error = error;
    const auto grid = choose_grid(1.0, 2.0, 0.1, options);
    ASSERT_TRUE(grid.ok()) << error;
    const double farthest = grid->step() * std::sqrt(3.0) / 2.0;
    EXPECT_LE(farthest, error);
    EXPECT_GE(farthest, 0.99 * error) << "a mantissa of eight bits";
  }
  PrepareOptions options;
  options.position_error = 1e-9;
  EXPECT_EQ(choose_grid(1.0, 2.0, 0.1, options).error().code, ErrorCode::kUnsupported);
}

/// Position errors that a step of eight bits would break by next to nothing: the next smaller step is due.
TEST(ChooseGrid, APositionErrorThatAStepBarelyBreaksIsKept) {
  for (std::uint32_t mantissa = 129; mantissa < 256; mantissa += 2) {
    PrepareOptions options;
    options.position_error = mantissa * 0x1p-12 * std::sqrt(3.0) / 2.0 * (1.0 - 2e-13);
    const auto grid = choose_grid(1.0, 2.0, 0.1, options);
    ASSERT_TRUE(grid.ok());
    const long double step = static_cast<long double>(grid->step()), error = options.position_error;
    EXPECT_LE(3.0L * step * step, 4.0L * error * error) << mantissa;
  }
}

TEST(ChooseGrid, ARefusalNamesWhatWasAskedAndTheExtent) {
  PrepareOptions options;
  options.grid_step = 0x1p-40;
  EXPECT_EQ(choose_grid(16.0, 50.0, 0.1, options).error().detail,
            "a grid step of 9.09495e-13 needs more than 24 bits for an extent of 32");
}

TEST(ChooseGrid, IsTheCoarsestPowerOfTwoThatKeepsItsShareOfTheDiagonal) {
  for (int i = 0; i < 100; ++i) {
    const double diagonal = 1.7 * std::pow(1.37, i - 50);
    const auto grid = choose_grid(0.25 * diagonal, diagonal, 0.0, {});
    ASSERT_TRUE(grid.ok());
    const double farthest = grid->step() * std::sqrt(3.0) / 2.0;
    EXPECT_LE(farthest, 2.5e-5 * diagonal);
    EXPECT_GT(2.0 * farthest, 2.5e-5 * diagonal) << diagonal;
  }
}

TEST(ChooseGrid, IsTheFinestWhoseCoordinatesKeepTwoBitsInReserve) {
  constexpr double kMost = format::kMaxGridCoordinate / 4.0;
  for (const double half : {1.0, 1.3, 1e-20, 7e15, kMost, kMost * 0x1p-30, kMost * 0x1p9}) {
    const auto grid = choose_grid(half, 1.5 * half, 1e-15 * half, {});  // edges that ask for a far finer one
    ASSERT_TRUE(grid.ok());
    EXPECT_LE(half / grid->step(), kMost) << half;
    EXPECT_GT(half / (0.5 * grid->step()), kMost) << half;
  }
}

TEST(Prepare, NoVertexMovesFartherThanThePositionError) {
  for (const double error : {0.05, 0.001}) {
    PrepareOptions options;
    options.position_error = error;
    const PreparedMesh mesh = prepare(lab::make_sphere(16), options);
    EXPECT_LE(mesh.level0_deviation, error);
    EXPECT_GT(mesh.level0_deviation, 0.2 * error) << "the budget is used";
  }
}

TEST(ChooseGrid, HoldsMeshesOfAnySize) {
  for (const double scale : {1e-30, 1e-6, 1.0, 1e9, 1e30}) {
    const auto grid = choose_grid(scale, 2 * scale, 0.0, {});
    ASSERT_TRUE(grid.ok());
    EXPECT_LT(scale / grid->step(), format::kMaxGridCoordinate);
    EXPECT_LE(grid->step() * std::sqrt(3.0) / 2.0, 2.5e-5 * 2 * scale);
  }
}

}  // namespace
}  // namespace meshlode::builder
