// SPDX-License-Identifier: GPL-3.0-or-later
// The small parts of both tiers against brute force: distances to one triangle and what of it is nearest, what a patch
// promises and what bounds it, how much of the effort is spent, and how near a certified bound comes to the truth.
#include "builder/deviation/patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/deviation/capsules.h"
#include "builder/deviation/deviation.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/surfaces.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::RandomSource;
using Precise3 = glm::vec<3, long double>;

struct Foot {
  long double distance2;
  NearestFeature feature;
};

long double segment_distance2(const Precise3& p, const Precise3& a, const Precise3& b, long double& along) {
  const Precise3 edge = b - a;
  const long double length2 = glm::dot(edge, edge);
  along = length2 > 0.0L ? std::clamp(glm::dot(p - a, edge) / length2, 0.0L, 1.0L) : 0.0L;
  const Precise3 away = p - a - edge * along;
  return glm::dot(away, away);
}

Foot exact_foot(const Vec3d& point, const TriangleCorners& corners) {
  const Precise3 p(point);
  std::array<Precise3, 3> c;
  for (std::size_t k = 0; k < 3; ++k) c[k] = Precise3(corners[k]);
  const Precise3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
  const long double nn = glm::dot(n, n);
  bool is_inside = nn > 0.0L;
  for (std::size_t k = 0; k < 3; ++k)
    is_inside = is_inside && glm::dot(glm::cross(c[(k + 1) % 3] - c[k], p - c[k]), n) > 0.0L;
  if (is_inside) {
    const long double height = glm::dot(p - c[0], n);
    return {height * height / nn, {NearestFeature::Kind::kInside, 0}};
  }
  Foot best{std::numeric_limits<long double>::infinity(), {}};
  for (std::size_t k = 0; k < 3; ++k) {
    long double along = 0.0L;
    const long double distance2 = segment_distance2(p, c[k], c[(k + 1) % 3], along);
    if (distance2 >= best.distance2) continue;
    best = {distance2, {NearestFeature::Kind::kEdge, k}};
    if (along <= 0.0L) best.feature = {NearestFeature::Kind::kCorner, k};
    if (along >= 1.0L) best.feature = {NearestFeature::Kind::kCorner, (k + 1) % 3};
  }
  return best;
}

TriangleCorners draw_triangle(RandomSource& random) {
  for (;;) {
    const TriangleCorners t{random.in_cube(1.0), random.in_cube(1.0), random.in_cube(1.0)};
    if (glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) > 0.05) return t;
  }
}

TEST(PointDistance, OfATriangleWithAreaItIsThatOfItsFoot) {
  RandomSource random(171);
  for (int round = 0; round < 20000; ++round) {
    const double scale = round % 3 == 0 ? 1e-12 : round % 3 == 1 ? 1.0 : 1e12;
    TriangleCorners t = draw_triangle(random);
    for (Vec3d& corner : t) corner *= scale;
    const double v = random.between(-1.0, 2.0), w = random.between(-1.0, 2.0);
    const Vec3d n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    const Vec3d foot = t[0] + (t[1] - t[0]) * v + (t[2] - t[0]) * w;
    const Vec3d p = foot + n * (scale * (round % 2 == 0 ? 0.0 : random.between(-1.0, 1.0)));
    const Foot exact = exact_foot(p, t);
    const double size2 = 16.0 * scale * scale;
    const double found = point_triangle_distance2(p, t);
    ASSERT_NEAR(found, static_cast<double>(exact.distance2), 1e-14 * size2) << "seed 171, round " << round;
    // Of points that are on it nothing is left but the square of a rounding.
    ASSERT_TRUE(exact.distance2 > 1e-32L * size2 || found <= 1e-29 * size2) << "seed 171, round " << round;
  }
}

TEST(PointDistance, OfSegmentsAndPointsToo) {
  RandomSource random(172);
  for (int round = 0; round < 5000; ++round) {
    const double scale = round % 3 == 0 ? 1e-12 : round % 3 == 1 ? 1.0 : 1e12;
    const Vec3d a = random.in_cube(1.0) * scale, edge = random.in_cube(1.0) * scale;
    TriangleCorners t{a, a, a};
    if (round % 4 != 0) t[round % 3] += edge;
    if (round % 4 == 2) t[(round + 1) % 3] += edge * random.between(-1.0, 2.0);
    const Vec3d p = round % 2 == 0 ? random.in_cube(2.0) * scale : a + edge * random.between(-1.0, 2.0);
    const long double exact = exact_foot(p, t).distance2;
    ASSERT_NEAR(point_triangle_distance2(p, t), static_cast<double>(exact), 1e-14 * scale * scale)
        << "seed 172, round " << round;
  }
}

// Around a triangle there are seven regions: its inside, three edges and three corners.
TEST(PointDistance, TheNearestFeatureIsThatOfTheRegion) {
  RandomSource random(173);
  std::array<int, 3> count{};
  for (int round = 0; round < 20000; ++round) {
    const double scale = round % 3 == 0 ? 1e-12 : round % 3 == 1 ? 1.0 : 1e12;
    TriangleCorners t = draw_triangle(random);
    const Vec3d n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double v = random.between(-1.0, 2.0), w = random.between(-1.0, 2.0);
    Vec3d p = (t[0] + (t[1] - t[0]) * v + (t[2] - t[0]) * w + n * random.between(-1.0, 1.0)) * scale;
    for (Vec3d& corner : t) corner *= scale;
    if (round % 5 == 0) p = t[round / 5 % 3];  // on a corner
    const Foot exact = exact_foot(p, t);
    // Where an edge is as near as the inside, but for a billionth, either may be told.
    bool is_near_edge = false;
    for (std::size_t k = 0; k < 3; ++k) {
      long double along = 0.0L;
      is_near_edge |= segment_distance2(Precise3(p), Precise3(t[k]), Precise3(t[(k + 1) % 3]), along) <=
                      exact.distance2 * (1.0L + 2e-9L);
    }
    if (is_near_edge && exact.feature.kind == NearestFeature::Kind::kInside) continue;
    const NearestFeature found = nearest_feature(p, t);
    ASSERT_EQ(found.kind, exact.feature.kind) << "seed 173, round " << round;
    if (exact.feature.kind != NearestFeature::Kind::kInside) {
      ASSERT_EQ(found.index, exact.feature.index) << "seed 173, round " << round;
    }
    ++count[static_cast<std::size_t>(exact.feature.kind)];
  }
  for (const int of_kind : count) EXPECT_GT(of_kind, 500);
}

// Of a triangle on a line nothing is inside, and what is nearest is a point of one of its edges, whatever rounding says
// of the edge's two ends.
TEST(NearestFeature, OfATriangleOnALineItIsAnEdgeOrACorner) {
  test::RandomSource random(177);
  for (int round = 0; round < 20000; ++round) {
    const double scale = round % 3 == 0 ? 1e-30 : round % 3 == 1 ? 1.0 : 1e30;
    const Vec3d from = random.in_cube(1.0) * scale, along = random.in_cube(4.0) * scale;
    TriangleCorners t;
    for (Vec3d& corner : t) corner = from + along * random.between(-1.0, 1.0);
    if (round % 7 == 0) t[2] = t[1];
    if (round % 49 == 0) t[1] = t[2] = t[0];
    Vec3d p = from + along * random.between(-1.5, 1.5);
    if (round % 2 == 0) p += random.in_cube(scale);
    ASSERT_NE(nearest_feature(p, t).kind, NearestFeature::Kind::kInside) << "seed 177, round " << round;
    const Vec3d nearest = nearest_point(p, t);
    const double distance = std::sqrt(point_triangle_distance2(p, t));
    ASSERT_LE(std::fabs(glm::length(p - nearest) - distance), 1e-8 * distance + 1e-14 * scale) << "round " << round;
    ASSERT_LE(std::sqrt(point_triangle_distance2(nearest, t)), 1e-14 * scale) << "of the triangle, round " << round;
  }
}

TEST(NearestFeature, NearestPointsAreAsFarAsIsSaid) {
  test::RandomSource random(178);
  for (int round = 0; round < 20000; ++round) {
    const TriangleCorners t = draw_triangle(random);
    const Vec3d p = random.in_cube(2.0);
    const Vec3d nearest = nearest_point(p, t);
    const double distance = std::sqrt(point_triangle_distance2(p, t));
    ASSERT_LE(std::fabs(glm::length(p - nearest) - distance), 1e-8 * distance + 1e-10) << "seed 178, round " << round;
    ASSERT_LE(std::sqrt(point_triangle_distance2(nearest, t)), 1e-10) << "seed 178, round " << round;
  }
}

Patch draw_patch(RandomSource& random) {
  Patch patch;
  for (Vec3d& corner : patch.corner) corner = random.in_cube(1.0);
  for (std::size_t k = 0; k < 3; ++k) {
    patch.at_corner[k].value = random.unit();
    patch.at_middle[k].value = random.unit();
  }
  return patch;
}

TEST(Patch, PromisesARiseOverItsHighestPoint) {
  RandomSource random(174);
  for (int round = 0; round < 2000; ++round) {
    Patch patch = draw_patch(random);
    const double inside = random.between(-0.2, 1.2), rise = random.between(0.1, 2.0);
    std::vector<double> values{inside};
    for (std::size_t k = 0; k < 3; ++k) {
      values.push_back(patch.at_corner[k].value);
      values.push_back(patch.at_middle[k].value);
    }
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    patch.set_range(inside);
    ASSERT_NEAR(patch.promise(rise), *high + rise * (*high - *low), 1e-15 * (1.0 + rise))
        << "seed 174, round " << round;
    EXPECT_FALSE(patch.is_bounded());
    patch.ceiling = 0.5 * *high;
    EXPECT_TRUE(patch.is_bounded());
    EXPECT_EQ(patch.promise(rise), 0.5 * *high) << "no more than is possible";
  }
}

// 1 / √3 of half the longest edge above the highest of the six: met in the middle of an equilateral patch whose other
// side is nothing but its six points.
TEST(Patch, IsBoundedByWhatNoPointCanBeBeyond) {
  RandomSource random(175);
  for (int round = 0; round < 2000; ++round) {
    Patch patch = draw_patch(random);
    patch.set_range(patch.at_corner[0].value);
    double high = 0.0, longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      high = std::max({high, patch.at_corner[k].value, patch.at_middle[k].value});
      longest = std::max(longest, glm::length(patch.corner[(k + 1) % 3] - patch.corner[k]));
    }
    ASSERT_NEAR(patch.bound(), high + longest / (2.0 * std::sqrt(3.0)), 4e-15) << "seed 175, round " << round;
  }
}

TEST(Patch, OfEqualPromiseTheFirstIsDividedFirst) {
  RankedPatch a{1.0, 5, 0}, b{2.0, 0, 1};
  EXPECT_TRUE(a < b);
  EXPECT_FALSE(b < a);
  b.estimate = 1.0;
  b.order = 6;
  EXPECT_TRUE(b < a) << "what was made later comes behind";
  EXPECT_FALSE(a < b);
  b.order = 5;
  EXPECT_FALSE(a < b || b < a);
}

// The best triangle of those near the six points, by its farthest corner.
TEST(Patch, OneTriangleBoundsItAsItsCornersSay) {
  RandomSource random(176);
  for (int round = 0; round < 300; ++round) {
    judge::Surface surface;
    for (std::uint32_t t = 0; t < 8; ++t) {
      for (int k = 0; k < 3; ++k) surface.positions.push_back(random.in_cube(1.0));
      surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    SurfaceTree tree;
    tree.build({surface.positions, surface.triangles});
    Patch patch = draw_patch(random);
    double expected = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 6; ++k) {
      const TreeSlot slot{random.below(8)};
      (k < 3 ? patch.at_corner[k] : patch.at_middle[k - 3]).place = slot;
      double farthest2 = 0.0;
      for (const Vec3d& corner : patch.corner)
        farthest2 = std::max(farthest2, point_triangle_distance2(corner, tree.corners_at(slot)));
      expected = std::min(expected, std::sqrt(farthest2));
    }
    ASSERT_NEAR(bound_by_one_triangle(tree, patch, 0.0), expected, 1e-14) << "seed 176, round " << round;
    const double enough = expected * 1.5;
    const double found = bound_by_one_triangle(tree, patch, enough);
    ASSERT_GE(found, expected - 1e-14);
    ASSERT_LE(found, std::max(enough, expected) + 1e-14) << "as good as what was asked for";
  }
}

/// Values as a function says, whatever is on the other side: what is worthwhile is the function's doing.
template <class Value>
class ScriptedProbes {
 public:
  ScriptedProbes(const SurfaceTree& tree, double maximum, Value value)
      : tree_(tree), maximum_(maximum), value_(value) {}
  Probe measure(const Vec3d& point, TreeSlot place, std::uint32_t owner) {
    points.push_back(point);
    owners.push_back(owner);
    return {value_(point), place};
  }
  [[nodiscard]] double maximum() const { return maximum_; }
  [[nodiscard]] const SurfaceTree& tree() const { return tree_; }

  std::vector<Vec3d> points;
  std::vector<std::uint32_t> owners;

 private:
  const SurfaceTree& tree_;
  double maximum_;
  Value value_;
};

/// Far from all patches, so that no bound by it is of any use.
const judge::Surface kFarOff{{{900, 0, 0}, {901, 0, 0}, {900, 1, 0}}, {{0, 1, 2}}};

template <class Value>
struct Search {
  SurfaceTree tree;
  ScriptedProbes<Value> probes;
  Patch patch;

  Search(double maximum, Value value) : probes(tree, maximum, value) {
    tree.build({kFarOff.positions, kFarOff.triangles});
    patch.corner = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)};
    patch.owner = 77;
    for (std::size_t k = 0; k < 3; ++k) {
      patch.at_corner[k].value = value(patch.corner[k]);
      patch.at_middle[k].value = value(patch.middle(k));
    }
  }
  /// How many patches are divided, at nine points each.
  std::size_t divided(std::size_t budget, std::size_t spare, Rise rise = {1.0, 1.0}) {
    PatchQueue<ScriptedProbes<Value>> queue(probes, rise, spare);
    patch.set_range(patch.at_corner[0].value);
    queue.add(patch);
    queue.refine(budget);
    EXPECT_EQ(probes.points.size() % 9, 0U);
    return probes.points.size() / 9;
  }
};

TEST(PatchQueue, SpendsItsBudgetAndNoMore) {
  // 0 or 1 as it falls, so that most parts promise 2 over a maximum of 1, and bounds allow it near the start.
  const auto scattered = [](const Vec3d& p) {
    return static_cast<double>(mix64(static_cast<std::uint64_t>(4096.0 * (1.0 + p.x + 64.0 * p.y))) >> 40U & 1U);
  };
  for (const std::size_t budget : {0U, 1U, 2U, 7U, 20U}) {
    EXPECT_EQ((Search{1.0, scattered}.divided(budget, 0)), budget);
    const std::size_t with_spare = Search{1.0, scattered}.divided(budget, 3);
    EXPECT_GE(with_spare, budget);
    EXPECT_LE(with_spare, budget + 3);
  }
}

// What is constant promises nothing. The bound of a patch of edges √2 is √2 / (2 √3) = 0.408 above: worthwhile over a
// maximum of less than 1.408 / 1.002, and then only by the spare effort.
TEST(PatchQueue, SetsAsideWhatOnlyABoundLeavesRoomFor) {
  const auto constant = [](const Vec3d&) { return 1.0; };
  const double bound = 1.0 + std::sqrt(2.0) / (2.0 * std::sqrt(3.0));
  EXPECT_EQ((Search{1.0, constant}.divided(10, 0)), 0U) << "no more than 1.002 times the maximum is promised";
  EXPECT_EQ((Search{1.0, constant}.divided(10, 3)), 3U);
  EXPECT_EQ((Search{bound / 1.0021, constant}.divided(10, 1)), 1U);
  EXPECT_EQ((Search{bound / 1.0019, constant}.divided(10, 1)), 0U);
  // A rise of r over values of 0 and 1 promises 1 + r.
  const auto halves = [](const Vec3d& p) { return p.x + p.y < 0.75 ? 0.0 : 1.0; };
  EXPECT_EQ((Search{1.3 / 1.0021, halves}.divided(1, 0, {0.3, 0.3})), 1U);
  EXPECT_EQ((Search{1.3 / 1.0019, halves}.divided(1, 0, {0.3, 0.3})), 0U);
}

// The first rise has the effort; what is left of it is the last one's, and what that promises is not set aside for the
// spare effort as long as there is any.
TEST(PatchQueue, SpendsWhatIsLeftWhereTheLastRisePromises) {
  const auto halves = [](const Vec3d& p) { return p.x + p.y < 0.75 ? 0.0 : 1.0; };
  EXPECT_EQ((Search{1.5, halves}.divided(1, 0, {0.3, 0.3})), 0U);
  EXPECT_EQ((Search{1.4 / 1.0021, halves}.divided(1, 0, {0.3, 0.4})), 1U);
  EXPECT_EQ((Search{1.4 / 1.0019, halves}.divided(1, 0, {0.3, 0.4})), 0U);
  EXPECT_EQ((Search{1.35, halves}.divided(0, 1, {0.3, 0.6})), 1U) << "with no effort left by its bound";
  // Two patches, one that both rises promise of and one that the last does alone: one effort is the first one's.
  auto towards = [](const Vec3d& p) { return p.z > 0.5 ? (p.x + p.y < 0.75 ? 0.0 : 1.0) : (p.x < 0.6 ? 0.9 : 1.0); };
  for (const std::size_t budget : {1U, 2U}) {
    Search search{1.35, towards};  // parts of either are bounded by less
    PatchQueue<ScriptedProbes<decltype(towards)>> queue(search.probes, {0.4, 4.0}, 0);
    for (const double z : {0.0, 1.0}) {
      Patch patch = search.patch;
      for (Vec3d& p : patch.corner) p.z = z;
      for (std::size_t k = 0; k < 3; ++k) {
        patch.at_corner[k].value = towards(patch.corner[k]);
        patch.at_middle[k].value = towards(patch.middle(k));
      }
      patch.set_range(patch.at_corner[0].value);
      queue.add(patch);
    }
    queue.refine(budget);
    EXPECT_EQ(search.probes.points.size(), 9 * budget);
    EXPECT_EQ(search.probes.points.front().z, 1.0);
    EXPECT_EQ(search.probes.points.back().z, budget == 1 ? 1.0 : 0.0);
  }
}

// The nine points are the middles of the four parts' edges, each once; parts know whose they are.
TEST(PatchQueue, DividesIntoFourWithNineNewPoints) {
  const auto varied = [](const Vec3d& p) { return p.x; };
  Search search{0.1, varied};
  ASSERT_EQ(search.divided(1, 0), 1U);
  std::vector<std::array<double, 2>> found, expected;
  for (const Vec3d& p : search.probes.points) found.push_back({p.x, p.y});
  for (int i = 0; i <= 4; ++i) {
    for (int j = 0; i + j <= 4; ++j) {
      if (i % 2 != 0 || j % 2 != 0) expected.push_back({0.25 * i, 0.25 * j});
    }
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  for (const std::uint32_t owner : search.probes.owners) EXPECT_EQ(owner, 77U);
}

// Whatever lies farthest in a parabola or behind a crease is found to a fraction of a percent.
TEST(PatchQueue, FindsTheTopOfASmoothHill) {
  RandomSource random(177);
  for (int round = 0; round < 100; ++round) {
    const double x = random.between(0.05, 0.6), y = random.between(0.05, 0.95 - x), width = random.between(0.5, 3.0);
    const auto hill = [&](const Vec3d& p) {
      return std::max(0.0, 2.0 - ((p.x - x) * (p.x - x) + (p.y - y) * (p.y - y)) / (width * width));
    };
    SurfaceTree tree;
    tree.build({kFarOff.positions, kFarOff.triangles});
    double maximum = 0.0;
    struct HillProbes {
      const SurfaceTree& of;
      decltype(hill)& value;
      double& top;
      Probe measure(const Vec3d& point, TreeSlot place, std::uint32_t) {
        top = std::max(top, value(point));
        return {value(point), place};
      }
      [[nodiscard]] double maximum() const { return top; }
      [[nodiscard]] const SurfaceTree& tree() const { return of; }
    } probes{tree, hill, maximum};
    Patch patch;
    patch.corner = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)};
    for (std::size_t k = 0; k < 3; ++k) {
      patch.at_corner[k] = probes.measure(patch.corner[k], TreeSlot{0U}, 0);
      patch.at_middle[k] = probes.measure(patch.middle(k), TreeSlot{0U}, 0);
    }
    patch.set_range(patch.at_corner[0].value);
    PatchQueue<HillProbes> queue(probes, {1.0, 1.0}, 0);
    queue.add(patch);
    queue.refine(60);
    EXPECT_GE(maximum, 2.0 / 1.005) << "seed 177, round " << round;
  }
}

/// The two-sided distance, from points so dense that what lies between them is next to nothing.
double dense_distance(const judge::Surface& a, const judge::Surface& b) {
  return test::dense_truth(a, b, 4000);
}

judge::Surface height_field(RandomSource& random, std::uint32_t side, double height) {
  judge::Surface surface;
  for (std::uint32_t i = 0; i <= side; ++i) {
    for (std::uint32_t j = 0; j <= side; ++j) {
      surface.positions.push_back(
          Vec3d(static_cast<double>(i) / side, height * random.signed_unit(), static_cast<double>(j) / side));
    }
  }
  for (std::uint32_t i = 0; i < side; ++i) {
    for (std::uint32_t j = 0; j < side; ++j) {
      const std::uint32_t at = i * (side + 1) + j;
      surface.triangles.push_back({at, at + 1, at + side + 1});
      surface.triangles.push_back({at + 1, at + side + 2, at + side + 1});
    }
  }
  return surface;
}

// Pieces are cut until each is bounded to 5% above its own corners and 3% of the largest: 8% above the truth in all.
// The truth is of samples, which may miss 2%. More than 7% is used: what is allowed is what saves effort.
TEST(CertifiedTightness, IsWithinTenPercentOfTheTruthAndUsesSeven) {
  RandomSource random(178);
  double largest = 0.0;
  for (int round = 0; round < 60; ++round) {
    const double height = random.log_between(0.02, 0.3);
    const judge::Surface fine = height_field(random, 4 + random.below(3), height);
    const judge::Surface coarse = height_field(random, 2 + random.below(2), height);
    const std::vector<TriangleBound> none(fine.triangles.size());
    const CertifiedGroup certified = certify_group(test::as_group(fine), none, test::as_group(coarse));
    const double truth = dense_distance(fine, coarse);
    EXPECT_GE(certified.deviation, truth) << "seed 178, round " << round;
    EXPECT_LE(certified.deviation, 1.1 * truth) << "seed 178, round " << round;
    largest = std::max(largest, certified.deviation / truth);
  }
  EXPECT_GE(largest, 1.07);
}

// What was proven of the finer level is handed on in full, whichever side it is of.
TEST(CertifiedTightness, BoundsOfTheFinerLevelAddUp) {
  RandomSource random(179);
  for (int round = 0; round < 40; ++round) {
    const judge::Surface fine = height_field(random, 4, 0.1), coarse = height_field(random, 2, 0.1);
    const std::vector<TriangleBound> none(fine.triangles.size());
    const CertifiedGroup plain = certify_group(test::as_group(fine), none, test::as_group(coarse));
    double from = 0.0, to = 0.0;
    for (const TriangleBound& bound : plain.bounds) {
      from = std::max(from, bound.from_source);
      to = std::max(to, bound.to_source);
    }
    EXPECT_EQ(plain.deviation, std::max(from, to));
    const double from_before = random.unit(), to_before = random.unit();
    const std::vector<TriangleBound> before(fine.triangles.size(), {from_before, to_before});
    const CertifiedGroup certified = certify_group(test::as_group(fine), before, test::as_group(coarse));
    for (std::size_t t = 0; t < plain.bounds.size(); ++t) {
      if (plain.bounds[t].from_source > 0.0) {
        EXPECT_NEAR(certified.bounds[t].from_source, plain.bounds[t].from_source + from_before, 1e-11);
      } else {
        EXPECT_EQ(certified.bounds[t].from_source, 0.0) << "nothing was handed to it";
      }
      EXPECT_NEAR(certified.bounds[t].to_source, plain.bounds[t].to_source + to_before, 1e-11);
    }
  }
}

// The margin is what numerics.md says: 2^-49 of the bound and 2^-43 of the largest coordinate, for each level.
TEST(CertifiedTightness, TheMarginIsOfTheBoundAndOfTheLargestCoordinate) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      TriangleCorners3 exact{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, grid = exact;
      exact[2][axis] = grid[2][axis] = side * 1024.0;
      EXPECT_EQ(initial_bound(exact, grid).from_source, 0x1p-33) << axis;
      grid[1][axis] += 0x1p40;
      const double moved = 0x1p40;
      EXPECT_EQ(initial_bound(exact, grid).from_source, moved * (1.0 + 0x1p-49) + 0x1p-33) << axis;
      EXPECT_EQ(initial_bound(exact, grid).to_source, initial_bound(exact, grid).from_source);
    }
  }
  TriangleCorners3 exact{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, grid = exact;
  for (std::size_t k = 0; k < 3; ++k) {
    grid = exact;
    grid[k] += Vec3d(3.0, 4.0, 12.0);
    EXPECT_NEAR(initial_bound(exact, grid).from_source, 13.0, 1e-12) << "of corner " << k;
  }
}

// Two parallel triangles, as far apart as said: the bound is that and the margin, at any distance from the origin.
TEST(CertifiedTightness, OfParallelTrianglesItIsTheirDistanceAndTheMargin) {
  for (const double away : {0.0, 1e3, 1e9}) {
    for (const double apart : {0.0, 0x1p-10, 0.5, 0x1p20}) {
      const judge::Surface one{{{away, 0, 0}, {away + 1, 0, 0}, {away, 0, 1}}, {{0, 2, 1}}};
      judge::Surface other = one;
      for (Vec3d& p : other.positions) p.y = apart;
      for (const bool is_up : {false, true}) {
        const judge::Surface &finer = is_up ? other : one, &coarser = is_up ? one : other;
        const CertifiedGroup certified =
            certify_group(test::as_group(finer), std::vector<TriangleBound>(1), test::as_group(coarser));
        const double margin = std::max(away + 1.0, apart) * 0x1p-43;
        EXPECT_NEAR(certified.deviation, apart * (1.0 + 0x1p-49) + margin, 1e-16 + apart * 4e-16 + 1e-3 * margin)
            << away << ", " << apart;
      }
    }
  }
}

TEST(CertifiedTightness, ABoundBeyondFloatsIsABound) {
  TriangleCorners3 exact{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, grid = exact;
  grid[1].x = 1e100;
  EXPECT_NEAR(initial_bound(exact, grid).from_source, 1e100, 1e86);
}

TEST(Capsules, FewTrianglesAreNoHub) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t t = 0; t < kHubTriangles; ++t) {
    EXPECT_FALSE(has_hub(triangles, kHubTriangles + 2)) << t;
    triangles.push_back({0, t + 1, t + 2});
  }
  EXPECT_TRUE(has_hub(triangles, kHubTriangles + 2));
  for (auto& t : triangles) t[0] = t[1];  // each in two corners of its triangle, and no vertex in many
  EXPECT_FALSE(has_hub(triangles, kHubTriangles + 2));
}

}  // namespace
}  // namespace meshlode::builder
