// SPDX-License-Identifier: GPL-3.0-or-later
// Drift of normals and UVs against closed forms: turned normals, moved UVs, seams that moved, and creases.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "builder/builder.h"
#include "judge/metrics/attribute_drift.h"
#include "judge/metrics/seams.h"
#include "lab/samples/samples.h"
#include "run/select/select.h"

namespace meshlode::judge {
namespace {

/// The unit square in z = 0, n x n cells, with a seam in the u of set 0: `left` below x = seam, `right` above. Vertices
/// on the seam are there twice.
struct SquareOptions {
  std::uint32_t n = 20;
  double seam = 2.0;               ///< a multiple of 1 / n; above 1: none
  double left = 0.0, right = 0.0;  ///< added to u = x
  double tilt = 0.0;               ///< radians that normals lean from +z towards +x
};

ShadedSurface make_square(const SquareOptions& o) {
  ShadedSurface s;
  for (std::uint32_t y = 0; y < o.n; ++y) {
    for (std::uint32_t x = 0; x < o.n; ++x) {
      const auto base = static_cast<std::uint32_t>(s.surface.positions.size());
      const double add = (x + 0.5) / o.n < o.seam ? o.left : o.right;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t column = x + k % 2, row = y + k / 2;
        const double px = static_cast<double>(column) / o.n, py = static_cast<double>(row) / o.n;
        s.surface.positions.push_back({px, py, 0.0});
        s.normals.push_back(Vec3f(Vec3d(std::sin(o.tilt), 0.0, std::cos(o.tilt))));
        s.uvs[0].push_back(Vec2f(Vec2d(px + add, py)));
      }
      s.surface.triangles.push_back({base, base + 1, base + 3});
      s.surface.triangles.push_back({base, base + 3, base + 2});
    }
  }
  return s;
}

constexpr DriftOptions kQuick{.samples = 20000, .seed = 1, .tie = 1e-9, .seam_reach = 0.0};

DriftReport drift(const ShadedSurface& a, const ShadedSurface& b, const DriftOptions& options = kQuick) {
  return measure_drift(DriftSurface(a), DriftSurface(b), options);
}

TEST(Drift, IsZeroBetweenASurfaceAndItself) {
  const DriftReport r = drift(make_square({}), make_square({.n = 7}));
  EXPECT_TRUE(r.has_normals());
  EXPECT_TRUE(r.has_uvs());
  EXPECT_LE(std::max(r.normal_a_to_b.max, r.normal_b_to_a.max), 1e-4);
  EXPECT_LE(std::max(r.uv_a_to_b.max, r.uv_b_to_a.max), 1e-6);
}

TEST(Drift, OfTurnedNormalsIsTheirAngle) {
  const DriftReport r = drift(make_square({}), make_square({.n = 7, .tilt = 10.0 / 57.29577951308232}));
  for (const OneWayDrift& d : {r.normal_a_to_b, r.normal_b_to_a}) {
    EXPECT_NEAR(d.rms, 10.0, 1e-4);
    EXPECT_NEAR(d.p99, 10.0, 1e-4);
    EXPECT_NEAR(d.max, 10.0, 1e-4);
  }
}

TEST(Drift, OfMovedUvsIsTheirDistanceInBothDirections) {
  const DriftReport r = drift(make_square({}), make_square({.n = 7, .left = 0.25}));
  for (const OneWayDrift& d : {r.uv_a_to_b, r.uv_b_to_a}) {
    EXPECT_NEAR(d.rms, 0.25, 1e-6);
    EXPECT_NEAR(d.max, 0.25, 1e-6);
  }
}

TEST(Drift, AcrossASeamThatMovedIsTheWayItMoved) {
  const ShadedSurface a = make_square({.seam = 0.5, .right = 10.0}), b = make_square({.seam = 0.55, .right = 10.0});
  DriftOptions options = kQuick;
  EXPECT_GT(drift(a, b, options).uv_a_to_b.p99, 9.0) << "the nearest point is on the wrong side of the seam";
  options.seam_reach = 0.06;
  const DriftReport r = drift(a, b, options);
  for (const OneWayDrift& d : {r.uv_a_to_b, r.uv_b_to_a}) {
    EXPECT_NEAR(d.max, 0.05, 1e-3);
    EXPECT_LT(d.rms, 0.01) << "a twentieth of the square lies between the seams, off by 0.05 at most";
  }
}

TEST(Drift, IsNotHiddenBySlidingAlongASeam) {
  const ShadedSurface a = make_square({.seam = 0.5, .right = 10.0});
  const ShadedSurface b = make_square({.n = 10, .seam = 0.5, .left = 0.03, .right = 10.03});
  DriftOptions options = kQuick;
  options.seam_reach = 0.2;
  const DriftReport r = drift(a, b, options);
  for (const OneWayDrift& d : {r.uv_a_to_b, r.uv_b_to_a}) {
    EXPECT_NEAR(d.rms, 0.03, 1e-5);
    EXPECT_NEAR(d.max, 0.03, 1e-5);
  }
}

TEST(Drift, OfAFlatShadedCubeIsZeroAtItsCreases) {
  const scene::SourceMesh coarse = lab::as_mesh(lab::make_cube(1)), fine = lab::as_mesh(lab::make_cube(9));
  const DriftReport r = drift(shaded_surface_of_source(coarse), shaded_surface_of_source(fine));
  EXPECT_GT(r.normal_a_to_b.points, 20000U);
  EXPECT_LE(std::max(r.normal_a_to_b.max, r.normal_b_to_a.max), 1e-4);
}

TEST(Drift, LeavesOutWhatOneSideDoesNotHave) {
  ShadedSurface bare = make_square({});
  bare.normals.clear();
  for (Vec2f& uv : bare.uvs[0]) uv.x = std::numeric_limits<float>::quiet_NaN();
  const DriftReport r = drift(make_square({}), bare);
  EXPECT_FALSE(r.has_normals());
  EXPECT_FALSE(r.has_uvs());
  EXPECT_FALSE(drift(make_square({}), ShadedSurface{}).has_uvs());
}

TEST(Drift, SeamsAreEdgesWhoseTrianglesDisagree) {
  const ShadedSurface s = make_square({.n = 4, .seam = 0.5, .right = 10.0});
  std::vector<Vec3f> u;
  for (const Vec2f& uv : s.uvs[0]) u.emplace_back(uv, 0.0F);
  const auto seams = find_seams(s.surface, u, 1e-6F);
  for (std::size_t t = 0; t < seams.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto& corners = s.surface.triangles[t];
      const bool is_on = s.surface.positions[corners[k]].x == 0.5 && s.surface.positions[corners[(k + 1) % 3]].x == 0.5;
      EXPECT_EQ((seams[t] >> k & 1U) != 0, is_on) << "triangle " << t << " edge " << k;
    }
  }
}

TEST(Drift, OfLevelZeroIsItsQuantization) {
  scene::SourceMesh mesh = lab::as_mesh(lab::with_smooth_normals(lab::make_torus(80, 40)));
  scene::Primitive& p = mesh.primitives[0];
  for (const Vec3d& at : p.positions) p.uvs[0].push_back(Vec2f(Vec2d(at.x, at.y)));
  builder::PipelineOptions options;
  options.attributes = AttributeChoice::kAll;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(lab::as_scene(mesh), options, {}, report);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const auto asset = run::Asset::from_vector(std::move(*bytes));
  ASSERT_TRUE(asset.ok());
  const auto decoded = run::decode_all(*asset);
  ASSERT_TRUE(decoded.ok());
  const DriftSurface source(shaded_surface_of_source(mesh));
  const auto drift_at = [&](double error) {
    const run::UniformCut cut = run::select_uniform(*asset, MeshId(0U), error);
    return measure_drift(source, DriftSurface(shaded_surface_of_clusters(*asset, *decoded, MeshId(0U), cut.clusters)),
                         {.samples = 20000, .tie = 1e-7});
  };
  const DriftReport finest = drift_at(0.0), coarsest = drift_at(1e9);
  ASSERT_TRUE(finest.has_normals());
  ASSERT_TRUE(finest.has_uvs());
  EXPECT_LT(finest.normal_a_to_b.rms, 0.2);
  EXPECT_LT(finest.uv_a_to_b.rms, 1e-3);
  EXPECT_GT(coarsest.normal_a_to_b.rms, 1.0) << "a hundred triangles are no torus of 6,400";
}

/// A sheet with two sides that are nearer to each other than a grid's step: the unit square from above, and from below
/// in another place of the atlas, `thickness` beneath it.
ShadedSurface make_plate(double thickness, float u_below = 2.0F) {
  ShadedSurface plate = make_square({});
  const ShadedSurface above = plate;
  for (std::size_t v = 0; v < above.surface.positions.size(); ++v) {
    plate.surface.positions.push_back(above.surface.positions[v] - Vec3d(0.0, 0.0, thickness));
    plate.normals.push_back(-above.normals[v]);
    plate.uvs[0].push_back(above.uvs[0][v] + Vec2f(u_below, 0.0F));
  }
  const auto base = static_cast<std::uint32_t>(above.surface.positions.size());
  for (const auto& t : above.surface.triangles)
    plate.surface.triangles.push_back({base + t[0], base + t[2], base + t[1]});
  return plate;
}

/// Positions on a grid, as quantization has them.
ShadedSurface rounded(ShadedSurface s, double step) {
  for (Vec3d& p : s.surface.positions) p = step * glm::round(p / step);
  return s;
}

constexpr double kStep = 1e-3;
constexpr DriftOptions kFine{
    .samples = 20000, .seed = 1, .tie = 1e-9, .side_reach = 2 * kStep, .seam_reach = 2 * kStep};

TEST(Drift, OfAThinPlateIsThatOfEachSideByItself) {
  // The grid puts the lower side where the upper one was, or even above it.
  for (const double thickness : {0.0, 0.1 * kStep, 0.6 * kStep, 1.2 * kStep}) {
    const ShadedSurface plate = make_plate(thickness);
    ShadedSurface moved = plate;
    for (std::size_t v = 0; v < moved.surface.positions.size(); ++v) {
      moved.surface.positions[v].z += v < moved.surface.positions.size() / 2 ? -0.5 * kStep : 0.5 * kStep;
    }
    for (const ShadedSurface& other : {rounded(plate, kStep), moved}) {
      const DriftReport r = drift(plate, other, kFine);
      EXPECT_LE(std::max(r.normal_a_to_b.max, r.normal_b_to_a.max), 1e-3) << thickness;
      EXPECT_LE(std::max(r.uv_a_to_b.max, r.uv_b_to_a.max), 2 * kStep) << thickness;
    }
  }
}

TEST(Drift, OfASmallCardIsWhatASlideByTheGridMakes) {
  // Both sides show the same picture, whose UVs move by a twentieth within a step of the grid.
  ShadedSurface card = make_plate(0.1 * kStep, 0.0F);
  for (Vec3d& p : card.surface.positions) p *= 0.02;
  const DriftReport r = drift(card, rounded(card, kStep), kFine);
  EXPECT_LE(std::max(r.normal_a_to_b.max, r.normal_b_to_a.max), 1e-3) << "the other side is no better for its UVs";
  EXPECT_LE(std::max(r.uv_a_to_b.max, r.uv_b_to_a.max), 2.0 * kStep / 0.02);
}

TEST(Drift, OfAThinPlateFindsWhatIsWrongOnOneSide) {
  const ShadedSurface plate = make_plate(0.1 * kStep);
  const std::size_t half = plate.surface.positions.size() / 2;
  ShadedSurface flipped = rounded(plate, kStep), shifted = flipped, swapped = flipped;
  flipped.normals[half / 2] *= -1.0F;
  const DriftReport normal = drift(plate, flipped, kFine);
  EXPECT_GT(std::max(normal.normal_a_to_b.max, normal.normal_b_to_a.max), 170.0) << "the other side has such a normal";
  for (std::size_t v = half; v < 2 * half; ++v) shifted.uvs[0][v].y += 0.05F;
  const DriftReport uv = drift(plate, shifted, kFine);
  EXPECT_NEAR(uv.uv_a_to_b.max, 0.05, 1e-3);
  EXPECT_NEAR(uv.uv_b_to_a.max, 0.05, 1e-3);
  EXPECT_LE(uv.normal_a_to_b.max, 1e-3);
  // Each side painted as the other one: its UVs agree with the other side's, and its normals with its own.
  for (std::size_t v = 0; v < half; ++v) std::swap(swapped.uvs[0][v], swapped.uvs[0][half + v]);
  const DriftReport both = drift(plate, swapped, kFine);
  EXPECT_TRUE(both.uv_a_to_b.max > 1.9 || both.normal_a_to_b.max > 170.0);
}

TEST(Drift, AtASeamThatIsRoundedIsThatOfEachChart) {
  const ShadedSurface a = make_square({.n = 7, .seam = 3.0 / 7.0, .right = 0.5});
  const DriftReport sound = drift(a, rounded(a, kStep), kFine);
  for (const OneWayDrift& d : {sound.uv_a_to_b, sound.uv_b_to_a}) EXPECT_LE(d.max, 2 * kStep);
  ShadedSurface shifted = rounded(a, kStep);
  for (Vec2f& uv : shifted.uvs[0]) uv += uv.x > 0.7F ? Vec2f(0.0F, 0.02F) : Vec2f(0.0F);
  const DriftReport r = drift(a, shifted, kFine);
  for (const OneWayDrift& d : {r.uv_a_to_b, r.uv_b_to_a}) EXPECT_NEAR(d.max, 0.02, 2e-3);
}

}  // namespace
}  // namespace meshlode::judge
