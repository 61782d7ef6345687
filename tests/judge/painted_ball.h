// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene with something painted on it, and assets of it that promise that.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "support/png_header.h"

namespace meshlode::test {

/// A smooth ball that shows a picture of texels that are twice as wide as high, cast on it from the front.
inline scene::Scene painted_scene() {
  scene::Primitive ball = lab::with_smooth_normals(lab::make_sphere(16));
  for (const Vec3d& p : ball.positions) ball.uvs[0].emplace_back(Vec2f(Vec2d(0.5 + 0.5 * p.x, 0.5 + 0.5 * p.y)));
  scene::Scene scene = lab::as_scene(lab::as_mesh(std::move(ball)));
  scene::SceneBlob& blob = scene.blobs.emplace_back();
  blob.name = "picture";
  blob.bytes = png_of(256, 512);
  scene.materials[0].uv_sets_used = 1;
  scene.materials[0].textures.emplace_back().blob = 0;
  return scene;
}

struct Built {
  scene::Scene scene;
  std::vector<std::uint8_t> bytes;
};

inline Built build_promised(scene::Scene scene, format::Promise promise,
                            format::ErrorTier tier = format::ErrorTier::kMeasured) {
  Built built{std::move(scene), {}};
  builder::PipelineOptions options;
  options.promise = promise;
  options.error_tier = tier;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(built.scene, options, {}, report);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message();
  built.bytes = std::move(*bytes);
  return built;
}

}  // namespace meshlode::test
