// SPDX-License-Identifier: GPL-3.0-or-later
// I6 on open surfaces nobody chose: whatever their borders do, what is built has the source's border by the judge's
// rules (L507, L508, V202).
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "builder/builder.h"
#include "judge/validate/validate.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"
#include "support/open_surface.h"

namespace meshlode::builder {
namespace {

using test::Random;

template <class Report>
void expect_nothing(const Report& report, const std::string& scene) {
  EXPECT_EQ(report.finding_count, 0U) << scene;
  for (std::size_t i = 0; i < std::min<std::size_t>(report.findings.size(), 3); ++i) {
    ADD_FAILURE() << scene << ": " << report.findings[i].id << ' ' << report.findings[i].where << ": "
                  << report.findings[i].detail;
  }
}

/// Builds by the quadric's own estimate, which needs no sampling: what is drawn is the same.
void expect_sound(scene::Primitive shape, const std::string& name) {
  const scene::Scene scene = lab::as_scene(lab::as_mesh(std::move(shape)));
  PipelineOptions options;
  options.error_tier = format::ErrorTier::kQem;
  PipelineReport report;
  const auto bytes = build_lode(scene, options, {}, report);
  ASSERT_TRUE(bytes.ok()) << name << ": " << bytes.error().message();
  expect_nothing(judge::validate_asset(*bytes), name);
  const auto asset = run::Asset::from_bytes(*bytes);
  ASSERT_TRUE(asset.ok()) << name;
  judge::VerifyOptions verify_options;
  verify_options.uniform_cuts = 40;
  verify_options.cameras = 5;
  expect_nothing(judge::verify_asset(*asset, scene, verify_options), name);
}

/// Large loose quads: they make the mesh large and its grid coarse, beside whatever is small in it.
void add_quads(std::uint32_t count, double extent, Random& random, scene::Primitive& shape) {
  const auto any = [&](double size) { return size * random.signed_unit(); };
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    const Vec3d corner(any(extent), any(0.2 * extent), any(extent));
    const double side = extent * (0.5 + 0.3 * random.signed_unit());
    for (const Vec3d& p : {Vec3d(0, 0, 0), Vec3d(side, 0, 0), Vec3d(0, 0, side), Vec3d(side, 0, side)}) {
      shape.positions.push_back(corner + p + Vec3d(0.0, any(0.2 * extent), any(0.1 * extent)));
    }
    for (const std::uint32_t v : {0U, 2U, 1U, 1U, 2U, 3U}) shape.indices.push_back(first + v);
  }
}

TEST(OpenBorders, ADensePatchBesideLargeQuadsKeepsItsBorder) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    test::OpenSurfaceOptions options;
    options.side = 36;
    options.spacing = 1000;
    options.noise = 600;
    scene::Primitive shape = test::as_primitive(test::make_open_surface(options, random), 5e-7);
    add_quads(40, 10.0, random, shape);
    expect_sound(std::move(shape), "seed " + std::to_string(seed));
  }
}

TEST(OpenBorders, SheetsOfHolesThatTouchKeepTheirBorders) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    test::OpenSurfaceOptions options = test::random_surface_options(random, 40);
    options.side = std::max(options.side, 20U);
    expect_sound(test::as_primitive(test::make_open_surface(options, random), 1e-3), "seed " + std::to_string(seed));
  }
}

}  // namespace
}  // namespace meshlode::builder
