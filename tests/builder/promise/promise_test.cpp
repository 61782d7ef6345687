// SPDX-License-Identifier: GPL-3.0-or-later
// What a build promises besides positions, by closed forms and by points of its own, on easy surfaces and hard ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <tbb/global_control.h>

#include "base/random.h"
#include "builder/builder.h"
#include "builder/promise/painted_source.h"
#include "judge/validate/validate.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::builder {
namespace {

/// A wavy sheet over [-1, 1]² with UVs by a function of (x, y) in [0, 1].
scene::Primitive painted_sheet(std::uint32_t n, double bumps, const std::function<Vec2d(double, double)>& uv) {
  scene::Primitive sheet = lab::make_plane(n);
  for (Vec3d& p : sheet.positions) {
    const Vec2d q = uv(0.5 + 0.5 * p.x, 0.5 + 0.5 * p.z);
    sheet.uvs[0].emplace_back(static_cast<float>(q.x), static_cast<float>(q.y));
    p.y = bumps * std::sin(5.0 * p.x) * std::sin(4.0 * p.z);
  }
  return sheet;
}

/// The scene of one mesh whose material samples its UVs by a texture of unknown size.
scene::Scene textured(scene::Primitive shape) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(std::move(shape)));
  for (scene::SceneMaterial& material : scene.materials) {
    material.uv_sets_used = 1;
    material.textures.push_back({});
  }
  return scene;
}

std::vector<std::uint8_t> built(const scene::Scene& scene, format::Promise promise,
                                format::ErrorTier tier = format::ErrorTier::kMeasured) {
  PipelineOptions options;
  options.promise = promise;
  options.error_tier = tier;
  PipelineReport report;
  auto bytes = build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << bytes.error().message();
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>();
}

run::Asset opened(std::vector<std::uint8_t> bytes) {
  const judge::ValidationReport report = judge::validate_asset(bytes);
  for (const judge::Finding& f : report.findings) ADD_FAILURE() << f.id << " " << f.where << ": " << f.detail;
  auto asset = run::Asset::from_vector(std::move(bytes));
  EXPECT_TRUE(asset) << asset.error().message();
  return std::move(*asset);
}

/// One triangle with position and UVs as lengths: of the source, or of a cut.
struct Patch5 {
  std::array<std::array<double, 5>, 3> corner;
};

std::vector<Patch5> patches_of_source(const scene::Primitive& shape, const format::PromiseMeshRecord& units,
                                      const format::MeshRecord& mesh) {
  std::vector<Patch5> out;
  for (std::size_t i = 0; i + 2 < shape.indices.size(); i += 3) {
    Patch5& patch = out.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = shape.indices[i + k];
      for (int axis = 0; axis < 3; ++axis) patch.corner[k][axis] = shape.positions[v][axis] - mesh.origin[axis];
      patch.corner[k][3] = double{units.uv_object[0][0]} * double{shape.uvs[0][v].x};
      patch.corner[k][4] = double{units.uv_object[0][1]} * double{shape.uvs[0][v].y};
    }
  }
  return out;
}

std::vector<Patch5> patches_of_cut(const run::Asset& asset, const std::vector<ClusterId>& cut) {
  std::vector<Patch5> out;
  const format::PromiseMeshRecord& units = asset.promises()[0];
  const auto decoded = run::decode_all(asset);
  EXPECT_TRUE(decoded);
  for (const ClusterId id : cut) {
    const run::DecodedCluster& cluster = (*decoded)[id.value];
    run::ClusterAttributes floats;
    run::decode_attributes(asset.meshes()[0], cluster, floats);
    for (const auto& t : cluster.triangles) {
      Patch5& patch = out.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        for (int axis = 0; axis < 3; ++axis) patch.corner[k][axis] = double{floats.positions[t[k]][axis]};
        patch.corner[k][3] = double{units.uv_object[0][0]} * double{floats.uvs[0][t[k]].x};
        patch.corner[k][4] = double{units.uv_object[0][1]} * double{floats.uvs[0][t[k]].y};
      }
    }
  }
  return out;
}

/// Squared distance by sections: of a convex function along two directions, with nothing of the builder's.
double patch_distance2(const std::array<double, 5>& q, const Patch5& patch) {
  const auto at = [&](double b, double c) {
    double sum = 0.0;
    for (int d = 0; d < 5; ++d) {
      const double x = patch.corner[0][d] + b * (patch.corner[1][d] - patch.corner[0][d]) +
                       c * (patch.corner[2][d] - patch.corner[0][d]);
      sum += (x - q[d]) * (x - q[d]);
    }
    return sum;
  };
  const auto along_c = [&](double b) {
    double low = 0.0, high = 1.0 - b;
    for (int i = 0; i < 32; ++i) {
      const double x = low + (high - low) / 3.0, y = high - (high - low) / 3.0;
      (at(b, x) < at(b, y) ? high : low) = at(b, x) < at(b, y) ? y : x;
    }
    return at(b, low);
  };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 32; ++i) {
    const double x = low + (high - low) / 3.0, y = high - (high - low) / 3.0;
    (along_c(x) < along_c(y) ? high : low) = along_c(x) < along_c(y) ? y : x;
  }
  return along_c(low);
}

double farthest(const std::vector<Patch5>& from, const std::vector<Patch5>& to, std::uint64_t seed) {
  SplitMix64 random(seed);
  double largest2 = 0.0;
  for (int i = 0; i < 40; ++i) {
    const Patch5& patch = from[random.below(from.size())];
    double b = random.unit(), c = random.unit();
    if (b + c > 1.0) b = 1.0 - b, c = 1.0 - c;
    if (i % 3 == 0) b = i % 2, c = 0.0;
    std::array<double, 5> q{};
    for (int d = 0; d < 5; ++d) {
      q[d] = patch.corner[0][d] + b * (patch.corner[1][d] - patch.corner[0][d]) +
             c * (patch.corner[2][d] - patch.corner[0][d]);
    }
    double best2 = std::numeric_limits<double>::infinity();
    for (const Patch5& other : to) {
      double reach2 = 0.0;  // of its box, so that few are looked at closely
      for (int d = 0; d < 5; ++d) {
        const auto [low, high] = std::minmax({other.corner[0][d], other.corner[1][d], other.corner[2][d]});
        const double off = std::max({low - q[d], q[d] - high, 0.0});
        reach2 += off * off;
      }
      if (reach2 < best2) best2 = std::min(best2, patch_distance2(q, other));
    }
    largest2 = std::max(largest2, best2);
  }
  return std::sqrt(largest2);
}

/// Cuts at several errors of the promise are within them, both ways.
void expect_texels_kept(const scene::Primitive& shape, format::ErrorTier tier = format::ErrorTier::kMeasured) {
  // Of what is proven only the floats are left that UVs are decoded to.
  const double rounding = tier == format::ErrorTier::kCertified ? 1.0 + 1e-6 : 1.001;
  const auto promised =
      opened(built(textured(shape), format::Promise::kTexels, tier)).with_promise(format::Promise::kTexels);
  ASSERT_TRUE(promised);
  const run::Asset& asset = *promised;
  ASSERT_EQ(asset.promises().size(), 1U);
  const std::vector<Patch5> source = patches_of_source(shape, asset.promises()[0], asset.meshes()[0]);
  std::vector<float> errors;
  for (const format::GroupRecord& group : asset.groups()) {
    if (group.error < format::kInfiniteError) errors.push_back(group.error);
  }
  ASSERT_FALSE(errors.empty());
  std::sort(errors.begin(), errors.end());
  for (const double share : {0.3, 0.7, 1.0}) {
    const auto place = static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1));
    const run::UniformCut cut = run::select_uniform(asset, MeshId(0U), double{errors[place]});
    const std::vector<Patch5> drawn = patches_of_cut(asset, cut.clusters);
    ASSERT_FALSE(drawn.empty());
    EXPECT_LE(farthest(drawn, source, 1), rounding * cut.stored_error) << share;
    EXPECT_LE(farthest(source, drawn, 2), rounding * cut.stored_error) << share;
  }
}

TEST(Promise, TheUnitOfATextureIsTheMeanSizeOfATexel) {
  // A sheet of 2 × 2 with a unit square of UVs: a UV unit is 2 object units, whatever the texture's size.
  const run::Asset asset = opened(built(
      textured(painted_sheet(24, 0.0, [](double x, double y) { return Vec2d(x, y); })), format::Promise::kAppearance));
  const format::PromiseMeshRecord& units = asset.promises()[0];
  EXPECT_NEAR(units.uv_object[0][0], 2.0, 1e-5);
  EXPECT_NEAR(units.uv_object[0][1], 2.0, 1e-5);
  EXPECT_NEAR(units.normal_object, asset.meshes()[0].diagonal / 8.0, 1e-6);
  EXPECT_EQ(units.uv_object[1][0], 0.0F);
}

/// So thin that about the mesh's origin it has no area: its texels count all the same, and those of a triangle without
/// area do not. Nor does it matter how often a triangle is there.
TEST(Promise, AnyAreaAtAllCounts) {
  scene::Primitive sheet = painted_sheet(4, 0.0, [](double x, double y) { return Vec2d(x, y); });
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto base = static_cast<std::uint32_t>(sheet.positions.size());
    for (const Vec3d& p : {a, b, c}) sheet.positions.push_back(p);
    for (const Vec2f& uv : {Vec2f(0.0F, 0.0F), Vec2f(1.0F, 0.0F), Vec2f(0.0F, 1.0F)}) sheet.uvs[0].push_back(uv);
    if (!sheet.normals.empty()) sheet.normals.insert(sheet.normals.end(), 3, sheet.normals[0]);
    for (std::uint32_t k = 0; k < 3; ++k) sheet.indices.push_back(base + k);
  };
  const auto unit = [&] {
    const scene::SourceMesh mesh = lab::as_mesh(sheet);
    AttributeLayout layout;
    layout.uv_set_count = 1;
    const std::vector<TexelExtents> extents(1, {{{1024.0, 1024.0}}});
    return uv_units_of(mesh, layout, extents)[0][0];
  };
  EXPECT_NEAR(unit(), 2.0, 1e-12);  // 4 square units of surface for 1 of texture
  add({0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.25, 0.0, 0.0});
  EXPECT_NEAR(unit(), 2.0, 1e-12);
  add({3.0, 0.0, 0.0}, {3.5, 1e-40, 0.0}, {3.0, 0.0, 0.5e-40});
  EXPECT_NEAR(unit(), std::sqrt(4.0 / 1.5), 1e-12);
  const std::vector<std::uint32_t> once = sheet.indices;
  sheet.indices.insert(sheet.indices.end(), once.begin(), once.end());
  EXPECT_NEAR(unit(), std::sqrt(4.0 / 1.5), 1e-12);
}

TEST(Promise, WhatIsLinearOnAFlatSheetCostsNothing) {
  // A plane whose UVs are linear can be two triangles: no texel moves but by what is stored less precisely.
  run::Asset asset = opened(built(textured(painted_sheet(40, 0.0, [](double x, double y) { return Vec2d(x, y); })),
                                  format::Promise::kTexels));
  const double quantization = asset.promises()[0].level0_texels;
  for (std::size_t g = 0; g < asset.groups().size(); ++g) {
    if ((asset.groups()[g].flags & format::kGroupTerminal) != 0) continue;
    EXPECT_LE(asset.promise_errors()[g].texel_error, 4.0 * quantization) << g;
  }
}

TEST(Promise, AWarpedTextureIsMeasured) {
  // Flat, so that positions are within their grid everywhere; what is painted on it is not.
  const auto warp = [](double x, double y) { return Vec2d(x + 0.05 * std::sin(9.0 * x) * std::sin(7.0 * y), y); };
  const scene::Primitive sheet = painted_sheet(40, 0.0, warp);
  expect_texels_kept(sheet);
  run::Asset asset = opened(built(textured(sheet), format::Promise::kTexels));
  float positions = 0.0F, texels = 0.0F;
  for (std::size_t g = 0; g < asset.groups().size(); ++g) {
    if ((asset.groups()[g].flags & format::kGroupTerminal) != 0) continue;
    positions = std::max(positions, asset.groups()[g].error);
    texels = std::max(texels, asset.promise_errors()[g].texel_error);
  }
  EXPECT_GT(texels, 10.0F * positions);
}

void expect_hard_textures_kept(format::ErrorTier tier) {
  expect_texels_kept(painted_sheet(24, 0.1, [](double x, double y) { return Vec2d(x, y); }), tier);
  // Mirrored in the middle: both halves show the same.
  expect_texels_kept(painted_sheet(24, 0.1, [](double x, double y) { return Vec2d(std::abs(2.0 * x - 1.0), y); }),
                     tier);
  // So far from 0 that floats hold few of them.
  expect_texels_kept(painted_sheet(24, 0.1, [](double x, double y) { return Vec2d(1e6 + x, y); }), tier);
  // A seam: two islands that are nowhere near each other.
  scene::Primitive left = painted_sheet(16, 0.1, [](double x, double y) { return Vec2d(x, y); });
  const scene::Primitive right = painted_sheet(16, 0.1, [](double x, double y) { return Vec2d(5.0 - x, y); });
  const auto base = static_cast<std::uint32_t>(left.positions.size());
  double widest = 0.0;
  for (const Vec3d& p : left.positions) widest = std::max(widest, p.x);
  for (const Vec3d& p : right.positions) left.positions.push_back(p + Vec3d(2.0 * widest, 0.0, 0.0));
  left.normals.insert(left.normals.end(), right.normals.begin(), right.normals.end());
  left.uvs[0].insert(left.uvs[0].end(), right.uvs[0].begin(), right.uvs[0].end());
  for (const std::uint32_t i : right.indices) left.indices.push_back(base + i);
  expect_texels_kept(left, tier);
}

TEST(Promise, HardTexturesKeepIt) {
  expect_hard_textures_kept(format::ErrorTier::kMeasured);
}

TEST(Promise, HardTexturesKeepWhatIsProven) {
  expect_hard_textures_kept(format::ErrorTier::kCertified);
}

/// Flat, and thinner than what doubles hold about the mesh's origin: its normal is its own all the same, and what cuts
/// make of it is promised (V209).
TEST(Promise, ANeedleKeepsItsNormalAboutAnyOrigin) {
  scene::Primitive plate = lab::make_plane(12);
  plate.normals.clear();
  for (Vec3d& p : plate.positions) p = 4.0 * (p + Vec3d(1.0, 0.0, 1.0));
  scene::Primitive above = plate;  // so that the origin lies between them, far from both
  for (Vec3d& p : above.positions) p.y += 8.0;
  for (const std::uint32_t i : above.indices)
    plate.indices.push_back(i + static_cast<std::uint32_t>(plate.positions.size()));
  plate.positions.insert(plate.positions.end(), above.positions.begin(), above.positions.end());
  for (int n = 0; n < 200; ++n) {
    const auto base = static_cast<std::uint32_t>(plate.positions.size());
    const double x = 0.01 * n;
    for (const Vec3d& p : {Vec3d(x, 0.0, 0.0), Vec3d(x + 1.0, 0.0, 0.0), Vec3d(x + 0.5, 1e-17, 0.0)})
      plate.positions.push_back(p);
    for (std::uint32_t k = 0; k < 3; ++k) plate.indices.push_back(base + k);
  }
  const scene::Scene scene = lab::as_scene(lab::as_mesh(std::move(plate)));
  for (const format::ErrorTier tier : {format::ErrorTier::kMeasured, format::ErrorTier::kCertified}) {
    const run::Asset asset = opened(built(scene, format::Promise::kAppearance, tier));
    const judge::VerifyReport report = judge::verify_asset(asset, scene, {.uniform_cuts = 4, .cameras = 2});
    for (const judge::Finding& f : report.findings) ADD_FAILURE() << f.id << " " << f.where << ": " << f.detail;
  }
}

/// Triangles in the same place that differ in what is painted on them: each is proven by its own.
TEST(Promise, ManyInOnePlaceAreProven) {
  scene::Primitive pile = painted_sheet(4, 0.1, [](double x, double y) { return Vec2d(x, y); });
  SplitMix64 random(8);
  for (int n = 0; n < 6000; ++n) {
    const auto base = static_cast<std::uint32_t>(pile.positions.size());
    for (const Vec3d& p : {Vec3d(0.0, 0.5, 0.0), Vec3d(0.2, 0.5, 0.0), Vec3d(0.0, 0.5, 0.2)}) {
      pile.positions.push_back(p);
      pile.uvs[0].emplace_back(static_cast<float>(random.unit()), static_cast<float>(random.unit()));
      if (!pile.normals.empty()) pile.normals.push_back(pile.normals[0]);
    }
    for (std::uint32_t k = 0; k < 3; ++k) pile.indices.push_back(base + k);
  }
  const run::Asset asset = opened(built(textured(pile), format::Promise::kTexels, format::ErrorTier::kCertified));
  ASSERT_EQ(asset.promises().size(), 1U);
  EXPECT_LT(asset.promises()[0].level0_texels, 0.01F) << "what quantization moves";
}

/// A bound is no less than what is found, and not many times as much.
TEST(Promise, WhatIsProvenIsNotFarFromWhatIsMeasured) {
  const auto wavy = [](double x, double y) { return Vec2d(x + 0.05 * std::sin(9.0 * x) * std::sin(7.0 * y), y); };
  for (const bool is_flat : {false, true}) {
    scene::Primitive sheet = painted_sheet(32, 0.1, wavy);
    if (!is_flat) sheet = lab::with_smooth_normals(std::move(sheet));
    const auto median = [&](format::ErrorTier tier) {
      const run::Asset asset = opened(built(textured(sheet), format::Promise::kAppearance, tier));
      EXPECT_GE(asset.promises()[0].level0_appearance, asset.promises()[0].level0_texels);
      std::vector<float> errors;
      for (const format::PromiseGroupRecord& group : asset.promise_errors()) {
        EXPECT_GE(group.appearance_error, group.texel_error);
        if (group.appearance_error < format::kInfiniteError) errors.push_back(group.appearance_error);
      }
      std::sort(errors.begin(), errors.end());
      EXPECT_FALSE(errors.empty());
      return errors.empty() ? 0.0F : errors[errors.size() / 2];
    };
    const float measured = median(format::ErrorTier::kMeasured), proven = median(format::ErrorTier::kCertified);
    EXPECT_GT(proven, 0.5F * measured) << is_flat;
    EXPECT_LT(proven, 4.0F * measured) << is_flat;
  }
}

TEST(Promise, WithoutTexturesTexelsArePositions) {
  const auto same = [](const scene::Scene& scene) {
    const run::Asset asset = opened(built(scene, format::Promise::kTexels));
    EXPECT_EQ(asset.promises()[0].uv_object[0][0], 0.0F);
    for (std::size_t g = 0; g < asset.groups().size(); ++g) {
      EXPECT_EQ(asset.promise_errors()[g].texel_error, asset.groups()[g].error);
      EXPECT_EQ(asset.promise_errors()[g].appearance_error, 0.0F);
    }
  };
  same(lab::as_scene(lab::as_mesh(lab::make_sphere(20))));
  // All of the texture is one point, and so no texel.
  same(textured(painted_sheet(24, 0.1, [](double, double) { return Vec2d(0.5, 0.5); })));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  same(textured(painted_sheet(24, 0.1, [=](double, double) { return Vec2d(nan, nan); })));
}

TEST(Promise, NormalsThatTurnAreMoreThanPositions) {
  for (const bool is_flat : {false, true}) {
    scene::Primitive ball = lab::make_sphere(32);
    ball.normals.clear();
    if (!is_flat) ball = lab::with_smooth_normals(std::move(ball));
    const run::Asset asset = opened(built(lab::as_scene(lab::as_mesh(std::move(ball))), format::Promise::kAppearance));
    bool is_any_above = false;
    for (std::size_t g = 0; g < asset.groups().size(); ++g) {
      const float position = asset.groups()[g].error, appearance = asset.promise_errors()[g].appearance_error;
      if (position >= format::kInfiniteError) continue;
      EXPECT_EQ(asset.promise_errors()[g].texel_error, position);
      is_any_above = is_any_above || appearance > position;
      // No two unit vectors are farther apart than 2.
      const double most = std::sqrt(4.0 * asset.promises()[0].normal_object * asset.promises()[0].normal_object +
                                    4.0 * asset.meshes()[0].diagonal * asset.meshes()[0].diagonal);
      EXPECT_LE(appearance, 1.1 * most);
    }
    EXPECT_TRUE(is_any_above);
  }
}

TEST(Promise, ErrorsOfEachNestOverNodesAndGroups) {
  const run::Asset plain =
      opened(built(textured(painted_sheet(40, 0.1, [](double x, double y) { return Vec2d(x * x, y); })),
                   format::Promise::kAppearance));
  const std::vector<format::GroupRecord> before(plain.groups().begin(), plain.groups().end());
  for (const format::Promise promise : {format::Promise::kAppearance, format::Promise::kTexels}) {
    const auto promised = plain.with_promise(promise);
    ASSERT_TRUE(promised);
    const run::Asset& asset = *promised;
    EXPECT_EQ(asset.promise(), promise);
    for (const format::NodeRecord& node : asset.nodes()) {
      if (node.child_count == 0) {
        EXPECT_EQ(node.error, asset.groups()[node.first].error);
        continue;
      }
      for (std::uint32_t c = node.first; c < node.first + node.child_count; ++c) {
        const float below = asset.nodes()[c].error;
        EXPECT_TRUE(node.error > below || below == 0.0F || below >= format::kInfiniteError);
      }
    }
    for (std::size_t g = 0; g < before.size(); ++g) EXPECT_GE(asset.groups()[g].error, before[g].error);
    // The hierarchy finds what looking at every group finds.
    run::Camera camera;
    camera.eye = {0.5, 0.5, 3.0};
    camera.height = 720;
    camera.width = 1280;
    for (const double pixels : {0.25, 1.0, 4.0, 20.0}) {
      EXPECT_EQ(run::select_bvh(asset, camera, pixels), run::select_flat(asset, camera, pixels));
    }
  }
  for (std::size_t g = 0; g < before.size(); ++g) EXPECT_EQ(plain.groups()[g].error, before[g].error);
}

TEST(Promise, WhatWasNotBuiltIsRefusedWithTheRemedy) {
  const scene::Scene scene = textured(painted_sheet(16, 0.1, [](double x, double y) { return Vec2d(x, y); }));
  const run::Asset plain = opened(built(scene, format::Promise::kPosition));
  EXPECT_TRUE(plain.promises().empty());
  const run::Asset texels = opened(built(scene, format::Promise::kTexels));
  EXPECT_TRUE(texels.with_promise(format::Promise::kTexels));
  for (const run::Asset* asset : {&plain, &texels}) {
    const auto promised = asset->with_promise(format::Promise::kAppearance);
    ASSERT_FALSE(promised);
    EXPECT_EQ(promised.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(promised.error().message().find("--promise appearance"), std::string::npos);
  }
}

/// Where positions are estimated no promise rests on the estimate: of a mesh without a texture positions are measured.
TEST(Promise, IsMeasuredInTheTierQemToo) {
  const auto wavy = [](double x, double y) { return Vec2d(x + 0.05 * std::sin(9.0 * x) * std::sin(7.0 * y), y); };
  expect_texels_kept(painted_sheet(32, 0.1, wavy), format::ErrorTier::kQem);
  scene::Primitive bare = painted_sheet(32, 0.1, wavy);
  bare.uvs[0].clear();
  const scene::Scene scene = lab::as_scene(lab::as_mesh(std::move(bare)));
  const run::Asset asset = opened(built(scene, format::Promise::kTexels, format::ErrorTier::kQem));
  bool is_any_above = false;
  for (std::size_t g = 0; g < asset.groups().size(); ++g) {
    if ((asset.groups()[g].flags & format::kGroupTerminal) != 0) continue;
    EXPECT_GE(asset.promise_errors()[g].texel_error, asset.groups()[g].error) << g;
    is_any_above = is_any_above || asset.promise_errors()[g].texel_error > 1.05F * asset.groups()[g].error;
  }
  EXPECT_TRUE(is_any_above) << "estimates fall short of what is measured";
}

TEST(Promise, ThreadsChangeNoByte) {
  const scene::Scene scene = textured(painted_sheet(40, 0.1, [](double x, double y) { return Vec2d(x * x, y); }));
  const std::vector<std::uint8_t> many = built(scene, format::Promise::kAppearance);
  const std::vector<std::uint8_t> proven = built(scene, format::Promise::kAppearance, format::ErrorTier::kCertified);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(built(scene, format::Promise::kAppearance), many);
  EXPECT_EQ(built(scene, format::Promise::kAppearance, format::ErrorTier::kCertified), proven);
}

}  // namespace
}  // namespace meshlode::builder
