// SPDX-License-Identifier: GPL-3.0-or-later
// Frames that a device draws from a pool of pages are the CPU's with the same pages.
#include <string>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "draw/gpu/gpu_support.h"
#include "judge/gpu/verify_gpu.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"

namespace meshlode::judge {
namespace {

using StreamOnGpu = draw::test::GpuTest;

TEST_F(StreamOnGpu, EachFrameFromAPoolIsTheCpus) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_rock(60)));
  scene.meshes.push_back(lab::as_mesh(lab::make_terrain(60, 60), "terrain"));
  scene.instances.push_back(scene.instances.front());
  scene.instances.back().mesh = MeshId(1U);
  builder::PipelineOptions options;
  options.page_kib = 16;
  builder::PipelineReport built;
  const auto bytes = builder::build_lode(scene, options, {}, built);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  const Result<run::Asset> asset = run::Asset::from_vector(*bytes);
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  StreamFrameOptions checks;
  checks.frames = 80;
  checks.size = {64, 48};
  checks.pixel_error = 0.25;
  checks.pool_share = 0.1;
  const auto report = verify_streaming_on_gpu(*asset, checks);
  ASSERT_TRUE(report.ok()) << report.error().message();
  EXPECT_EQ(report->check.items, 80U);
  EXPECT_EQ(report->check.failures, 0U) << report->check.first;
  EXPECT_LT(report->slots, report->pages);
  EXPECT_GT(report->loads, report->slots) << "pages have to be loaded again";
  EXPECT_GT(report->spared, 0U) << "nothing was culled";
  EXPECT_GT(report->incomplete, 0U) << "no frame lacked a page, and nothing was tried";
  checks.frames = 6;
  checks.pixel_error = 0.0;  // level 0: which pages are asked for, and not by how much
  const auto exact = verify_streaming_on_gpu(*asset, checks);
  ASSERT_TRUE(exact.ok()) << exact.error().message();
  EXPECT_EQ(exact->check.failures, 0U) << exact->check.first;
  for (scene::SceneInstance& instance : scene.instances) instance.transform = Mat4d(0.0);
  const auto flat = builder::build_lode(scene, options, {}, built);
  ASSERT_TRUE(flat.ok()) << flat.error().message();
  const Result<run::Asset> unseen = run::Asset::from_vector(*flat);
  ASSERT_TRUE(unseen.ok()) << unseen.error().message();
  const auto nothing = verify_streaming_on_gpu(*unseen, checks);
  ASSERT_TRUE(nothing.ok()) << nothing.error().message();
  EXPECT_TRUE(nothing->check.is_skipped);
}

}  // namespace
}  // namespace meshlode::judge
