// SPDX-License-Identifier: GPL-3.0-or-later
// Level cuts and camera cuts are cuts: closed where the source is, and as fine as every instance asks for.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "app/export/choose_cuts.h"
#include "build_scene.h"
#include "lab/samples/samples.h"

namespace meshlode::app {
namespace {

bool is_closed(const run::Asset& asset, const std::vector<ClusterId>& cut) {
  std::map<std::pair<test::Point, test::Point>, int> edges;
  for (const auto& t : test::expected_triangles(asset, MeshId(0U), cut)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const test::Point& a = t.corners[k];
      const test::Point& b = t.corners[(k + 1) % 3];
      if (a < b)
        ++edges[{a, b}];
      else if (b < a)
        --edges[{b, a}];
    }
  }
  return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; });
}

TEST(ChooseCuts, LevelsGoFromTheFinestCutToTheRoots) {
  const auto bytes = test::build_bytes(lab::as_scene(lab::as_mesh(lab::make_sphere(24))));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const std::uint32_t levels = asset->meshes()[0].level_count;
  ASSERT_GT(levels, 2U);
  EXPECT_EQ(choose_level_cut(*asset, MeshId(0U), 0).clusters, run::select_uniform(*asset, MeshId(0U), -1.0).clusters);
  EXPECT_EQ(choose_level_cut(*asset, MeshId(0U), levels).clusters,
            run::select_uniform(*asset, MeshId(0U), 1e30).clusters);
  double last = -1.0;
  for (std::uint32_t level = 0; level <= levels; ++level) {
    const run::UniformCut cut = choose_level_cut(*asset, MeshId(0U), level);
    EXPECT_FALSE(cut.clusters.empty());
    EXPECT_TRUE(is_closed(*asset, cut.clusters)) << "level " << level;
    EXPECT_GE(cut.stored_error, last);
    last = cut.stored_error;
  }
}

TEST(ChooseCuts, OneInstanceGetsExactlyWhatItsCameraDraws) {
  const auto bytes = test::build_bytes(lab::as_scene(lab::as_mesh(lab::make_sphere(24))));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  for (const double distance : {1.01, 1.5, 4.0, 50.0, 1e5}) {
    run::Camera camera;
    camera.eye = {distance, 0.2, 0.1};
    const auto drawn = run::select_flat(*asset, camera, 1.0);
    std::vector<ClusterId> clusters;
    for (const run::ClusterInstance& d : drawn) clusters.push_back(d.cluster);
    EXPECT_EQ(choose_camera_cuts(*asset, camera, 1.0).at(0).clusters, clusters) << distance;
  }
}

TEST(ChooseCuts, TwoInstancesShareACutThatIsFineEnoughForBoth) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_sphere(24)));
  scene::SceneInstance left = scene.instances.at(0);
  left.transform[3] = {-30.0, 0.0, 0.0, 1.0};
  scene.instances.push_back(left);
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto leaf_errors_hold = [&](const std::vector<ClusterId>& cut, const std::vector<run::ClusterInstance>& drawn,
                                    std::uint32_t instance) {
    // What an instance draws itself is nowhere finer than the shared cut: each of its clusters that is not in the cut
    // was replaced by finer ones, so the shared cut has at least as many triangles.
    std::uint64_t own = 0, shared = 0;
    for (const run::ClusterInstance& d : drawn) {
      if (d.instance.value == instance) own += asset->clusters()[d.cluster.value].triangle_count();
    }
    for (const ClusterId c : cut) shared += asset->clusters()[c.value].triangle_count();
    return shared >= own;
  };
  for (const double x : {1.5, -15.0, -28.0, 40.0}) {
    run::Camera camera;
    camera.eye = {x, 1.2, 0.0};
    const auto drawn = run::select_flat(*asset, camera, 1.0);
    const run::UniformCut cut = choose_camera_cuts(*asset, camera, 1.0).at(0);
    EXPECT_TRUE(is_closed(*asset, cut.clusters)) << x;
    EXPECT_TRUE(leaf_errors_hold(cut.clusters, drawn, 0)) << x;
    EXPECT_TRUE(leaf_errors_hold(cut.clusters, drawn, 1)) << x;
  }
}

TEST(ChooseCuts, AMeshThatNobodyDrawsHasNoCameraCut) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_sphere(4)));
  scene.instances.clear();
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  EXPECT_TRUE(choose_camera_cuts(*asset, run::Camera{}, 1.0).at(0).clusters.empty());
}

}  // namespace
}  // namespace meshlode::app
