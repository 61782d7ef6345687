// SPDX-License-Identifier: GPL-3.0-or-later
// Which surface pixels show: a plate that is nearer to what lies behind it than the pixels that are allowed is missed
// where it vanishes, however little anything moved.
#include <cmath>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "judge/pictures/cameras.h"
#include "judge/pictures/id_judge.h"
#include "lab/samples/samples.h"
#include "support/mask_scene.h"
#include "support/parallel_camera.h"
#include "support/plate_scene.h"

namespace meshlode::judge {
namespace {

using meshlode::test::built;
using meshlode::test::kPlateBack;
using meshlode::test::kPlateThickness;
using meshlode::test::kRecessDepth;
using meshlode::test::plate_scene;

/// 80 millimetres high in 400 pixels: five pixels a millimetre, straight from the front.
run::Camera front() {
  return meshlode::test::parallel_camera({50.0, 30.0, 0.0}, 100.0, 80.0, 600, 400);
}

/// An asset of one scene against a source.
class AgainstSource {
 public:
  AgainstSource(const scene::Scene& drawn, const scene::Scene& source)
      : asset_(run::Asset::from_vector(built(drawn))),
        surfaces_(source_surfaces(source, false)),
        masks_(draw::load_alpha_masks(*asset_)) {}
  [[nodiscard]] const run::Asset& asset() const { return *asset_; }

  struct Found {
    IdDistance by_pixels;  ///< at first sight
    IdDistance judged;
  };
  /// The cut of `drawn_error`, as one of `pixel_error` would be.
  [[nodiscard]] Found judge(const run::Camera& camera, double drawn_error, double pixel_error) const {
    const std::vector<run::ClusterInstance> cut = run::select_flat(*asset_, camera, drawn_error);
    const auto drawn = draw::draw_cut(*asset_, cut, camera, masks_);
    const IdJudge judge(*asset_, surfaces_, masks_);
    auto truth = judge.draw_source_ids(camera);
    EXPECT_TRUE(drawn && truth);
    const auto ids = IdPainter(*asset_).of_cut(cut, *drawn);
    EXPECT_TRUE(ids);
    const auto astray = find_astray(truth->ids, *ids, AllowedPixels(truth->projection, pixel_error));
    const IdDistance by_pixels = sum_up(truth->ids, *ids, astray);
    const auto judged = judge.judge_cut(*truth, camera, cut, *drawn, pixel_error);
    EXPECT_TRUE(judged);
    return {by_pixels, *judged};
  }

 private:
  Result<run::Asset> asset_;
  std::vector<SourceSurface> surfaces_;
  draw::AlphaMasks masks_;
};

/// Level 0 of an asset of `drawn` against `source`, as a cut of `pixel_error` would be.
IdDistance judge_level0(const scene::Scene& drawn, const scene::Scene& source, const run::Camera& camera,
                        double pixel_error) {
  return AgainstSource(drawn, source).judge(camera, 0.0, pixel_error).judged;
}

constexpr double kPixelsPerMm = 5.0;

TEST(IdJudge, ThePlateInItsRecessIsSeen) {
  const IdDistance found = judge_level0(plate_scene(), plate_scene(), front(), 1.0);
  EXPECT_EQ(found.astray, 0U);
  EXPECT_EQ(found.pixels, 500U * 300U);
}

/// Pushed just below the floor: by 1.25 mm or six pixels, where eight are allowed.
TEST(IdJudge, APlateThatSinksBehindTheFloorIsFound) {
  constexpr double kSunk = kPlateBack + kPlateThickness + kRecessDepth + 0.05;
  static_assert(kSunk * kPixelsPerMm < 8.0);
  const IdDistance found = judge_level0(plate_scene({.plate_moved = {0.0, 0.0, -kSunk}}), plate_scene(), front(), 8.0);
  EXPECT_EQ(found.astray, 290U * 90U) << "58 by 18 mm";
  EXPECT_TRUE(is_beyond_limit(found));
}

TEST(IdJudge, APlateThatMovesByLessThanThePixelErrorIsNot) {
  for (const Vec3d& moved : {Vec3d(0.8, 0.0, 0.0), Vec3d(-0.5, 0.5, 0.0), Vec3d(0.0, 0.0, 0.6)}) {
    EXPECT_EQ(judge_level0(plate_scene({.plate_moved = moved}), plate_scene(), front(), 4.0).astray, 0U);
  }
  const IdDistance found = judge_level0(plate_scene({.plate_moved = {2.0, 0.0, 0.0}}), plate_scene(), front(), 4.0);
  EXPECT_GT(found.astray, 0U) << "by ten pixels, where four are allowed";
  EXPECT_NEAR(found.farthest_px, 2.0 * kPixelsPerMm, 1.0);
}

TEST(IdJudge, APlateThatIsDeletedIsFound) {
  const IdDistance found = judge_level0(plate_scene({.has_plate = false}), plate_scene(), front(), 8.0);
  EXPECT_EQ(found.astray, 290U * 90U);
  EXPECT_TRUE(std::isinf(found.farthest_px));
  EXPECT_EQ(judge_level0(plate_scene(), plate_scene({.has_plate = false}), front(), 8.0).astray, 290U * 90U);
}

TEST(IdJudge, MaterialsThatAreSwappedAreFound) {
  const IdDistance found = judge_level0(plate_scene({.are_materials_swapped = true}), plate_scene(), front(), 8.0);
  EXPECT_GT(found.share(), 0.85) << "all but the picture's edge";
}

/// A mesh of several materials: one of its cards has another's.
TEST(IdJudge, AMaterialWithinAMeshThatIsAnothersIsFound) {
  scene::Scene drawn = meshlode::test::mask_scene({.has_texture = false}), source = drawn;
  drawn.meshes[1].primitives[4].material = MaterialId(1U);
  run::Camera camera = front();
  camera.eye = {0.0, 0.0, 10.0};
  camera.target = {0.0, 0.0, 0.0};
  camera.ortho_height = 10.0;
  EXPECT_EQ(judge_level0(source, source, camera, 8.0).astray, 0U);
  EXPECT_NEAR(static_cast<double>(judge_level0(drawn, source, camera, 8.0).astray), 80.0 * 80.0, 400.0);
}

/// Masks are looked through in the source as they are in the cut, which has the UVs on a grid.
TEST(IdJudge, ASourceIsMaskedAsItsCutIs) {
  run::Camera camera = front();
  camera.eye = {1.0, 2.0, 12.0};
  camera.target = {0.0, 0.0, 0.0};
  camera.is_orthographic = false;
  for (const meshlode::test::MaskSceneOptions& options :
       {meshlode::test::MaskSceneOptions{}, meshlode::test::MaskSceneOptions{.has_vertex_alpha = true},
        meshlode::test::MaskSceneOptions{.cutoff = 0.8F, .transform = R"({"scale":[0.7,1.3],"rotation":0.4})"}}) {
    const scene::Scene scene = meshlode::test::mask_scene(options);
    EXPECT_LE(judge_level0(scene, scene, camera, 1.0).astray, 2U) << "where alpha is that of the cutoff, and rounded";

    // Opaque cards hide the wall that shows through them.
    scene::Scene opaque = scene;
    for (scene::SceneMaterial& material : opaque.materials) material.alpha_mode = scene::AlphaMode::kOpaque;
    EXPECT_TRUE(is_beyond_limit(judge_level0(scene, opaque, camera, 1.0)));
  }
}

/// What a surface shows from behind, where it is not drawn, hangs on how it faces: that is no fault of a cut.
TEST(IdJudge, AnOpenSurfaceIsNotJudgedFromBehind) {
  const scene::Scene terrain = lab::as_scene(lab::as_mesh(lab::make_terrain(48, 48)));
  const AgainstSource same(terrain, terrain);
  const Box3d box = world_box(same.asset());
  run::Camera camera;
  camera.target = 0.5 * (box.low + box.high);
  camera.near_distance = 1e-3 * (box.high.x - box.low.x);
  std::uint64_t seen = 0, without = 0;
  for (const double below : {0.1, 0.2, 0.4}) {
    camera.eye = camera.target + Vec3d(1.3, -below, 0.3) * (box.high.x - box.low.x);
    const AgainstSource::Found found = same.judge(camera, 4.0, 4.0);
    without += found.by_pixels.astray;
    seen += found.judged.pixels;
    EXPECT_EQ(found.judged.astray, 0U);
  }
  EXPECT_GT(seen, 0U) << "slopes that face the camera";
  EXPECT_GT(without, 0U);
}

/// Five turns of a ribbon of a twentieth of a pixel: dots in the picture of the source, and others in that of a cut.
TEST(IdJudge, WhatIsNarrowerThanAPixelIsLookedAtCloser) {
  constexpr std::uint32_t kSteps = 800;
  scene::Primitive coil;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const double turn = 10.0 * 3.14159265358979323846 * i / kSteps;
    for (const double radius : {1.0, 1.0005}) {
      coil.positions.emplace_back(radius * std::cos(turn), 2.0 * i / kSteps, radius * std::sin(turn));
    }
    if (i > 0) {
      const std::uint32_t v = 2 * i;
      coil.indices.insert(coil.indices.end(), {v - 2, v - 1, v, v, v - 1, v + 1});
    }
  }
  scene::Scene scene = lab::as_scene(lab::as_mesh(coil));
  scene.materials.resize(1);
  scene.materials[0].double_sided = true;
  const AgainstSource same(scene, scene);
  run::Camera camera;
  camera.width = camera.height = 400;
  camera.target = {0.0, 1.0, 0.0};
  camera.near_distance = 1.0;
  int beyond = 0;
  for (const double height : {1.0, 1.1, 1.2}) {
    camera.eye = {5.0, height, 0.0};
    const AgainstSource::Found found = same.judge(camera, 2.0, 2.0);
    beyond += is_beyond_limit(found.by_pixels);
    EXPECT_FALSE(is_beyond_limit(found.judged)) << found.judged.astray << " of " << found.judged.pixels;
  }
  EXPECT_GT(beyond, 0) << "by single pixels";
}

/// A plate whose front lies in the floor of the recess: nothing says which of the two is seen. A tenth of a millimetre
/// does.
TEST(IdJudge, SurfacesInOnePlaceAreNotJudged) {
  constexpr double kOntoFloor = -kRecessDepth - (kPlateBack + kPlateThickness);
  const scene::Scene drawn = plate_scene({.plate_moved = {0.0, 0.0, kOntoFloor + 0.1}});
  for (const double below : {0.0, 0.1}) {
    const scene::Scene source = plate_scene({.plate_moved = {0.0, 0.0, kOntoFloor - below}});
    EXPECT_EQ(judge_level0(drawn, source, front(), 4.0).astray > 0, below > 0.0);
  }
}

/// A triangle without area goes, and the others keep the sides of their materials.
TEST(IdJudge, ATriangleWithoutAreaTakesNoSidesAway) {
  scene::Scene scene = plate_scene();
  scene.materials[1].double_sided = true;
  scene::Primitive& plate = scene.meshes[1].primitives[0];
  plate.indices.insert(plate.indices.begin(), {0, 0, 0});
  const std::vector<SourceSurface> surfaces = source_surfaces(scene, false);
  EXPECT_EQ(surfaces[1].double_sided, std::vector<std::uint8_t>(12, 1));
  EXPECT_EQ(surfaces[1].material, std::vector<std::uint32_t>(12, 1));
  EXPECT_FALSE(surfaces[1].tree.has_value());
}

TEST(IdJudge, TotalsNameTheWorstPicture) {
  IdTotals totals;
  EXPECT_EQ(describe(totals), "every pixel shows the surface that the source shows there");
  totals.add("a", {10000, 0, 0.0});
  totals.add("b", {10000, 300, 12.0});
  totals.add("c", {1000, 63, 20.0});
  EXPECT_EQ(totals.beyond_limit, 1U) << "63 pixels are no patch";
  EXPECT_EQ(describe(totals),
            "1.729% of pixels show another surface than the source, none farther than 20.0 px; at worst 6.300% (c)");
}

}  // namespace
}  // namespace meshlode::judge
