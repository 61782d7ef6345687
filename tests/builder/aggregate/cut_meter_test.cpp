// SPDX-License-Identifier: GPL-3.0-or-later
// Whole cuts against a source of two sheets, one close behind the other: either hides what becomes of the other.
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/aggregate/cut_meter.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

constexpr std::uint32_t kCards = 100;

/// Cards of 0.08 on a lattice of 10 x 10, all of a sheet in one leaf.
class CutMeterTest : public ::testing::Test {
 protected:
  CutMeterTest() : mesh_(prepared()), is_closed_(mesh_.triangles.size(), 0), source_(mesh_, materials_, is_closed_) {
    std::vector<std::uint32_t> back;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const bool is_front = corners_of(mesh_, t)[0].z > 0.0;
      (is_front ? leaves_.items : back).push_back(t);
    }
    leaves_.first = {0, static_cast<std::uint32_t>(leaves_.items.size()),
                     static_cast<std::uint32_t>(mesh_.triangles.size())};
    leaves_.items.insert(leaves_.items.end(), back.begin(), back.end());
  }

  static PreparedMesh prepared() {
    scene::Primitive sheets;
    for (const double z : {0.0, 0.002}) {
      for (std::uint32_t k = 0; k < kCards; ++k) {
        const double x = 0.1 * (k % 10), y = 0.1 * std::floor(k / 10.0);
        const auto first = static_cast<std::uint32_t>(sheets.positions.size());
        sheets.positions.insert(sheets.positions.end(),
                                {{x, y, z}, {x + 0.08, y, z}, {x + 0.08, y + 0.08, z}, {x, y + 0.08, z}});
        sheets.indices.insert(sheets.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
      }
    }
    Result<PreparedMesh> mesh = prepare_mesh(lab::as_mesh(std::move(sheets)), {}, {});
    EXPECT_TRUE(mesh.ok());
    return std::move(*mesh);
  }

  [[nodiscard]] CutMeter meter(double grain = 0.02, std::span<const View> from = views_above()) const {
    return {source_, {Vec3d(0.0), 0.7, 1.0}, leaves_, from, kSmallest, kSizes, grain, 1.0 / 110.0};
  }
  static std::span<const View> views_above() { return std::span(views()).first(kViews); }
  [[nodiscard]] std::vector<Corners> triangles_of(std::uint32_t leaf) const {
    std::vector<Corners> triangles;
    for (const std::uint32_t t : leaves_.of(leaf)) triangles.push_back(corners_of(mesh_, t));
    return triangles;
  }

  static constexpr double kSmallest = 0.02;
  static constexpr std::size_t kSizes = 5;
  PreparedMesh mesh_;
  std::vector<SourceMaterial> materials_{1};
  std::vector<std::uint8_t> is_closed_;
  ByPiece leaves_;
  SourceSurface source_;
};

TEST_F(CutMeterTest, WhatIsNotChangedHasNoNoise) {
  const CutMeter meter = this->meter();
  for (std::size_t size = 0; size < kSizes; ++size) {
    const CutChange change = meter.measure({{0, 1}, {0, 1}, {}, 1.0}, size);
    EXPECT_EQ(change.noise, 0.0);
    EXPECT_EQ(change.sum_shift, 0.0);
  }
}

TEST_F(CutMeterTest, OneSheetHidesThatTheOtherIsGoneAndBothDoNot) {
  const CutMeter meter = this->meter();
  for (std::size_t size = 0; size < kSizes; ++size) {
    for (const std::uint32_t left : {0U, 1U}) {
      const CutChange one = meter.measure({{0, 1}, {left}, {}, 1.0}, size);
      EXPECT_LT(one.noise, 0.1) << size;
      EXPECT_GT(one.sum_shift, -0.1);
      EXPECT_LT(one.sum_shift, 0.0);
    }
    const CutChange none = meter.measure({{0, 1}, {}, {}, 1.0}, size);
    EXPECT_DOUBLE_EQ(none.noise, 1.0);
    EXPECT_DOUBLE_EQ(none.sum_shift, -1.0);
  }
}

TEST_F(CutMeterTest, TrianglesCountLikeThePiecesThatTheyAre) {
  const CutMeter meter = this->meter();
  for (std::size_t size = 0; size < kSizes; ++size) {
    const CutChange pieces = meter.measure({{0, 1}, {0}, {}, 1.0}, size);
    const CutChange triangles = meter.measure({{0, 1}, {}, triangles_of(0), 1.0}, size);
    // Samples of pieces are those of the finest lattice, where corners are rounded more finely.
    EXPECT_NEAR(pieces.noise, triangles.noise, 1e-3);
    EXPECT_NEAR(pieces.sum_shift, triangles.sum_shift, 1e-3);
    EXPECT_DOUBLE_EQ(meter.measure({{0, 1}, {}, triangles_of(0), 2.0}, size).sum_shift,
                     0.5 * (1.0 + triangles.sum_shift) - 1.0)
        << "without luck";
  }
}

TEST_F(CutMeterTest, LeavesThatNothingReplacesAreNoPartOfIt) {
  const CutMeter meter = this->meter();
  const CutChange change = meter.measure({{1}, {}, triangles_of(1), 1.0}, 0);
  EXPECT_LT(change.noise, 0.02);
  EXPECT_DOUBLE_EQ(meter.measure({{1}, {}, {}, 1.0}, 0).noise, 1.0) << "leaf 0 would hide it";
}

TEST_F(CutMeterTest, ManyViewsSeeSoManyMoreSamplesAndFindTheSame) {
  const CutMeter few = meter(), many = meter(0.02, many_views());
  for (std::size_t size = 0; size < kSizes; ++size) {
    const ThinnedCut cut{{0, 1}, {0}, {}, 1.0};
    const CutChange by_few = few.measure(cut, size), by_many = many.measure(cut, size);
    EXPECT_GT(by_few.samples, 0.0);
    EXPECT_NEAR(by_many.samples / by_few.samples, 48.0 / 13.0, 0.15) << size;
    EXPECT_NEAR(by_many.sum_shift, by_few.sum_shift, 0.02) << size;
    EXPECT_NEAR(by_many.noise, by_few.noise, 0.03) << size;
  }
}

TEST_F(CutMeterTest, FinerSamplesFindTheSame) {
  // Pixels of 0.02 to 0.32 with samples an eighth of them wide, or of a thousandth; sanitized of 0.005 at most.
  const CutMeter wide = meter(1.0), narrow = meter(test::kIsSanitized ? 0.005 : 0.0);
  for (std::size_t size = 0; size < kSizes; ++size) {
    const ThinnedCut cut{{0, 1}, {0}, {}, 1.0};
    EXPECT_NEAR(wide.measure(cut, size).sum_shift, narrow.measure(cut, size).sum_shift, 0.03) << size;
    EXPECT_NEAR(wide.measure(cut, size).noise, narrow.measure(cut, size).noise, 0.05) << size;
  }
}

}  // namespace
}  // namespace meshlode::builder
