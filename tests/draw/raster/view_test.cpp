// SPDX-License-Identifier: GPL-3.0-or-later
// Views: colours mean what they say, and PNG bytes are a PNG.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "draw/raster/legend.h"
#include "draw/raster/raster.h"
#include "support/sample_asset.h"

namespace meshlode::draw {
namespace {

struct Drawn {
  run::Asset asset;
  run::Camera camera;
  std::vector<run::ClusterInstance> cut;
  VisibilityBuffer visibility;
};

Drawn draw_sample() {
  Result<run::Asset> asset = run::Asset::from_vector(test::sample_asset_bytes());
  EXPECT_TRUE(asset.ok());
  run::Camera camera;
  camera.eye = {1.0, 2.0, 40.0};
  camera.target = {2.0, 0.0, 7.0};
  camera.near_distance = 0.1;
  camera.width = 101;
  camera.height = 75;
  std::vector<run::ClusterInstance> cut = run::select_flat(*asset, camera, 0.0);
  Result<VisibilityBuffer> visibility = draw_cut(*asset, cut, camera);
  EXPECT_TRUE(visibility.ok());
  return {std::move(*asset), camera, std::move(cut), std::move(*visibility)};
}

std::uint32_t color_at(const Image& image, std::size_t pixel) {
  return static_cast<std::uint32_t>(image.rgba[4 * pixel] << 16 | image.rgba[4 * pixel + 1] << 8 |
                                    image.rgba[4 * pixel + 2]);
}

TEST(RasterView, EveryViewPaintsExactlyWhatIsVisible) {
  const Drawn drawn = draw_sample();
  for (const View view : {View::kShaded, View::kClusters, View::kTriangles, View::kLevels}) {
    const Result<Image> image = shade_view(drawn.asset, drawn.cut, drawn.camera, drawn.visibility, view);
    ASSERT_TRUE(image.ok());
    const std::uint32_t background = color_at(*image, 0);
    ASSERT_EQ(drawn.visibility.item[0], VisibilityBuffer::kNothing);
    const std::size_t above_legend = std::size_t{drawn.camera.width} * 60;
    for (std::size_t pixel = 0; pixel < above_legend; ++pixel) {
      const bool is_drawn = drawn.visibility.item[pixel] != VisibilityBuffer::kNothing;
      ASSERT_EQ(color_at(*image, pixel) != background, is_drawn) << pixel;
      ASSERT_EQ(image->rgba[4 * pixel + 3], 255);
    }
  }
}

TEST(RasterView, LevelsHaveDifferentColours) {
  std::set<std::array<double, 3>> colors;
  for (std::uint32_t level = 0; level < 12; ++level) colors.insert(level_color(level, 12));
  EXPECT_EQ(colors.size(), 12u);
  EXPECT_GT(level_color(0, 5)[2], level_color(0, 5)[0]);  // fine is blue
  EXPECT_GT(level_color(4, 5)[0], level_color(4, 5)[2]);  // coarse is red
  EXPECT_EQ(level_color(0, 1), level_color(0, 9));
}

TEST(RasterView, HashColoursAreBrightAndDiffer) {
  std::set<std::array<double, 3>> colors;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Rgb color = hash_color(i, 7);
    EXPECT_GE(*std::ranges::max_element(color), 0.55);
    for (const double c : color) EXPECT_TRUE(c >= 0.0 && c <= 1.0);
    colors.insert(color);
  }
  EXPECT_EQ(colors.size(), 1000u);
}

TEST(RasterView, LegendIsLeftOutWhereThereIsNoRoom) {
  for (const std::uint32_t side : {1u, 5u, 12u, 40u, 200u}) {
    Image image{side, side, std::vector<std::uint8_t>(4 * std::size_t{side} * side, 9)};
    draw_level_legend(image, 12);
    const bool is_drawn = std::ranges::any_of(image.rgba, [](std::uint8_t c) { return c != 9; });
    EXPECT_EQ(is_drawn, side >= 200);
  }
}

TEST(RasterView, PngHasItsSignatureSizeAndChannels) {
  Image image{3, 2, std::vector<std::uint8_t>(24, 255)};
  const auto channels_of = [](const std::vector<std::uint8_t>& png) { return png[25] == 2 ? 3 : png[25] == 6 ? 4 : 0; };
  std::vector<std::uint8_t> png = encode_png(image);
  ASSERT_GT(png.size(), 33u);
  EXPECT_EQ((std::vector<std::uint8_t>(png.begin(), png.begin() + 8)),
            (std::vector<std::uint8_t>{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}));
  EXPECT_EQ(png[19], 3);
  EXPECT_EQ(png[23], 2);
  EXPECT_EQ(channels_of(png), 3);
  image.rgba[3] = 0;
  EXPECT_EQ(channels_of(encode_png(image)), 4);
}

}  // namespace
}  // namespace meshlode::draw
