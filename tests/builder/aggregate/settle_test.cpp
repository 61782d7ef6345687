// SPDX-License-Identifier: GPL-3.0-or-later
// Cards that settle: pictures in halves of pixels are what drawing all of it anew would give, and there is less noise.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "builder/aggregate/covered_samples.h"
#include "builder/aggregate/half_pixels.h"
#include "builder/aggregate/settle.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3d in_ball(double radius) {
    for (;;) {
      const Vec3d p((*this)(-radius, radius), (*this)(-radius, radius), (*this)(-radius, radius));
      if (glm::length(p) <= radius) return p;
    }
  }

 private:
  std::mt19937 engine_;
};

Splat some_splat(Random& random, double size) {
  Splat splat;
  splat.center = random.in_ball(1.0);
  splat.axis_u = glm::normalize(random.in_ball(1.0));
  splat.axis_v = glm::normalize(glm::cross(splat.axis_u, random.in_ball(1.0)));
  splat.half_u = size;
  splat.half_v = 0.4 * size;
  splat.area = size * size;
  return splat;
}

/// A mask of triangles in a view.
SampleMask mask_in(const Lattice& lattice, const View& view, std::span<const Splat> splats) {
  std::vector<Corners> triangles;
  for (const Splat& splat : splats) triangles.push_back(splat.corners(1.0));
  return mask_of(lattice, view, triangles);
}

struct Scene {
  Lattice lattice{Vec3d(0.0), 1.2, 0.01};
  View view = settling_views()[3];
  std::vector<Splat> source, cards;

  explicit Scene(std::uint32_t seed) {
    Random random(seed);
    for (int i = 0; i < 300; ++i) source.push_back(some_splat(random, 0.1));
    for (int i = 0; i < 25; ++i) cards.push_back(some_splat(random, 0.4));
  }
  [[nodiscard]] HalfPixels picture(int half) const {
    return {SourceHalves(mask_in(lattice, view, source), half), lattice, view};
  }
};

double squares_with(const Scene& scene, int half, std::span<const Splat> cards) {
  HalfPixels picture = scene.picture(half);
  CardSamples samples;
  for (const Splat& card : cards) {
    picture.draw(card.corners(1.0), samples);
    picture.add(samples);
  }
  return picture.squares();
}

TEST(SourceHalves, OfLargerPixelsAreTheSumsOfSmallOnes) {
  const Scene scene(1);
  const SampleMask mask = mask_in(scene.lattice, scene.view, scene.source);
  for (const int half : {4, 6, 8}) {
    const SourceHalves twice = SourceHalves(mask, half).coarser(), anew(mask, 2 * half);
    EXPECT_EQ(twice.half, anew.half);
    std::int64_t sum = 0;
    const auto at = [](const SourceHalves& halves, int x, int y) {
      return halves.covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(halves.columns) +
                            static_cast<std::size_t>(x)];
    };
    for (int y = 0; y < anew.rows; ++y) {
      for (int x = 0; x < anew.columns; ++x) {
        const std::int32_t samples = at(anew, x, y);
        sum += samples;
        const int column = x + anew.first_column - twice.first_column, row = y + anew.first_row - twice.first_row;
        const bool is_there = column >= 0 && row >= 0 && column < twice.columns && row < twice.rows;
        ASSERT_TRUE(is_there || samples == 0);
        if (is_there) {
          ASSERT_EQ(at(twice, column, row), samples);
        }
      }
    }
    EXPECT_EQ(sum, static_cast<std::int64_t>(mask.count()));
  }
}

TEST(HalfPixels, AChangeIsWhatDrawingAllAnewGives) {
  for (const int half : {4, 6, 16}) {
    Scene scene(7);
    HalfPixels picture = scene.picture(half);
    const double nothing = picture.squares();
    EXPECT_EQ(nothing, picture.source_squares());
    CardSamples samples;
    std::vector<Splat> so_far;
    for (const Splat& card : scene.cards) {
      picture.draw(card.corners(1.0), samples);
      const double wanted = picture.squares() + static_cast<double>(picture.change_by(samples));
      picture.add(samples);
      so_far.push_back(card);
      ASSERT_EQ(picture.squares(), wanted);
      ASSERT_EQ(picture.squares(), squares_with(scene, half, so_far));
    }
    // In another order out again, one by one.
    while (!so_far.empty()) {
      picture.draw(so_far.front().corners(1.0), samples);
      picture.remove(samples);
      so_far.erase(so_far.begin());
      ASSERT_EQ(picture.squares(), squares_with(scene, half, so_far));
    }
    EXPECT_EQ(picture.squares(), nothing);
  }
}

TEST(HalfPixels, OfCardsThatAreTheSourceLittleIsLeft) {
  // Their samples are wider than the source's, so not nothing.
  Scene scene(3);
  scene.source = scene.cards;
  EXPECT_LT(squares_with(scene, 8, scene.source), 0.01 * scene.picture(8).source_squares());
}

TEST(HalfPixels, WhatIsFarOutOrFlatCoversNothing) {
  const Scene scene(4);
  HalfPixels picture = scene.picture(8);
  const double before = picture.squares();
  constexpr double kFar = 1e30;
  const Vec3d right = scene.view.right, up = scene.view.up;
  CardSamples samples;
  for (const Corners& corners :
       {Corners{kFar * right, kFar * right + up, kFar * right - up}, Corners{right * 0.1, right * 0.1, right * 0.1},
        Corners{right, right * 0.5, -right}, Corners{scene.view.toward, -scene.view.toward, Vec3d(0.0)}}) {
    picture.draw(corners, samples);
    EXPECT_EQ(picture.change_by(samples), 0);
    picture.add(samples);
    EXPECT_EQ(picture.squares(), before);
  }
  // One that is larger than the picture fills it, and can be taken out again.
  picture.draw({kFar * right, -kFar * right + kFar * up, -kFar * right - kFar * up}, samples);
  picture.add(samples);
  EXPECT_GT(picture.squares(), before);
  picture.remove(samples);
  EXPECT_EQ(picture.squares(), before);
}

/// Pieces of a mesh, and what is drawn of them.
struct Pieces {
  PreparedMesh mesh;
  std::vector<SourceMaterial> materials{1};
  std::vector<std::uint8_t> is_closed;
  ByPiece all;
  MeshFrame frame;

  explicit Pieces(scene::Primitive shape) {
    shape.normals.clear();
    shape.uvs[0].clear();
    mesh = *prepare_mesh(lab::as_mesh(std::move(shape)), {}, {});
    is_closed.assign(mesh.triangles.size(), 0);
    all.first = {0, static_cast<std::uint32_t>(mesh.triangles.size())};
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) all.items.push_back(t);
    Vec3d low(std::numeric_limits<double>::max()), high = -low;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const Vec3d& corner : corners_of(mesh, t)) {
        low = glm::min(low, corner);
        high = glm::max(high, corner);
      }
    }
    const Vec3d size = high - low;
    frame = {0.5 * (low + high), 0.5 * glm::length(size), std::max({size.x, size.y, size.z})};
  }
};

/// In these pixels, from the settling views.
double noise_of(const SourcePictures& pictures, const SourcePictures::Size& size, const WayToSettle& way) {
  double change = 0.0, whole = 0.0;
  CardSamples samples;
  for (std::size_t v = 0; v < size.views.size(); ++v) {
    HalfPixels view(size.views[v], pictures.lattice(), settling_views()[v]);
    for (const Splat& splat : way.splats.splats) {
      view.draw(splat.corners(way.factor), samples);
      view.add(samples);
    }
    change += view.squares();
    whole += view.source_squares();
  }
  return std::sqrt(change / whole);
}

/// A card for every so many triangles, where the first of these is.
WayToSettle some_cards(const Pieces& pieces, std::size_t members) {
  WayToSettle way;
  for (std::size_t t = 0; t + members <= pieces.mesh.triangles.size(); t += members) {
    const Corners corners = corners_of(pieces.mesh, t);
    const Vec3d normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    Splat splat;
    splat.center = (corners[0] + corners[1] + corners[2]) / 3.0;
    splat.axis_u = glm::normalize(corners[1] - corners[0]);
    splat.axis_v = glm::normalize(glm::cross(normal, splat.axis_u));
    splat.area = 0.5 * glm::length(normal);
    splat.half_u = splat.half_v = std::sqrt(splat.area);
    way.splats.splats.push_back(splat);
  }
  return way;
}

/// With the factor with which they cover as much as the pieces do.
WayToSettle fitted(const Pieces& pieces, WayToSettle way) {
  const auto covered = [&](std::span<const Corners> triangles) {
    std::uint64_t sum = 0;
    for (const std::uint64_t count :
         covered_samples(pieces.frame, triangles, pieces.frame.longest / 300.0, settling_views()))
      sum += count;
    return sum;
  };
  std::vector<Corners> all;
  for (std::size_t t = 0; t < pieces.mesh.triangles.size(); ++t) all.push_back(corners_of(pieces.mesh, t));
  const std::uint64_t wanted = covered(all);
  double low = 0.0, high = 1000.0;
  for (int step = 0; step < 20; ++step) {
    way.factor = 0.5 * (low + high);
    std::vector<Corners> cards;
    for (const Splat& splat : way.splats.splats) cards.push_back(splat.corners(way.factor));
    (covered(cards) < wanted ? low : high) = way.factor;
  }
  return way;
}

TEST(Settling, TakesAFifthOffTheNoiseAndLeavesAreas) {
  const Pieces pieces(lab::make_foliage(1500));
  const SourceSurface source(pieces.mesh, pieces.materials, pieces.is_closed);
  const SourcePictures pictures(source, pieces.frame, pieces.all, pieces.frame.longest / 55.0);
  for (std::size_t s = 1; s < pictures.sizes().size(); ++s)
    EXPECT_GT(pictures.sizes()[s].pixel_size, pictures.sizes()[s - 1].pixel_size);
  const WayToSettle way = fitted(pieces, some_cards(pieces, 20));
  const Splats& before = way.splats;
  std::vector<WayToSettle> ways{way};
  ASSERT_EQ(settle(pictures, 0.0, ways), 0U);
  const Splats& after = ways[0].splats;
  ASSERT_EQ(after.splats.size(), before.splats.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < after.splats.size(); ++i) {
    const Splat &a = before.splats[i], &b = after.splats[i];
    EXPECT_EQ(a.area, b.area);
    EXPECT_NEAR(glm::length(b.axis_u), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(b.axis_v), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(b.axis_u, b.axis_v), 0.0, 1e-12);
    moved += a.center != b.center ? 1 : 0;
  }
  EXPECT_GT(2 * moved, after.splats.size());
  // In the pixels that it settled in.
  double least = 1.0;
  for (const SourcePictures::Size& size : pictures.sizes())
    least = std::min(least, noise_of(pictures, size, ways[0]) / noise_of(pictures, size, way));
  EXPECT_LT(least, 0.8);
}

TEST(Settling, TakesTheWayWithLessNoise) {
  const Pieces pieces(lab::make_foliage(1500));
  const SourceSurface source(pieces.mesh, pieces.materials, pieces.is_closed);
  const SourcePictures pictures(source, pieces.frame, pieces.all, pieces.frame.longest / 55.0);
  // Of half the area a part is missing, wherever it is.
  const WayToSettle whole = fitted(pieces, some_cards(pieces, 20));
  const WayToSettle half{whole.splats, 0.5 * whole.factor};
  std::vector<WayToSettle> ways{half, whole};
  EXPECT_EQ(settle(pictures, 0.0, ways), 1U);
  ways = {whole, half};
  EXPECT_EQ(settle(pictures, 0.0, ways), 0U);
}

TEST(Settling, WhatCoversNothingStaysFinite) {
  const Pieces pieces(lab::scaled(lab::make_foliage(40), 1e-6));
  const SourceSurface source(pieces.mesh, pieces.materials, pieces.is_closed);
  const SourcePictures pictures(source, pieces.frame, pieces.all, pieces.frame.longest / 55.0);
  WayToSettle way = some_cards(pieces, 8);
  way.factor = 0.0;
  std::vector<WayToSettle> ways{way};
  EXPECT_EQ(settle(pictures, 1e9, ways), 0U) << "and no pixel is as large as that";
  for (const Splat& splat : ways[0].splats.splats) {
    for (const Vec3d& p : splat.corners(1.0)) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  }
}

}  // namespace
}  // namespace meshlode::builder
