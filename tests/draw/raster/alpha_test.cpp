// SPDX-License-Identifier: GPL-3.0-or-later
// The alpha test against a ray caster in long doubles that shares no code with it, and its parts against closed forms.
#include "draw/raster/alpha_cutoff.h"

#include <cmath>

#include <gtest/gtest.h>

#include "draw/raster/raster.h"
#include "draw/textures/texture_image.h"
#include "support/mask_scene.h"

namespace meshlode::draw {
namespace {

TEST(AlphaTest, WrappedTexelsAreThoseOfAnEndlessRow) {
  for (const std::uint32_t count : {1U, 2U, 3U, 7U, 16384U}) {
    const auto n = static_cast<std::int64_t>(count);
    for (std::int64_t i = -5 * n; i <= 5 * n; i += 1 + n / 5) {
      // Walked from 0 instead of divided.
      std::int64_t repeat = i, mirror = i;
      while (repeat < 0) repeat += n;
      while (repeat >= n) repeat -= n;
      while (mirror < 0) mirror += 2 * n;
      while (mirror >= 2 * n) mirror -= 2 * n;
      if (mirror >= n) mirror = 2 * n - 1 - mirror;
      EXPECT_EQ(wrap_texel(i, count, Wrap::kRepeat), repeat);
      EXPECT_EQ(wrap_texel(i, count, Wrap::kMirror), mirror);
      EXPECT_EQ(wrap_texel(i, count, Wrap::kClamp), i < 0 ? 0 : i >= n ? n - 1 : i);
    }
  }
}

TEST(AlphaTest, EveryPlaceHasATexel) {
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
    EXPECT_EQ(texel_at(0.0, 7, wrap), 0U);
    EXPECT_EQ(texel_at(6.999, 7, wrap), 6U);
    EXPECT_EQ(texel_at(7.5, 7, wrap), wrap_texel(7, 7, wrap));
    EXPECT_EQ(texel_at(-0.25, 7, wrap), wrap_texel(-1, 7, wrap));
    for (const double far : {1e300, -1e300, HUGE_VAL, -HUGE_VAL, std::nan("")})
      EXPECT_LT(texel_at(far, 7, wrap), 7U) << far;
  }
}

TEST(AlphaTest, QuotientsAreDefinedByProducts) {
  std::uint64_t state = 3;
  const auto random = [&] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 200000; ++i) {
    const double divisor = std::ldexp(1.0 + random(), static_cast<int>(400.0 * random()) - 200);
    double value = (random() - 0.5) * divisor * std::ldexp(1.0, static_cast<int>(44.0 * random()));
    if (i % 3 == 0) value = std::floor(value / divisor) * divisor;  // on or beside a border
    const std::int64_t q = floor_quotient(value, divisor);
    EXPECT_LE(static_cast<double>(q) * divisor, value);
    EXPECT_GT(static_cast<double>(q + 1) * divisor, value);
  }
  EXPECT_EQ(floor_quotient(1e30, 1.0), 0);
  EXPECT_EQ(floor_quotient(std::nan(""), 1.0), 0);
  EXPECT_EQ(floor_quotient(7.0, 2.0), 3);
  EXPECT_EQ(floor_quotient(-7.0, 2.0), -4);
}

struct Card {
  run::Asset asset;
  std::vector<run::ClusterInstance> cut;
};

/// All of level 0 of the cards; without the wall.
Card open_cards(const test::MaskSceneOptions& options) {
  scene::Scene scene = test::mask_scene(options);
  scene.instances.erase(scene.instances.begin());
  auto asset = run::Asset::from_vector(test::built(scene));
  EXPECT_TRUE(asset);
  Card out{std::move(asset).value(), {}};
  const format::MeshRecord& mesh = out.asset.meshes()[out.asset.instances()[0].mesh];
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    if (out.asset.clusters()[c].level == 0) out.cut.push_back({InstanceId(0u), ClusterId(c)});
  }
  return out;
}

run::Camera card_camera() {
  run::Camera camera;
  camera.eye = {2.0, -1.5, 6.0};
  camera.target = {0.1, 0.2, 0.0};
  camera.near_distance = 0.1;
  camera.width = 161;
  camera.height = 121;
  return camera;
}

/// What a ray through a pixel finds out about one card, and how sure it is.
struct Found {
  bool is_drawn = false, is_sure = false;
};

Found look(const Card& card, std::size_t item, std::uint32_t triangle, const run::Camera& camera, std::uint32_t x,
           std::uint32_t y, const test::MaskSceneOptions& options) {
  using Long = long double;
  struct V {
    Long x, y, z;
  };
  const auto sub = [](V a, V b) { return V{a.x - b.x, a.y - b.y, a.z - b.z}; };
  const auto cross = [](V a, V b) { return V{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; };
  const auto dot = [](V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const auto unit = [&](V a) {
    const Long l = std::sqrt(dot(a, a));
    return V{a.x / l, a.y / l, a.z / l};
  };
  const format::MeshRecord& mesh = card.asset.meshes()[card.asset.instances()[0].mesh];
  run::DecodedCluster cluster;
  const auto page = run::load_page(
      card.asset, PageId(card.asset.groups()[card.asset.clusters()[card.cut[item].cluster.value].coarser_group].page));
  run::decode_cluster(card.asset, *page, card.cut[item].cluster, cluster);
  run::ClusterAttributes attributes;
  run::decode_attributes(mesh, cluster, attributes);
  const auto point = [&](std::size_t k) {
    const Vec3f& p = attributes.positions[cluster.triangles[triangle][k]];
    return V{static_cast<Long>(p.x) + mesh.origin[0], static_cast<Long>(p.y) + mesh.origin[1],
             static_cast<Long>(p.z) + mesh.origin[2]};
  };
  const V eye{camera.eye.x, camera.eye.y, camera.eye.z};
  const V forward = unit(sub({camera.target.x, camera.target.y, camera.target.z}, eye));
  const V right = unit(cross(forward, {0, 1, 0}));
  const V up = cross(right, forward);
  const Long scale = 2.0L * std::tan(0.5L * static_cast<Long>(camera.fovy)) / camera.height;
  const Long sx = (x + 0.5L - 0.5L * camera.width) * scale, sy = -(y + 0.5L - 0.5L * camera.height) * scale;
  const V ray{forward.x + right.x * sx + up.x * sy, forward.y + right.y * sx + up.y * sy,
              forward.z + right.z * sx + up.z * sy};
  const V a = point(0), ab = sub(point(1), a), ac = sub(point(2), a), h = cross(ray, ac);
  const Long det = dot(ab, h);
  const V rest = sub(eye, a);
  Long w[3];
  w[1] = dot(rest, h) / det;
  w[2] = dot(ray, cross(rest, ab)) / det;
  w[0] = 1.0L - w[1] - w[2];
  Found out;
  out.is_sure = w[0] > 1e-6L && w[1] > 1e-6L && w[2] > 1e-6L;
  const std::uint32_t k = card.asset.materials()[cluster.triangle_material[triangle]].source_index - 1;
  Long uv[2] = {0, 0}, alpha = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint8_t v = cluster.triangles[triangle][c];
    if (options.has_texture) {
      uv[0] += w[c] * attributes.uvs[0][v].x;
      uv[1] += w[c] * attributes.uvs[0][v].y;
    }
    alpha += attributes.colors.empty() ? w[c] : w[c] * attributes.colors[v].w;
  }
  const std::uint32_t size[2] = {test::kMaskTextureWidth, test::kMaskTextureHeight};
  std::uint32_t texel[2] = {0, 0};
  for (std::size_t axis = 0; axis < 2 && options.has_texture; ++axis) {
    Long t = uv[axis];
    switch (test::kWrapNames[axis == 0 ? k % 3 : k / 3]) {
      case 10497: t -= std::floor(t); break;
      case 33648: t = std::fabs(t - 2.0L * std::floor(0.5L * t + 0.5L)); break;
      default: t = std::clamp(t, 0.0L, 1.0L);
    }
    t *= size[axis];
    out.is_sure = out.is_sure && (std::fabs(t - std::round(t)) > 1e-6L || t < 1e-6L || t > size[axis] - 1e-6L);
    texel[axis] = std::min(static_cast<std::uint32_t>(t), size[axis] - 1);
  }
  const Long vertex_alpha = std::floor(alpha * 255.0L + 0.5L);
  out.is_sure = out.is_sure && std::fabs(alpha * 255.0L + 0.5L - std::round(alpha * 255.0L + 0.5L)) > 1e-6L;
  const Long texture = options.has_texture ? test::mask_texture_alpha(texel[0], texel[1]) : 255;
  const Long found =
      texture * (attributes.colors.empty() ? 255.0L : vertex_alpha) / 65025.0L * static_cast<Long>(options.factor);
  out.is_drawn = found >= static_cast<Long>(options.cutoff);
  out.is_sure = out.is_sure && std::fabs(found - static_cast<Long>(options.cutoff)) > 1e-6L;
  return out;
}

void expect_rays_agree(const test::MaskSceneOptions& options) {
  const Card card = open_cards(options);
  const run::Camera camera = card_camera();
  const AlphaMasks masks = load_alpha_masks(card.asset);
  ASSERT_FALSE(masks.is_empty());
  const auto opaque = draw_cut(card.asset, card.cut, camera);
  const auto masked = draw_cut(card.asset, card.cut, camera, masks);
  ASSERT_TRUE(opaque && masked);
  std::size_t sure = 0, drawn = 0, cut_away = 0;
  for (std::size_t i = 0; i < opaque->pixel_count(); ++i) {
    if (opaque->item[i] == VisibilityBuffer::kNothing) {
      EXPECT_EQ(masked->item[i], VisibilityBuffer::kNothing);
      continue;
    }
    const auto look_at = [&](const VisibilityBuffer& buffer) {
      return look(card, buffer.item[i], buffer.triangle[i], camera, static_cast<std::uint32_t>(i % camera.width),
                  static_cast<std::uint32_t>(i / camera.width), options);
    };
    const bool is_drawn = masked->item[i] == opaque->item[i] && masked->triangle[i] == opaque->triangle[i];
    (is_drawn ? drawn : cut_away) += 1;
    if (is_drawn) {
      EXPECT_EQ(masked->depth[i], opaque->depth[i]);
    } else if (masked->item[i] != VisibilityBuffer::kNothing) {  // what is behind
      EXPECT_LT(masked->depth[i], opaque->depth[i]);
      const Found behind = look_at(*masked);
      EXPECT_TRUE(behind.is_drawn || !behind.is_sure);
    }
    const Found found = look_at(*opaque);
    if (!found.is_sure) continue;
    ++sure;
    EXPECT_EQ(is_drawn, found.is_drawn) << i % camera.width << "," << i / camera.width;
  }
  EXPECT_GT(sure, 4000u);
  EXPECT_GT(drawn, 500u);
  EXPECT_GT(cut_away, 500u);
}

TEST(AlphaTest, ARayFindsTheSameTexels) {
  expect_rays_agree({});
}
TEST(AlphaTest, ARayFindsTheSameVertexAlpha) {
  test::MaskSceneOptions options;
  options.has_vertex_alpha = true;
  options.factor = 0.9F;
  options.cutoff = 0.17F;
  expect_rays_agree(options);
  options.has_texture = false;
  expect_rays_agree(options);
}

TEST(AlphaTest, CutoffsAtTheEndsDrawAllOrNothing) {
  test::MaskSceneOptions options;
  options.has_texture = false;
  const run::Camera camera = card_camera();
  for (const float cutoff : {1.0F, 1.01F}) {
    options.cutoff = cutoff;
    const Card card = open_cards(options);
    const auto opaque = draw_cut(card.asset, card.cut, camera);
    const auto masked = draw_cut(card.asset, card.cut, camera, load_alpha_masks(card.asset));
    ASSERT_TRUE(opaque && masked);
    if (cutoff == 1.0F) {
      EXPECT_EQ(*masked, *opaque) << "an alpha of 1 reaches a cutoff of 1";
    } else {
      EXPECT_EQ(*masked, make_visibility_buffer(camera.width, camera.height));
    }
  }
}

TEST(AlphaTest, ATransformMovesTheTexels) {
  test::MaskSceneOptions plain, moved;
  moved.transform = R"({"offset":[0.25,-0.5],"rotation":0.3,"scale":[2,-1.5]})";
  const run::Camera camera = card_camera();
  const Card a = open_cards(plain), b = open_cards(moved);
  const auto first = draw_cut(a.asset, a.cut, camera, load_alpha_masks(a.asset));
  const auto second = draw_cut(b.asset, b.cut, camera, load_alpha_masks(b.asset));
  ASSERT_TRUE(first && second);
  EXPECT_NE(*first, *second);
}

}  // namespace
}  // namespace meshlode::draw
