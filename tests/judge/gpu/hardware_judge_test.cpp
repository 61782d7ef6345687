// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of hardware raster needs no device: the CPU's own picture is one of those that are allowed, and each way to
// spoil a pixel of it is found.
#include "judge/gpu/hardware_judge.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>

#include <gtest/gtest.h>

#include "draw/gpu/gpu_support.h"
#include "draw/raster/cut_pages.h"
#include "draw/raster/projection.h"
#include "judge/gpu/hardware_freedom.h"
#include "support/random.h"
#include "support/sample_asset.h"

namespace meshlode::judge::test {
namespace {

using draw::ClipVertex;
using meshlode::test::RandomSource;

constexpr std::uint32_t kBits = 8;

/// A picture of an asset, and what the judge says of it.
struct Picture {
  const run::Asset& asset;
  run::Camera camera;
  std::vector<run::ClusterInstance> cut;
  draw::VisibilityBuffer pixels;
  draw::AlphaMasks masks;

  Picture(const run::Asset& a, const run::Camera& c, double pixel_error)
      : asset(a), camera(c), masks(draw::load_alpha_masks(a)) {
    cut = run::select_flat(asset, camera, pixel_error);
    auto drawn = draw::draw_cut(asset, cut, camera, masks);
    EXPECT_TRUE(drawn);
    if (drawn) pixels = std::move(*drawn);
  }
  [[nodiscard]] Comparison judge(const draw::VisibilityBuffer& drawn) const {
    const auto out = judge_hardware_pixels(asset, cut, drawn, camera, masks, kBits);
    EXPECT_TRUE(out) << (out ? "" : out.error().message());
    return out ? *out : Comparison{};
  }
  [[nodiscard]] bool is_inner(std::size_t i, int radius) const {
    const int x = static_cast<int>(i % pixels.width), y = static_cast<int>(i / pixels.width);
    for (int v = y - radius; v <= y + radius; ++v) {
      for (int u = x - radius; u <= x + radius; ++u) {
        if (u < 0 || v < 0 || u >= static_cast<int>(pixels.width) || v >= static_cast<int>(pixels.height)) return false;
        if (pixels.item[static_cast<std::size_t>(v) * pixels.width + static_cast<std::size_t>(u)] ==
            draw::VisibilityBuffer::kNothing) {
          return false;
        }
      }
    }
    return true;
  }
  /// What the judge allows the pixel's own triangle there.
  [[nodiscard]] std::optional<TriangleFreedom::Sample> freedom_at(std::size_t i) const {
    const run::ClusterInstance& entry = cut[pixels.item[i]];
    const format::InstanceRecord& instance = asset.instances()[entry.instance.value];
    const auto pages = draw::CutPages::load(asset, cut);
    auto projection = draw::make_projection(camera);
    if (!pages || !projection) return std::nullopt;
    projection->far_distance = draw::scene_depth(asset, *projection);
    const draw::GridToClip to_clip = draw::make_grid_to_clip(*projection, asset.meshes()[instance.mesh], instance);
    run::DecodedCluster cluster;
    pages->decode(asset, entry.cluster, cluster);
    const auto [a, b, c] = cluster.triangles[pixels.triangle[i]];
    const TriangleFreedom freedom({to_clip.project(cluster.position(a)), to_clip.project(cluster.position(b)),
                                   to_clip.project(cluster.position(c))},
                                  projection->size, kBits);
    return freedom.at(static_cast<std::int32_t>(i % pixels.width), static_cast<std::int32_t>(i / pixels.width));
  }
};

const run::Asset& rock() {
  static const run::Asset asset = [] {
    auto opened = run::Asset::from_vector(draw::test::build_file(MESHLODE_DATA "/rock.glb"));
    EXPECT_TRUE(opened);
    return std::move(opened).value();
  }();
  return asset;
}

std::vector<run::Camera> cameras_inside(const run::Asset& asset, std::uint64_t seed, int count) {
  const WorldBox box = world_box(asset);
  const double size = glm::length(box.high - box.low);
  RandomSource random(seed);
  std::vector<run::Camera> out;
  for (int i = 0; i < count; ++i) {
    run::Camera camera;
    camera.width = 160;
    camera.height = 120;
    camera.near_distance = size * random.log_between(1e-5, 1e-1);
    for (int k = 0; k < 3; ++k) camera.eye[k] = box.low[k] + random.between(0.05, 0.95) * (box.high[k] - box.low[k]);
    camera.target = camera.eye + random.direction();
    camera.fovy = random.between(0.05, 2.9);
    out.push_back(camera);
  }
  return out;
}

TEST(HardwareJudge, TheCpusOwnPictureIsOneThatIsAllowed) {
  const auto sample = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(sample);
  std::uint64_t covered = 0;
  for (const run::Asset* asset : {&*sample, &rock()}) {
    std::vector<run::Camera> cameras = cameras_inside(*asset, 41, 40);
    for (const NamedCamera& named : adversarial_cameras(*asset, 160, 120)) cameras.push_back(named.camera);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const Picture picture(*asset, cameras[i], 1.0);
      const Comparison found = picture.judge(picture.pixels);
      EXPECT_EQ(found.differences, 0U) << "camera " << i << ": " << found.first;
      covered += found.items;
    }
  }
  EXPECT_GT(covered, 100000U);
}

TEST(HardwareJudge, ADepthThatItsTriangleHasNotThereIsFound) {
  const Picture picture(rock(), adversarial_cameras(rock(), 160, 120)[0].camera, 1.0);
  std::uint64_t tried = 0, narrow = 0;
  for (std::size_t i = 0; i < picture.pixels.pixel_count(); i += 97) {
    if (picture.pixels.item[i] == draw::VisibilityBuffer::kNothing) continue;
    const auto allowed = picture.freedom_at(i);
    ASSERT_TRUE(allowed);
    EXPECT_LE(allowed->low, static_cast<double>(picture.pixels.depth[i]));
    EXPECT_GE(allowed->high, static_cast<double>(picture.pixels.depth[i]));
    ++tried;
    narrow += allowed->high - allowed->low < 1e-3 * allowed->high ? 1 : 0;
    for (const double depth : {allowed->low - 1.0, allowed->high + 1.0}) {
      draw::VisibilityBuffer spoiled = picture.pixels;
      spoiled.depth[i] = static_cast<std::uint32_t>(depth);
      EXPECT_EQ(picture.judge(spoiled).differences, 1U) << "pixel " << i << " at depth " << depth;
    }
  }
  EXPECT_GT(tried, 30U);
  EXPECT_GT(narrow * 10, tried * 9) << "a thousandth of the depth is seen at nearly every pixel";
}

TEST(HardwareJudge, ATriangleThatIsNotThereIsFound) {
  const Picture picture(rock(), adversarial_cameras(rock(), 160, 120)[1].camera, 1.0);
  RandomSource random(43);
  std::uint64_t tried = 0, found = 0;
  for (std::size_t i = 0; i < picture.pixels.pixel_count(); i += 61) {
    if (picture.pixels.item[i] == draw::VisibilityBuffer::kNothing) continue;
    draw::VisibilityBuffer spoiled = picture.pixels;
    const std::uint32_t other = random.below(24);
    if (other == spoiled.triangle[i]) continue;
    spoiled.triangle[i] = other;
    ++tried;
    found += picture.judge(spoiled).differences == 1 ? 1 : 0;
  }
  EXPECT_GT(tried, 50U);
  EXPECT_GE(found * 50, tried * 49) << found << " of " << tried << "; a neighbour that shares the edge may be there";
}

TEST(HardwareJudge, APixelLeftOutIsFound) {
  const Picture picture(rock(), adversarial_cameras(rock(), 160, 120)[0].camera, 1.0);
  std::uint64_t tried = 0, found = 0;
  for (std::size_t i = 0; i < picture.pixels.pixel_count(); i += 61) {
    if (!picture.is_inner(i, 1)) continue;
    draw::VisibilityBuffer spoiled = picture.pixels;
    spoiled.item[i] = spoiled.triangle[i] = draw::VisibilityBuffer::kNothing;
    spoiled.depth[i] = 0;
    ++tried;
    found += picture.judge(spoiled).differences == 1 ? 1 : 0;
  }
  EXPECT_GT(tried, 50U);
  EXPECT_EQ(found, tried);
}

/// A pixel that no triangle covers but by sharing it with its neighbour: on the diagonal of a square.
TEST(HardwareJudge, APixelLeftOutOnASharedEdgeIsFound) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "meshlode_shared_edge.obj";
  std::ofstream(path) << "v -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nf 1 2 3\nf 1 3 4\n";
  const auto asset = run::Asset::from_vector(draw::test::build_file(path.string()));
  std::filesystem::remove(path);
  ASSERT_TRUE(asset);
  run::Camera camera;
  camera.eye = {0.0, 0.0, 10.0};
  camera.target = {0.0, 0.0, 0.0};
  camera.is_orthographic = true;
  camera.ortho_height = 8.0;
  camera.width = camera.height = 64;
  const Picture picture(*asset, camera, 1.0);
  EXPECT_EQ(picture.judge(picture.pixels).differences, 0U);
  std::uint64_t on_edge = 0;
  for (std::uint32_t y = 20; y < 44; ++y) {
    const std::size_t i = std::size_t{y} * 64 + (63 - y);  // the diagonal runs through these centres
    ASSERT_NE(picture.pixels.item[i], draw::VisibilityBuffer::kNothing);
    const auto allowed = picture.freedom_at(i);
    ASSERT_TRUE(allowed);
    on_edge += allowed->is_certain ? 0 : 1;
    draw::VisibilityBuffer spoiled = picture.pixels;
    spoiled.item[i] = spoiled.triangle[i] = draw::VisibilityBuffer::kNothing;
    spoiled.depth[i] = 0;
    EXPECT_EQ(picture.judge(spoiled).differences, 1U) << i;
    // Either of the two may have it.
    draw::VisibilityBuffer other = picture.pixels;
    other.triangle[i] = 1 - other.triangle[i];
    EXPECT_EQ(picture.judge(other).differences, 0U) << i;
  }
  EXPECT_EQ(on_edge, 24U);
}

TEST(HardwareJudge, WhatLiesBehindIsFoundWhereSomethingCoversIt) {
  const Picture picture(rock(), adversarial_cameras(rock(), 160, 120)[0].camera, 1.0);
  std::vector<std::uint64_t> pixels_of(picture.cut.size(), 0);
  for (const std::uint32_t item : picture.pixels.item) {
    if (item != draw::VisibilityBuffer::kNothing) ++pixels_of[item];
  }
  const auto widest =
      static_cast<std::size_t>(std::max_element(pixels_of.begin(), pixels_of.end()) - pixels_of.begin());
  std::vector<run::ClusterInstance> without = picture.cut;
  without.erase(without.begin() + static_cast<std::ptrdiff_t>(widest));
  auto drawn = draw::draw_cut(picture.asset, without, picture.camera, picture.masks);
  ASSERT_TRUE(drawn);
  for (std::uint32_t& item : drawn->item) {
    if (item != draw::VisibilityBuffer::kNothing && item >= widest) ++item;  // indices into the whole cut
  }
  const Comparison found = picture.judge(*drawn);
  EXPECT_GE(found.differences * 10, pixels_of[widest] * 9) << found.first;
  EXPECT_GT(pixels_of[widest], 20U);
}

TEST(HardwareJudge, APictureMovedByAPixelIsFound) {
  const Picture picture(rock(), adversarial_cameras(rock(), 160, 120)[0].camera, 1.0);
  draw::VisibilityBuffer moved = picture.pixels;
  for (auto* channel : {&moved.depth, &moved.item, &moved.triangle}) {
    std::rotate(channel->begin(), channel->begin() + 1, channel->end());
  }
  const Comparison found = picture.judge(moved);
  EXPECT_GT(found.differences * 4, found.items);
}

/// Points of randomly moved corners: where the moved triangle covers the sample, at its depth there.
TEST(HardwareFreedom, HoldsEveryTriangleWhoseCornersMovedByLessThanTheGrid) {
  RandomSource random(47);
  const draw::ImageSize size{64, 64};
  std::uint64_t covering = 0, certain = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<ClipVertex, 3> v;
    double sx[3], sy[3], sz[3];
    const bool is_sliver = random.chance(0.3);
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = random.log_between(0.1, 10.0);
      const double x = random.between(-30.0, 30.0),
                   y = is_sliver ? 0.3 * x + random.between(-0.01, 0.01) : random.between(-30.0, 30.0);
      v[k] = {x * w, y * w, 0.1, w};
      sx[k] = 32.0 + x;
      sy[k] = 32.0 + y;
      sz[k] = 0.1 / w;
    }
    const TriangleFreedom freedom(v, size, kBits);
    for (std::size_t k = 0; k < 3; ++k) {
      sx[k] += random.between(-1.0, 1.0) / 256.0;
      sy[k] += random.between(-1.0, 1.0) / 256.0;
    }
    const double area = (sx[1] - sx[0]) * (sy[2] - sy[0]) - (sx[2] - sx[0]) * (sy[1] - sy[0]);
    for (int tries = 0; tries < 20; ++tries) {
      const int x = static_cast<int>(random.below(64)), y = static_cast<int>(random.below(64));
      double weight[3];
      for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        weight[k] = ((sx[b] - sx[a]) * (y + 0.5 - sy[a]) - (sy[b] - sy[a]) * (x + 0.5 - sx[a])) / area;
      }
      const bool covers = weight[0] >= 0.0 && weight[1] >= 0.0 && weight[2] >= 0.0;
      const auto sample = freedom.at(x, y);
      if (covers) {
        ++covering;
        ASSERT_TRUE(sample) << i;
        const double depth = (weight[0] * sz[0] + weight[1] * sz[1] + weight[2] * sz[2]) * 4294967296.0;
        EXPECT_GE(depth, sample->low) << i;
        EXPECT_LE(depth, sample->high) << i;
      }
      if (!sample || !sample->is_certain) continue;
      ++certain;
      EXPECT_TRUE(covers) << i;
    }
  }
  EXPECT_GT(covering, 5000U);
  EXPECT_GT(certain * 10, covering * 8) << "most samples leave no freedom of coverage";
}

/// A needle whose area rounding makes up has no barycentric coordinates of its own; one that is wide enough has.
TEST(HardwareFreedom, ANeedleHasAnyDepthOfItsCornersWhereItsAreaIsOpen) {
  const draw::ImageSize size{64, 64};
  for (const double width : {0.0, 1e-4, 1e-1, 10.0}) {
    const TriangleFreedom freedom({ClipVertex{-25.0, -25.0, 0.2, 1.0}, ClipVertex{25.0, 25.0, 0.4, 1.0},
                                   ClipVertex{25.0 - width, 25.0 + width, 0.4, 1.0}},
                                  size, kBits);
    const auto sample = freedom.at(31, 31);
    ASSERT_TRUE(sample) << width;
    const double range = (sample->high - sample->low) / 4294967296.0;
    EXPECT_EQ(freedom.is_facing_open(), width < 1e-2) << width;
    if (freedom.is_facing_open()) {
      EXPECT_GE(range, 0.2) << width;
    } else {
      EXPECT_LT(range, 2e-3) << width;
    }
    EXPECT_FALSE(freedom.at(31, 10)) << "and is nowhere else";
  }
}

}  // namespace
}  // namespace meshlode::judge::test
