// SPDX-License-Identifier: GPL-3.0-or-later
// Aggregates that were built are what V208 asks for, everything else holds too; and where they are not, it is found.
#include <algorithm>
#include <cmath>

#include <sys/resource.h>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/builder.h"
#include "judge/metrics/coverage.h"
#include "judge/validate/edit.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "support/sanitized.h"

namespace meshlode::judge {
namespace {

using test::AssetEdit;

std::vector<std::uint8_t> build_aggregate(const scene::Scene& scene,
                                          format::ErrorTier tier = format::ErrorTier::kMeasured) {
  builder::PipelineOptions options;
  options.error_tier = tier;
  options.aggregate = AggregateChoice::kAlways;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message();
  return std::move(*bytes);
}

scene::Scene scene_of(scene::Primitive shape) {
  shape.normals.clear();
  shape.uvs[0].clear();
  return lab::as_scene(lab::as_mesh(std::move(shape)));
}

std::string found_in(const std::vector<std::uint8_t>& bytes, const scene::Scene& scene) {
  const Result<run::Asset> asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  const VerifyReport report =
      verify_asset(*asset, scene, {.uniform_cuts = 20, .cameras = 10, .deviation_cuts = 5, .deviation_samples = 2000});
  std::string text;
  for (const Finding& finding : report.findings) text += finding.id + " " + finding.detail + "\n";
  return text;
}

std::uint32_t groups_of(const AssetEdit& edit) {
  return static_cast<std::uint32_t>(edit.count(format::SectionId::kGroups, sizeof(format::GroupRecord)));
}

TEST(Aggregates, OfEveryKindHold) {
  for (const scene::Primitive& shape : {lab::make_grass(1500), lab::make_box_soup(300), lab::make_crown(1500),
                                        lab::make_loose_pieces(800), lab::scaled(lab::make_grass(600), 1e-5)}) {
    const scene::Scene scene = scene_of(shape);
    const std::vector<std::uint8_t> bytes = build_aggregate(scene);
    EXPECT_EQ(found_in(bytes, scene), "");
    const Result<run::Asset> asset = run::Asset::from_vector(bytes);
    EXPECT_EQ(asset->header().version, format::kVersion);
    EXPECT_TRUE(has_aggregates(*asset, MeshId(0U)));
  }
}

/// A handful of cards stands for all of them soon, and is as large as the mesh.
TEST(Aggregates, SmallOnesHold) {
  for (const std::uint32_t count : {150U, 387U, 1617U, 3184U}) {
    for (const scene::Primitive& shape : {lab::make_grass(count), lab::make_box_soup(count / 5 + 10),
                                          lab::make_crown(count), lab::make_loose_pieces(count)}) {
      const scene::Scene scene = scene_of(shape);
      EXPECT_EQ(found_in(build_aggregate(scene), scene), "") << count;
    }
  }
}

TEST(Aggregates, OfOtherKindsHoldAndHaveLevels) {
  for (const std::string& kind : lab::aggregate_kinds()) {
    const scene::Scene scene = scene_of(lab::make_aggregate_kind(kind, 3000));
    const std::vector<std::uint8_t> bytes = build_aggregate(scene);
    EXPECT_EQ(found_in(bytes, scene), "") << kind;
    const Result<run::Asset> asset = run::Asset::from_vector(bytes);
    EXPECT_TRUE(has_aggregates(*asset, MeshId(0U))) << kind;
    std::uint64_t triangles = 0;
    for (const ClusterId c : run::select_uniform(*asset, MeshId(0U), 1e3).clusters)
      triangles += asset->clusters()[c.value].triangle_count();
    EXPECT_LT(triangles, 100U) << kind << ": its roots, of " << scene.meshes[0].primitives[0].indices.size() / 3;
  }
}

TEST(Aggregates, OfAWallNoDirectionIsFarOffAtThirtyPixels) {
  const std::vector<std::uint8_t> bytes = build_aggregate(scene_of(lab::make_aggregate_kind("ivy", 10000)));
  const Result<run::Asset> asset = run::Asset::from_vector(bytes);
  ASSERT_TRUE(asset.ok());
  const auto triangles_at = [&](double size) {
    auto triangles = covering_triangles(*asset, {}, MeshId(0U), run::select_uniform(*asset, MeshId(0U), size).clusters);
    EXPECT_TRUE(triangles.ok());
    return std::move(*triangles);
  };
  const std::vector<CoveringTriangle> source = triangles_at(-1.0);
  Vec3d low = source[0].corners[0], high = low;
  for (const CoveringTriangle& triangle : source) {
    for (const Vec3d& corner : triangle.corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }
  const double pixel = std::max({high.x - low.x, high.y - low.y, high.z - low.z}) / 30.0;
  const std::vector<CoveringTriangle> cut = triangles_at(pixel);
  EXPECT_LT(cut.size(), source.size() / 10);
  const auto drift = measure_coverage(source, cut, {}, pixel);
  ASSERT_TRUE(drift);
  EXPECT_LT(drift->worst_direction, 0.15) << "seen along itself it shows little";
}

TEST(Aggregates, OfEveryTierHold) {
  const scene::Scene scene = scene_of(lab::make_grass(800));
  for (const format::ErrorTier tier : {format::ErrorTier::kQem, format::ErrorTier::kCertified}) {
    EXPECT_EQ(found_in(build_aggregate(scene, tier), scene), "");
  }
}

TEST(Aggregates, ErrorsThatAreTooSmallAreFound) {
  const scene::Scene scene = scene_of(lab::make_grass(1500));
  AssetEdit edit(build_aggregate(scene));
  for (std::uint32_t g = 0; g < groups_of(edit); ++g) {
    edit.group(g, [](auto& group) {
      for (float* value : {&group.error, &group.quadric_error, &group.deviation}) {
        if (*value < format::kInfiniteError) *value *= 0.25F;
      }
    });
  }
  for (std::uint32_t n = 0; n < edit.count(format::SectionId::kNodes, sizeof(format::NodeRecord)); ++n) {
    edit.node(n, [](auto& node) {
      if (node.error < format::kInfiniteError) node.error *= 0.25F;
    });
  }
  edit.seal();
  EXPECT_EQ(found_in(edit.bytes(), scene).substr(0, 4), "V208");
}

TEST(Aggregates, WithoutTheFlagTheirBordersAreNone) {
  const scene::Scene scene = scene_of(lab::make_box_soup(300));  // closed, and cards are not
  AssetEdit edit(build_aggregate(scene));
  edit.header([](auto& header) { header.version = format::kPlainVersion; });
  for (std::uint32_t g = 0; g < groups_of(edit); ++g) {
    edit.group(g, [](auto& group) { group.flags &= static_cast<std::uint16_t>(~format::kGroupAggregate); });
  }
  edit.seal();
  EXPECT_NE(found_in(edit.bytes(), scene).find("L507"), std::string::npos);
}

TEST(Aggregates, TheirMaterialsAreWhole) {
  scene::Scene scene = scene_of(lab::make_grass(800));
  scene.materials[0].double_sided = false;
  const std::vector<std::uint8_t> bytes = build_aggregate(scene);
  const Result<run::Asset> asset = run::Asset::from_vector(bytes);
  ASSERT_EQ(asset->materials().size(), 2U);
  EXPECT_EQ(found_in(bytes, scene), "");
  AssetEdit edit(bytes);
  edit.material(1, [](auto& material) { material.double_sided = 0; });
  edit.seal();
  const std::string found = found_in(edit.bytes(), scene);
  EXPECT_NE(found.find("L509"), std::string::npos) << found;
  EXPECT_NE(found.find("V106"), std::string::npos) << found;
}

/// A trunk that goes by distances and leaves that go by coverage, in one mesh of the source.
scene::Scene trunk_and_leaves() {
  scene::SourceMesh mesh = lab::as_mesh(lab::scaled(lab::make_sphere(24), 0.4));
  mesh.primitives.push_back(lab::make_crown(2000));
  for (std::uint32_t m = 0; m < 2; ++m) {
    mesh.primitives[m].material = MaterialId(m);
    mesh.primitives[m].normals.clear();
    mesh.primitives[m].uvs[0].clear();
  }
  scene::Scene scene = lab::as_scene(std::move(mesh));
  scene.materials.resize(2, scene.materials[0]);
  return scene;
}

TEST(AggregateParts, EachGoesByItsOwnRule) {
  const scene::Scene scene = trunk_and_leaves();
  for (const format::ErrorTier tier :
       {format::ErrorTier::kMeasured, format::ErrorTier::kCertified, format::ErrorTier::kQem}) {
    const std::vector<std::uint8_t> bytes = build_aggregate(scene, tier);
    EXPECT_EQ(found_in(bytes, scene), "");
    const Result<run::Asset> asset = run::Asset::from_vector(bytes);
    ASSERT_TRUE(asset.ok());
    ASSERT_EQ(asset->meshes().size(), 2U);
    EXPECT_EQ(asset->string(asset->meshes()[1].name), "sample#leaves");
    for (std::uint32_t m = 0; m < 2; ++m) {
      const format::MeshRecord& mesh = asset->meshes()[m];
      EXPECT_GE(mesh.group_count, 5U);
      for (const format::GroupRecord& group : asset->groups().subspan(mesh.first_group, mesh.group_count)) {
        const bool is_terminal = (group.flags & format::kGroupTerminal) != 0;
        EXPECT_EQ((group.flags & format::kGroupAggregate) != 0, m == 1 && !is_terminal);
      }
    }
  }
}

TEST(AggregateParts, OfEachErrorsThatAreTooSmallAreFound) {
  const scene::Scene scene = trunk_and_leaves();
  const std::vector<std::uint8_t> bytes = build_aggregate(scene);
  for (const bool is_of_trunk : {false, true}) {
    AssetEdit edit(bytes);
    for (std::uint32_t g = 0; g < groups_of(edit); ++g) {
      edit.group(g, [&](auto& group) {
        const bool is_aggregate = (group.flags & format::kGroupAggregate) != 0;
        if (is_aggregate == is_of_trunk) return;
        for (float* value : {&group.error, &group.quadric_error, &group.deviation}) {
          if (*value < format::kInfiniteError) *value *= 0.25F;
        }
      });
    }
    edit.seal();
    const std::string found = found_in(edit.bytes(), scene);
    EXPECT_NE(found.find(is_of_trunk ? "V206" : "V208"), std::string::npos) << found;
  }
}

/// The asset whose META says another thing in the same number of letters.
std::vector<std::uint8_t> with_meta(const std::vector<std::uint8_t>& bytes, const std::string& from,
                                    const std::string& to) {
  AssetEdit edit(bytes);
  const format::SectionEntry meta = edit.section(format::SectionId::kMeta);
  const auto begin = edit.bytes().begin() + static_cast<std::ptrdiff_t>(meta.offset);
  const auto end = begin + static_cast<std::ptrdiff_t>(meta.bytes);
  const auto found = std::search(begin, end, from.begin(), from.end());
  EXPECT_TRUE(found != end && from.size() == to.size()) << from;
  std::copy(to.begin(), to.end(), found);
  edit.seal();
  return edit.bytes();
}

TEST(AggregateParts, MetaThatSaysOtherPartsIsFound) {
  const scene::Scene scene = trunk_and_leaves();
  const std::vector<std::uint8_t> bytes = build_aggregate(scene);
  const std::pair<const char*, const char*> changes[] = {{R"("parts")", R"("PARTS")"},
                                                         {R"("mesh":1,"of":0)", R"("mesh":0,"of":0)"},
                                                         {R"("mesh":1,"of":0)", R"("mesh":1,"of":1)"},
                                                         {R"("mesh":1,"of":0)", R"("mesh":1,"of":9)"},
                                                         {R"("mesh":1,"of":0)", R"("mesh":[],"o":0)"},
                                                         {R"("pieces":[{)", R"("PIECES":[{)"},
                                                         {R"("material":1)", R"("material":0)"},
                                                         {R"("triangles":512)", R"("triangles":001)"},
                                                         {R"("triangles":512)", R"("triangles":1.5)"}};
  for (const auto& [from, to] : changes) {
    const Result<run::Asset> asset = run::Asset::from_vector(with_meta(bytes, from, to));
    ASSERT_TRUE(asset.ok()) << to;
    const VerifyReport report = verify_asset(*asset, scene, {.uniform_cuts = 1, .cameras = 1, .deviation_cuts = 0});
    EXPECT_TRUE(std::any_of(report.findings.begin(), report.findings.end(), [](const Finding& finding) {
      return finding.id == "V101" || finding.id == "V103";
    })) << to;
  }
}

std::vector<CoveringTriangle> cards(int count, double size) {
  std::vector<CoveringTriangle> out;
  SplitMix64 random(4);
  for (int k = 0; k < count; ++k) {
    const Vec3d at(random.unit(), random.unit(), random.unit());
    const Vec3d u(size * random.signed_unit(), size * random.signed_unit(), size * random.signed_unit());
    const Vec3d v(size * random.signed_unit(), size * random.signed_unit(), size * random.signed_unit());
    out.push_back({{at, at + u, at + v}});
  }
  return out;
}

TEST(CoverageDrift, SaysHowMuchMoreOrLess) {
  const std::vector<CoveringTriangle> source = cards(400, 0.02);
  const auto same = measure_coverage(source, source, {}, 0.05);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->rms, 0.0);
  EXPECT_EQ(same->mean, 0.0);
  EXPECT_EQ(same->contrast, 1.0);
  const auto half = measure_coverage(source, std::span(source).first(200), {}, 0.05);
  EXPECT_NEAR(half->mean, -0.5, 0.1) << "sparse: few hide each other";
  EXPECT_GT(half->rms, 0.5);
  const auto nothing = measure_coverage(source, {}, {}, 0.05);
  EXPECT_NEAR(nothing->mean, -1.0, 1e-12);
  EXPECT_NEAR(nothing->rms, 1.0, 1e-12);
  EXPECT_EQ(nothing->contrast, 0.0);
  EXPECT_FALSE(measure_coverage(source, source, {}, 1e-9)) << "pictures too large to look at";
  EXPECT_FALSE(measure_coverage({}, source, {}, 0.05));
}

TEST(CoverageDrift, HowFewPixelsLieIsNoMatter) {
  const std::vector<CoveringTriangle> source = cards(60, 0.5);
  std::vector<CoveringTriangle> moved = source;
  for (CoveringTriangle& triangle : moved) {
    for (Vec3d& corner : triangle.corners) corner += Vec3d(0.11, 0.07, -0.09);
  }
  constexpr double kPixel = 1.2;
  double least = 1.0, most = 0.0;
  for (const double out : {0.0, 0.1, 0.2, 0.3, 0.4, 0.5}) {
    // Crumbs all around move where the first pixel starts.
    std::vector<CoveringTriangle> with = source, moved_with = moved;
    for (const Vec3d& at : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}) {
      for (const double side : {-1.0, 1.0}) {
        const Vec3d corner = Vec3d(0.5) + side * (1.0 + out * kPixel) * at;
        const CoveringTriangle crumb{{corner, corner + 1e-3 * Vec3d(at.y, at.z, at.x), corner + 1e-3 * at}};
        with.push_back(crumb);
        moved_with.push_back(crumb);
      }
    }
    const auto drift = measure_coverage(with, moved_with, {}, kPixel);
    ASSERT_TRUE(drift);
    least = std::min(least, drift->rms);
    most = std::max(most, drift->rms);
  }
  EXPECT_LT(most, 1.03 * least);
}

TEST(CoverageDrift, OfNeedlesMoreSamplesHaveLessLuck) {
  std::vector<CoveringTriangle> source, moved;
  SplitMix64 random(9);
  for (int k = 0; k < 60; ++k) {
    const Vec3d at{4.0 * random.unit(), 4.0 * random.unit(), 4.0 * random.unit()};
    const Vec3d along = glm::normalize(Vec3d{random.signed_unit(), random.signed_unit(), random.signed_unit()});
    const Vec3d across = 0.01 * glm::normalize(glm::cross(along, Vec3d(0.3, 0.5, 0.8)));
    const Vec3d to = at + Vec3d(0.37, -0.21, 0.11);
    source.push_back({{at, at + 0.5 * along, at + across}});
    moved.push_back({{to, to + 0.5 * along, to + across}});
  }
  double worst = 0.0, worst_closer = 0.0;
  for (const double size : {0.10, 0.11, 0.12, 0.13, 0.14, 0.15}) {
    const auto drift = measure_coverage(source, moved, {}, size),
               closer = measure_coverage(source, moved, {}, size, 8.0);
    ASSERT_TRUE(drift && closer);
    worst = std::max(worst, std::abs(drift->mean));
    worst_closer = std::max(worst_closer, std::abs(closer->mean));
  }
  EXPECT_LT(worst_closer, worst) << "both cover the same";
  EXPECT_LT(worst_closer, 0.01);
}

TEST(CoverageDrift, LooksThroughMasks) {
  draw::AlphaMasks masks;
  masks.images.push_back({2, 1, {255, 0}});
  draw::AlphaMask mask;
  mask.threshold = 1;
  mask.image = 0;
  mask.row_u = {2.0, 0.0, 0.0};
  mask.row_v = {0.0, 1.0, 0.0};
  masks.masks.push_back(mask);
  CoveringTriangle a{{Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(1, 1, 0)}, {Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1)}, 0};
  CoveringTriangle b{{Vec3d(0, 0, 0), Vec3d(1, 1, 0), Vec3d(0, 1, 0)}, {Vec2d(0, 0), Vec2d(1, 1), Vec2d(0, 1)}, 0};
  const std::vector<CoveringTriangle> masked{a, b};
  a.mask = b.mask = format::kNone;
  const std::vector<CoveringTriangle> whole{a, b};
  const auto drift = measure_coverage(whole, masked, masks, 0.1);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->mean, -0.5, 0.02) << "the left half passes";
}

TEST(CoverageDrift, SamplesThatSeeSomethingCountNotThoseOfWhatAMaskHides) {
  // Crumbs, and around them a sheet two thousand times their area that lets everything through.
  draw::AlphaMasks masks;
  masks.images.push_back({1, 1, {0}});
  draw::AlphaMask mask;
  mask.threshold = 1;
  mask.image = 0;
  masks.masks.push_back(mask);
  std::vector<CoveringTriangle> source{{{Vec3d(-0.5, -0.5, 0), Vec3d(1.5, -0.5, 0), Vec3d(0.5, 1.5, 0)}, {}, 0}}, moved;
  for (const CoveringTriangle& crumb : cards(40, 0.01)) {
    CoveringTriangle there = crumb, elsewhere = crumb;
    for (std::size_t k = 0; k < 3; ++k) {
      there.corners[k] *= 0.2;
      elsewhere.corners[k] = there.corners[k] + Vec3d(0.0037, -0.0021, 0.0011);
    }
    source.push_back(there);
    moved.push_back(elsewhere);
  }
#ifdef MESHLODE_LONG_SERIES
  constexpr double kSizes[] = {0.040, 0.043, 0.046, 0.050, 0.054};
#else
  constexpr double kSizes[] = {0.040, 0.054};
#endif
  for (const double size : kSizes) {
    const auto drift = measure_coverage(source, moved, masks, size);
    ASSERT_TRUE(drift);
    EXPECT_NEAR(drift->mean, 0.0, 0.02) << size;
  }
}

TEST(CoverageDrift, PicturesTakeWhatTrianglesMayReachNotWhatIsAroundThem) {
  if (test::kIsSanitized) GTEST_SKIP() << "a sanitizer's own memory counts";
  // Needles on one line in a pixel as large as all of them: thousands of samples a pixel, and two pixels around.
  std::vector<CoveringTriangle> source, moved;
  SplitMix64 random(12);
  const Vec3d along(0.16, 0.95, 0.04), aside(2e-5, 0.0, 1e-5);
  for (int k = 0; k < 200; ++k) {
    const double from = 0.5 * random.unit();
    source.push_back({{from * along, (from + 0.5) * along, from * along + aside}});
    moved.push_back({{from * along + aside, (from + 0.5) * along + aside, from * along + 2.0 * aside}});
  }
  const auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;  // KiB
  };
  const auto before = peak();
  const auto drift = measure_coverage(source, moved, {}, 0.9);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->mean, 0.0, 0.05);  // needles on one line share their luck
  EXPECT_LT(peak() - before, 64 * 1024);
}

}  // namespace
}  // namespace meshlode::judge
