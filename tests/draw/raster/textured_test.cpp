// SPDX-License-Identifier: GPL-3.0-or-later
// Textured pixels: derivatives against differences, texels where a card shows one a block of pixels, and normal maps
// that lean the way their picture says.
#include <cmath>

#include <gtest/gtest.h>

#include "draw/raster/pixel_surface.h"
#include "draw/raster/raster.h"
#include "lab/samples/write_png.h"
#include "support/mask_scene.h"
#include "support/parallel_camera.h"

namespace meshlode::draw {
namespace {

TEST(PixelWeights, DerivativesAreTheLimitOfDifferences) {
  const ClipVertex triangles[][3] = {
      {{-40.0, -30.0, 0.1, 1.0}, {90.0, 10.0, 0.1, 2.5}, {5.0, 120.0, 0.1, 4.0}},
      {{-10.0, 3.0, 0.1, 1.0}, {30.0, 8.0, 0.1, 1.0}, {0.0, 40.0, 0.1, 1.0}},        // orthographic
      {{20.0, -20.0, 0.1, -0.5}, {50.0, 60.0, 0.1, 3.0}, {-80.0, 30.0, 0.1, 2.0}}};  // behind the viewer
  for (const auto& t : triangles) {
    const double px = 6.0, py = 11.0, h = 1e-5;
    const auto at = [&](double x, double y) { return find_pixel_weights(t[0], t[1], t[2], x, y); };
    const PixelWeights here = at(px, py);
    for (int k = 0; k < 3; ++k) {
      ASSERT_GT(here.at[k], 0.0) << "the point lies inside";
      EXPECT_NEAR(here.right[k], (at(px + h, py).at[k] - at(px - h, py).at[k]) / (2.0 * h), 1e-7);
      EXPECT_NEAR(here.down[k], (at(px, py + h).at[k] - at(px, py - h).at[k]) / (2.0 * h), 1e-7);
    }
    EXPECT_NEAR(here.at.x + here.at.y + here.at.z, 1.0, 1e-12);
    EXPECT_NEAR(here.right.x + here.right.y + here.right.z, 0.0, 1e-12);
  }
}

struct CardOptions {
  lab::Texture base, normal;  ///< empty: none
  bool is_mirrored = false;   ///< u runs the other way
};

/// A square from -1 to 1 in the xy plane, seen along -z; v points down.
scene::Scene card_scene(const CardOptions& options) {
  scene::Scene scene;
  scene.source_name = "card.glb";
  scene.source_hash = "00000000000000000000000000000000";
  scene::Primitive card;
  card.positions = {{-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}, {-1.0, 1.0, 0.0}};
  const float left = options.is_mirrored ? 1.0F : 0.0F;
  card.uvs[0] = {{left, 1.0F}, {1.0F - left, 1.0F}, {1.0F - left, 0.0F}, {left, 0.0F}};
  card.indices = {0, 1, 2, 0, 2, 3};
  card.material = MaterialId(0u);
  scene::SourceMesh mesh;
  mesh.name = "card";
  mesh.primitives = {card};
  scene.meshes = {mesh};
  scene::SceneMaterial material;
  material.source_index = 0;
  material.uv_sets_used = 1;
  scene.materials = {material};
  std::string info, images, textures;
  const auto add = [&](const lab::Texture& texture, const std::string& key) {
    if (texture.rgba.empty()) return std::string();
    const std::string index = std::to_string(scene.blobs.size());
    scene::SceneBlob blob;
    blob.name = key + ".png";
    blob.mime_type = "image/png";
    blob.bytes = lab::encode_png(texture);
    scene.blobs.push_back(blob);
    textures += (textures.empty() ? "" : ",") + std::string(R"({"sampler":0,"source":)") + index + "}";
    images += (images.empty() ? "" : ",") + std::string(R"({"blob":)") + index + "}";
    return "\"" + key + R"(":{"index":)" + index + "}";
  };
  const std::string base = add(options.base, "baseColorTexture"), normal = add(options.normal, "normalTexture");
  info = base.empty() ? "" : R"("pbrMetallicRoughness":{)" + base + "}";
  if (!normal.empty()) info += (info.empty() ? "" : ",") + normal;
  if (!base.empty()) {
    scene.materials[0].base_color_texture = 0;
    scene.materials[0].base_color_uv_set = 0;
  }
  scene.document = R"({"asset":{"version":"2.0"},"materials":[{)" + info + R"(}],"textures":[)" + textures +
                   R"(],"samplers":[{"wrapS":33071,"wrapT":33071}],"images":[)" + images + "]}";
  scene::SceneInstance instance;
  instance.name = "card";
  instance.mesh = MeshId(0u);
  scene.instances = {instance};
  return scene;
}

struct Picture {
  Image image;
  VisibilityBuffer visibility;
};

/// 64 × 64 pixels, orthographic: the card is the picture's middle 32 × 32.
Picture picture_of(const CardOptions& options) {
  const auto asset = run::Asset::from_vector(test::built(card_scene(options)));
  EXPECT_TRUE(asset);
  const run::Camera camera = meshlode::test::parallel_camera({0.0, 0.0, 0.0}, 5.0, 4.0, 64, 64);
  const auto cut = run::select_flat(*asset, camera, 0.0);
  auto visibility = draw_cut(*asset, cut, camera);
  EXPECT_TRUE(visibility);
  const TextureSet textures = load_textures(*asset);
  EXPECT_TRUE(textures.warnings.empty());
  auto image = shade_view(*asset, cut, camera, *visibility, View::kShaded, textures);
  EXPECT_TRUE(image);
  return {std::move(*image), std::move(*visibility)};
}

std::uint8_t channel(const Picture& picture, std::uint32_t x, std::uint32_t y, std::size_t k) {
  return picture.image.rgba[4 * (std::size_t{y} * picture.image.width + x) + k];
}

lab::Texture plain(std::uint32_t size, std::array<std::uint8_t, 4> color) {
  lab::Texture out{size, size, {}};
  for (std::uint32_t i = 0; i < size * size; ++i) {
    for (const std::uint8_t c : color) out.rgba.push_back(c);
  }
  return out;
}

/// 8 × 8 texels on 32 × 32 pixels: in the middle of a texel's four pixels its colour is the light's share of it.
TEST(Textured, ATexelIsSeenWhereItLies) {
  lab::Texture base{8, 8, {}};
  for (std::uint32_t y = 0; y < 8; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) {
      const bool is_white = ((x * 5 + y * 3 + x * y) % 3) == 0;  // neighbours differ here and there
      for (int k = 0; k < 3; ++k) base.rgba.push_back(is_white ? 255 : 0);
      base.rgba.push_back(255);
    }
  }
  const Picture bright = picture_of({plain(1, {255, 255, 255, 255}), {}, false});
  CardOptions options;
  options.base = base;
  for (const bool is_mirrored : {false, true}) {
    options.is_mirrored = is_mirrored;
    const Picture picture = picture_of(options);
    for (std::uint32_t y = 0; y < 8; ++y) {
      for (std::uint32_t x = 0; x < 8; ++x) {
        const std::uint32_t tx = is_mirrored ? 7 - x : x;
        const bool is_white = base.rgba[4 * (y * 8 + tx)] == 255;
        // Pixel centres nearest to a texel's centre are an eighth of a texel off it in each direction.
        double light = 0.0, full = 0.0;
        for (const std::uint32_t dy : {1U, 2U}) {
          for (const std::uint32_t dx : {1U, 2U}) {
            const std::uint8_t c = channel(picture, 16 + 4 * x + dx, 16 + 4 * y + dy, 0);
            const std::uint8_t w = channel(bright, 16 + 4 * x + dx, 16 + 4 * y + dy, 0);
            light += c * c;  // to_display() took the root
            full += w * w;
          }
        }
        EXPECT_GT(full, 0.0);
        if (is_white) {
          EXPECT_GT(light / full, 0.7) << x << "," << y;
        } else {
          EXPECT_LT(light / full, 0.3) << x << "," << y;
        }
      }
    }
  }
}

/// A half of sRGB is 0.216 of the light.
TEST(Textured, BaseColoursAreSrgb) {
  const Picture white = picture_of({plain(4, {255, 255, 255, 255}), {}, false});
  const Picture half = picture_of({plain(4, {128, 128, 128, 255}), {}, false});
  const double light = channel(half, 30, 30, 1) * channel(half, 30, 30, 1),
               full = channel(white, 30, 30, 1) * channel(white, 30, 30, 1);
  EXPECT_NEAR(light / full, 0.2159, 0.01);
}

/// The light comes from the upper left. A normal map that leans left or up is brighter, right or down darker; and it
/// does so where UVs are mirrored, too: green stays up, red follows u.
TEST(Textured, NormalMapsLeanAsTheirPictureSays) {
  const auto with = [&](std::uint8_t r, std::uint8_t g, bool is_mirrored) {
    return channel(picture_of({{}, plain(4, {r, g, 230, 255}), is_mirrored}), 30, 33, 0);
  };
  const std::uint8_t flat = channel(picture_of({{}, plain(4, {128, 128, 255, 255}), false}), 30, 33, 0);
  const std::uint8_t none = channel(picture_of({plain(1, {255, 255, 255, 255}), {}, false}), 30, 33, 0);
  EXPECT_NEAR(flat, none, 2) << "128 is nearly 0";
  for (const bool is_mirrored : {false, true}) {
    EXPECT_GT(with(128, 220, is_mirrored), flat + 3) << "up";
    EXPECT_LT(with(128, 36, is_mirrored), flat - 10) << "down";
    const std::uint8_t along_u = with(220, 128, is_mirrored), against_u = with(36, 128, is_mirrored);
    if (is_mirrored) {
      EXPECT_GT(along_u, against_u + 10) << "u points left";
    } else {
      EXPECT_GT(against_u, along_u + 10) << "u points right";
    }
  }
}

}  // namespace
}  // namespace meshlode::draw
