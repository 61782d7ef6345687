// SPDX-License-Identifier: GPL-3.0-or-later
// Normal and UV deviations of a sheet against closed forms, of groups whose points are all compared and of larger ones.
#include "builder/deviation/attribute_deviation.h"

#include <cmath>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

/// A flat square of 2 n^2 triangles with a normal and a UV per vertex; attributes as in the layout below.
struct Sheet {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<float> attributes;
};

AttributeLayout layout() {
  AttributeLayout out;
  out.has_normal = true;
  out.uv_set_count = 1;
  return out;
}

/// `turn` gives a vertex's angle from the sheet's own normal, in degrees, `shift` what its UV is off by.
template <class Turn, class Shift>
Sheet make_sheet(std::uint32_t n, const Turn& turn, const Shift& shift) {
  Sheet sheet;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      const double angle = turn(x, y) * 0.017453292519943295;
      sheet.positions.push_back({x, y, 0.0});
      for (const double value : {std::sin(angle), 0.0, std::cos(angle), x + shift(x, y), y})
        sheet.attributes.push_back(static_cast<float>(value));
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t at = j * (n + 1) + i;
      sheet.triangles.push_back({at, at + 1, at + n + 2});
      sheet.triangles.push_back({at, at + n + 2, at + n + 1});
    }
  }
  return sheet;
}

AttributeDeviation compare(const Sheet& group) {
  const auto nothing = [](double, double) { return 0.0; };
  const Sheet source = make_sheet(40, nothing, nothing);
  return measure_attributes(SourceTree(source.positions, source.triangles), {source.attributes, source.triangles},
                            {group.positions, group.triangles}, {group.attributes, group.triangles}, layout());
}

// 200 triangles and 3,200: with many points of each, and fewer points than triangles.
constexpr std::uint32_t kSides[] = {10, 40};

TEST(AttributeDeviation, OfTheSameSheetIsNothing) {
  const auto nothing = [](double, double) { return 0.0; };
  for (const std::uint32_t side : kSides) {
    const AttributeDeviation deviation = compare(make_sheet(side, nothing, nothing));
    EXPECT_NEAR(deviation.normal, 0.0, 1e-5);
    EXPECT_NEAR(deviation.uv, 0.0, 1e-6);
  }
}

TEST(AttributeDeviation, OfATurnAndAShiftIsThatAngleAndThatLength) {
  for (const std::uint32_t side : kSides) {
    const AttributeDeviation deviation = compare(make_sheet(
        side, [](double, double) { return 7.0; }, [](double, double) { return 0.25; }));
    EXPECT_NEAR(deviation.normal, 7.0, 1e-4);
    EXPECT_NEAR(deviation.uv, 0.25, 1e-5);
  }
}

// Below and above 60 degrees the angle is from another series; up to normals that are opposite.
TEST(AttributeDeviation, OfAnyTurnIsThatAngle) {
  for (const double angle : {0.5, 30.0, 59.9, 60.1, 90.0, 120.0, 179.0}) {
    const AttributeDeviation deviation = compare(make_sheet(
        10, [&](double, double) { return angle; }, [](double, double) { return 0.0; }));
    EXPECT_NEAR(deviation.normal, angle, 1e-3) << angle;
  }
}

// Degrees grow from 0 to 12 across: their root mean square is 12 / sqrt(3). Shifts grow to 1: 95% are below 0.95.
TEST(AttributeDeviation, IsARootMeanSquareOfNormalsAndAQuantileOfUvs) {
  for (const std::uint32_t side : kSides) {
    const AttributeDeviation deviation = compare(make_sheet(
        side, [](double x, double) { return 12.0 * x; }, [](double x, double) { return x; }));
    EXPECT_NEAR(deviation.normal, 12.0 / std::sqrt(3.0), 0.1);
    EXPECT_NEAR(deviation.uv, 0.95, 0.04);
  }
}

TEST(AttributeDeviation, IsToldByTrianglesWithAreaAlone) {
  Sheet sheet = make_sheet(
      40, [](double, double) { return 5.0; }, [](double, double) { return 0.0; });
  // Four of five are points: whatever every fifth point says has to come from the others.
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t) {
    if (t % 5 != 4) sheet.triangles[t] = {0, 0, 0};
  }
  EXPECT_NEAR(compare(sheet).normal, 5.0, 1e-4);
}

/// Of the attributes only normals, or only UVs.
Sheet only(const Sheet& sheet, bool has_normal) {
  Sheet out{sheet.positions, sheet.triangles, {}};
  for (std::size_t i = 0; i < sheet.attributes.size(); ++i) {
    if ((i % 5 < 3) == has_normal) out.attributes.push_back(sheet.attributes[i]);
  }
  return out;
}

TEST(AttributeDeviation, OfOneAttributeAloneIsWhatItIsAmongOthers) {
  const auto nothing = [](double, double) { return 0.0; };
  const Sheet group = make_sheet(
      10, [](double, double) { return 7.0; }, [](double, double) { return 0.25; });
  for (const bool has_normal : {true, false}) {
    const Sheet source = only(make_sheet(40, nothing, nothing), has_normal), part = only(group, has_normal);
    AttributeLayout one;
    one.has_normal = has_normal;
    one.uv_set_count = has_normal ? 0 : 1;
    const AttributeDeviation deviation =
        measure_attributes(SourceTree(source.positions, source.triangles), {source.attributes, source.triangles},
                           {part.positions, part.triangles}, {part.attributes, part.triangles}, one);
    EXPECT_NEAR(deviation.normal, has_normal ? 7.0 : 0.0, 1e-4);
    EXPECT_NEAR(deviation.uv, has_normal ? 0.0 : 0.25, 1e-5);
  }
}

TEST(AttributeDeviation, WithoutASourceThereIsNothingToDeviateFrom) {
  const auto nothing = [](double, double) { return 0.0; };
  const Sheet group = make_sheet(3, nothing, nothing), none;
  const AttributeDeviation deviation =
      measure_attributes(SourceTree(none.positions, none.triangles), {none.attributes, none.triangles},
                         {group.positions, group.triangles}, {group.attributes, group.triangles}, layout());
  EXPECT_EQ(deviation.normal, 0.0);
  EXPECT_EQ(deviation.uv, 0.0);
}

}  // namespace
}  // namespace meshlode::builder
