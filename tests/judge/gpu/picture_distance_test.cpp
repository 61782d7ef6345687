// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of hardware raster needs no device: pictures as hardware draws them when something is wrong are drawn by
// the CPU, and each way to be wrong is found.
#include "judge/gpu/picture_distance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "draw/gpu/gpu_support.h"
#include "judge/pictures/cameras.h"
#include "judge/validate/edit.h"
#include "run/select/select.h"

namespace meshlode::judge::test {
namespace {

using draw::VisibilityBuffer;
using meshlode::test::AssetEdit;

constexpr std::uint32_t kWidth = 640, kHeight = 360;

const std::vector<std::uint8_t>& rock_bytes() {
  static const std::vector<std::uint8_t> bytes = draw::test::build_file(MESHLODE_DATA "/rock.glb");
  return bytes;
}
const run::Asset& rock() {
  static const run::Asset asset = std::move(*run::Asset::from_vector(rock_bytes()));
  return asset;
}

VisibilityBuffer draw_picture(const run::Asset& asset, const run::Camera& camera) {
  auto drawn = draw::draw_cut(asset, run::select_flat(asset, camera, 1.0), camera, draw::load_alpha_masks(asset));
  EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message());
  return drawn ? std::move(*drawn) : draw::make_visibility_buffer(camera.width, camera.height);
}

/// The picture of the same camera with everything half a pixel to the left: one column more has its middle there.
VisibilityBuffer draw_half_a_pixel_off(const run::Asset& asset, run::Camera camera) {
  ++camera.width;
  const VisibilityBuffer wide = draw_picture(asset, camera);
  VisibilityBuffer out = draw::make_visibility_buffer(camera.width - 1, camera.height);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      const std::size_t to = std::size_t{y} * out.width + x, from = std::size_t{y} * wide.width + x + 1;
      out.depth[to] = wide.depth[from];
      out.item[to] = wide.item[from];
      out.triangle[to] = wide.triangle[from];
    }
  }
  return out;
}

/// With the pixels of each triangle of the picture, by item and number.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> pixels_by_triangle(
    const VisibilityBuffer& picture) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> out;
  for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
    if (picture.item[i] != VisibilityBuffer::kNothing) out[{picture.item[i], picture.triangle[i]}].push_back(i);
  }
  return out;
}

void leave_out(VisibilityBuffer& picture, std::size_t at) {
  picture.item[at] = picture.triangle[at] = VisibilityBuffer::kNothing;
  picture.depth[at] = 0;
}

/// What `spoil` draws is found from each camera that sees something.
template <class Spoil>
void expect_found(const Spoil& spoil) {
  std::uint64_t tried = 0;
  for (const NamedCamera& named : adversarial_cameras(rock(), kWidth, kHeight)) {
    SCOPED_TRACE(named.name);
    const VisibilityBuffer cpu = draw_picture(rock(), named.camera);
    const bool is_orthographic = named.camera.is_orthographic;
    const PictureDistance own = measure_distance(cpu, cpu, is_orthographic);
    EXPECT_TRUE(own.is_within_bounds());
    EXPECT_EQ(own.differing + own.astray, 0U);
    if (own.covered < 1000) continue;
    ++tried;
    const PictureDistance found = measure_distance(cpu, spoil(cpu, named.camera), is_orthographic);
    EXPECT_FALSE(found.is_within_bounds()) << describe(found);
  }
  EXPECT_EQ(tried, 8U) << "from inside nothing is seen of the rock, from far away a dozen pixels";
}

/// The picture of a camera turned (or moved, where it is orthographic) by so many pixels of the picture's middle.
VisibilityBuffer draw_off_by(const run::Asset& asset, const run::Camera& camera, double pixels) {
  const Vec3d ahead = camera.target - camera.eye;
  const double distance = glm::length(ahead);
  const Vec3d right = glm::normalize(glm::cross(ahead, Vec3d(0.0, 1.0, 0.0)));
  const Vec3d up = glm::normalize(glm::cross(right, ahead));
  const double pixel =
      (camera.is_orthographic ? camera.ortho_height : 2.0 * distance * std::tan(0.5 * camera.fovy)) / camera.height;
  const Vec3d by = pixels * pixel * (0.8 * right + 0.6 * up);
  run::Camera moved = camera;
  if (camera.is_orthographic) moved.eye += by;
  moved.target += by;
  auto out = draw::draw_cut(asset, run::select_flat(asset, camera, 1.0), moved, draw::load_alpha_masks(asset));
  EXPECT_TRUE(out);
  return std::move(*out);
}

/// A step of the grid of 1/256 pixel that hardware snaps corners to, for all of them the same way.
TEST(PictureDistance, AStepOfTheSubpixelGridIsNear) {
  std::uint64_t differing = 0;
  for (const NamedCamera& named : adversarial_cameras(rock(), kWidth, kHeight)) {
    // At an angle of 160 degrees turning moves what is at the side by 30 times as much; down has another up.
    if (named.name == "wide" || named.name == "down") continue;
    SCOPED_TRACE(named.name);
    const PictureDistance found =
        measure_distance(draw_picture(rock(), named.camera), draw_off_by(rock(), named.camera, 1.0 / 256.0),
                         named.camera.is_orthographic);
    EXPECT_TRUE(found.is_within_bounds()) << describe(found);
    differing += found.differing;
  }
  EXPECT_GT(differing, 20U);
}

TEST(PictureDistance, AViewportOffByHalfAPixelIsFound) {
  expect_found(
      [](const VisibilityBuffer&, const run::Camera& camera) { return draw_half_a_pixel_off(rock(), camera); });
}

TEST(PictureDistance, FlippedCullingIsFound) {
  AssetEdit edit(rock_bytes());
  for (std::uint32_t i = 0; i < edit.instances().size(); ++i) {
    edit.instance(i, [](auto& instance) { instance.flags ^= format::kInstanceMirrored; });
  }
  edit.seal();
  const auto flipped = run::Asset::from_vector(edit.bytes());
  ASSERT_TRUE(flipped) << flipped.error().message();
  expect_found([&](const VisibilityBuffer&, const run::Camera& camera) { return draw_picture(*flipped, camera); });
}

TEST(PictureDistance, DepthsAHundredthOffAreFound) {
  for (const double factor : {0.99, 1.01}) {
    expect_found([&](const VisibilityBuffer& cpu, const run::Camera& camera) {
      VisibilityBuffer out = cpu;
      for (std::uint32_t& depth : out.depth) {
        const double moved = camera.is_orthographic ? depth + (factor - 1.0) * 0x1p32 : depth * factor;
        depth = static_cast<std::uint32_t>(std::clamp(moved, 0.0, 4294967295.0));
      }
      return out;
    });
  }
}

TEST(PictureDistance, WhatLiesBehindIsFound) {
  expect_found([](const VisibilityBuffer& cpu, const run::Camera& camera) {
    std::vector<run::ClusterInstance> cut = run::select_flat(rock(), camera, 1.0);
    std::vector<std::uint64_t> pixels_of(cut.size(), 0);
    for (const std::uint32_t item : cpu.item) {
      if (item != VisibilityBuffer::kNothing) ++pixels_of[item];
    }
    cut.erase(cut.begin() + (std::max_element(pixels_of.begin(), pixels_of.end()) - pixels_of.begin()));
    auto out = draw::draw_cut(rock(), cut, camera, draw::load_alpha_masks(rock()));
    EXPECT_TRUE(out);
    return std::move(*out);
  });
}

/// Where it covers more pixels than may differ always, and nearly always where its inside is more than may be astray.
TEST(PictureDistance, AMissingTriangleIsFound) {
  std::uint64_t tried = 0, found = 0, large = 0;
  for (const double fovy : {0.02, 0.005}) {
    run::Camera camera = adversarial_cameras(rock(), kWidth, kHeight)[6].camera;  // keyhole: triangles are large
    camera.fovy = fovy;
    const VisibilityBuffer cpu = draw_picture(rock(), camera);
    for (const auto& [triangle, pixels] : pixels_by_triangle(cpu)) {
      if (pixels.size() < 100) continue;
      VisibilityBuffer without = cpu;
      for (const std::size_t at : pixels) leave_out(without, at);
      const PictureDistance distance = measure_distance(cpu, without, false);
      EXPECT_EQ(distance.differing, pixels.size());
      ++tried;
      found += distance.is_within_bounds() ? 0 : 1;
      if (pixels.size() <= distance.may_differ) continue;
      ++large;
      EXPECT_FALSE(distance.is_within_bounds());
    }
  }
  EXPECT_GT(large, 10U);
  EXPECT_GT(tried, large);
  EXPECT_GE(found * 10, tried * 9) << found << " of " << tried << ", " << large;
}

TEST(PictureDistance, NothingAtAllIsFound) {
  expect_found([](const VisibilityBuffer& cpu, const run::Camera&) {
    return draw::make_visibility_buffer(cpu.width, cpu.height);
  });
}

/// A row of pixels by hand: what counts as different, and what as astray.
TEST(PictureDistance, APixelIsNearToWhatLiesBesideIt) {
  constexpr std::uint32_t kDepth = 1U << 30;
  VisibilityBuffer cpu = draw::make_visibility_buffer(63, 1);
  for (const std::size_t at : {0U, 1U}) {
    cpu.item[at] = cpu.triangle[at] = 0;
    cpu.depth[at] = kDepth;
  }
  VisibilityBuffer drawn = cpu;
  leave_out(drawn, 1);  // beside the background
  PictureDistance found = measure_distance(cpu, drawn, false);
  EXPECT_EQ(found.covered, 2U);
  EXPECT_EQ(found.may_differ, 16U);
  EXPECT_EQ(found.may_be_astray, 2U);
  EXPECT_EQ(found.differing, 1U);
  EXPECT_EQ(found.astray, 0U);
  leave_out(drawn, 0);  // not beside it
  found = measure_distance(cpu, drawn, false);
  EXPECT_EQ(found.differing, 2U);
  EXPECT_EQ(found.astray, 1U);
  EXPECT_EQ(describe(found),
            "2 pixels differ (16 may), 1 by more than a pixel (2 may); pixel 0,0: nothing, the CPU's depth 1073741824");
  drawn = cpu;
  drawn.item[2] = drawn.triangle[2] = 0;
  drawn.depth[2] = kDepth;  // as its neighbour
  found = measure_distance(cpu, drawn, false);
  EXPECT_EQ(found.differing, 1U);
  EXPECT_EQ(found.astray, 0U);
  drawn.depth[2] = kDepth / 2;  // as nothing there
  EXPECT_EQ(measure_distance(cpu, drawn, false).astray, 1U);
  // A depth of its own: 2^-12 of it and a step of a float may be, 2^-12 of the whole range where it is linear.
  drawn = cpu;
  drawn.depth[0] = kDepth - (kDepth >> 12) - 256;
  EXPECT_EQ(measure_distance(cpu, drawn, false).differing, 0U);
  --drawn.depth[0];
  EXPECT_EQ(measure_distance(cpu, drawn, false).astray, 1U);
  EXPECT_EQ(measure_distance(cpu, drawn, true).differing, 0U);
  drawn.depth[0] = kDepth - (1U << 20) - 257;
  EXPECT_EQ(measure_distance(cpu, drawn, true).astray, 1U);
}

/// As many as may be are allowed, and not one more.
TEST(PictureDistance, TheBoundIsThatOfAFrame) {
  const VisibilityBuffer empty = draw::make_visibility_buffer(kWidth, kHeight);
  VisibilityBuffer drawn = empty;
  for (std::size_t i = 0; i < 31; ++i) drawn.item[i] = drawn.triangle[i] = 0;
  EXPECT_TRUE(measure_distance(empty, drawn, false).is_within_bounds());
  drawn.item[31] = drawn.triangle[31] = 0;
  EXPECT_FALSE(measure_distance(empty, drawn, false).is_within_bounds());

  VisibilityBuffer wall = empty;
  for (std::size_t i = 0; i < wall.pixel_count(); ++i) {
    wall.item[i] = wall.triangle[i] = 0;
    wall.depth[i] = i % 2 == 0 ? 1U << 30 : 1U << 29;
  }
  drawn = wall;
  for (std::size_t i = 0; i < 250; ++i) drawn.depth[2 * i] = 3U << 28;
  EXPECT_TRUE(measure_distance(wall, drawn, false).is_within_bounds());
  drawn.depth[500] = 3U << 28;
  const PictureDistance found = measure_distance(wall, drawn, false);
  EXPECT_FALSE(found.is_within_bounds());
  EXPECT_EQ(found.astray, 0U);
}

}  // namespace
}  // namespace meshlode::judge::test
