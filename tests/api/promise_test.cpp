// SPDX-License-Identifier: GPL-3.0-or-later
// A promise is an argument of a selection, through the public headers alone: each is selected by its own tables, from
// any number of threads at once, and no frame takes memory for it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/meshlode.h>
#include <meshlode/runtime.h>

#include "arrays.h"
#include "run/read/asset.h"
#include "run/select/allocation_count.h"
#include "run/select/select.h"

namespace meshlode {
namespace {

constexpr std::array kPromises{format::Promise::kPosition, format::Promise::kTexels, format::Promise::kAppearance};

/// A ball whose normals ask for more triangles than its positions. Nothing of an API's build samples a texture, so that
/// its errors for texels are those of positions.
const std::vector<std::uint8_t>& promised_ball() {
  static const std::vector<std::uint8_t> bytes = [] {
    BuildOptions options;
    options.promise = format::Promise::kAppearance;
    auto built = test::build_one(test::Arrays(lab::with_smooth_normals(lab::make_sphere(48))).primitive(), options);
    EXPECT_TRUE(built.ok()) << built.error().message();
    return built ? std::move(*built) : std::vector<std::uint8_t>{};
  }();
  return bytes;
}

View view_at(int step, format::Promise promise) {
  View view;
  view.eye = {0.0, 0.1 * step, 1.5 * std::pow(1.5, step)};
  view.promise = promise;
  return view;
}

/// Pairs of a selection, as they lie in memory.
using Pairs = std::vector<DrawItem>;
bool is_same(const Pairs& a, const Pairs& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(DrawItem)) == 0);
}

/// By the rule itself over the tables of the promise, without the API's selection.
Pairs cut_by_the_rule(const run::Asset& asset, const View& view) {
  run::Camera camera;
  camera.eye = {view.eye[0], view.eye[1], view.eye[2]};
  camera.target = camera.eye - Vec3d(0.0, 0.0, 1.0);
  camera.fovy = view.fovy_radians;
  camera.near_distance = view.near_distance;
  camera.height = camera.width = view.height_px;
  Pairs out;
  for (const run::ClusterInstance& one : run::select_flat(asset, camera, 1.0)) {
    out.push_back({one.instance.value, one.cluster.value});
  }
  return out;
}

constexpr int kSteps = 12;

TEST(ApiPromise, EachIsSelectedByItsOwnTables) {
  const auto asset = AssetFile::view(promised_ball());
  const auto inner = run::Asset::from_bytes(promised_ball());
  ASSERT_TRUE(asset.ok() && inner.ok());
  std::array<std::size_t, kPromises.size()> drawn{};
  for (std::size_t p = 0; p < kPromises.size(); ++p) {
    const auto promised = inner->with_promise(kPromises[p]);
    const auto tables = asset->tables_of(kPromises[p]);
    ASSERT_TRUE(promised.ok() && tables.ok());
    ASSERT_EQ(tables->groups.size(), asset->groups().size());
    for (std::size_t g = 0; g < tables->groups.size(); ++g) {
      const format::PromiseGroupRecord& stored = asset->promise_errors()[g];
      const std::array<float, 3> errors{asset->groups()[g].error, stored.texel_error, stored.appearance_error};
      EXPECT_EQ(tables->groups[g].error, errors[p]);
    }
    for (int step = 0; step < kSteps; ++step) {
      const View view = view_at(step, kPromises[p]);
      const auto cut = asset->select_view(view, 1.0);
      ASSERT_TRUE(cut.ok());
      EXPECT_TRUE(is_same(*cut, cut_by_the_rule(*promised, view))) << p << ' ' << step;
      drawn[p] += cut->size();
    }
    EXPECT_EQ(asset->select_uniform(0, 0.01, kPromises[p])->clusters.size(),
              run::select_uniform(*promised, MeshId(0U), 0.01).clusters.size());
    EXPECT_EQ(asset->streaming_order(kPromises[p])->size(), asset->pages().size());
  }
  EXPECT_EQ(drawn[0], drawn[1]);
  EXPECT_LT(drawn[1], drawn[2]);
}

TEST(ApiPromise, CSelectsWhatCPlusPlusSelects) {
  const auto expected = AssetFile::view(promised_ball());
  meshlode_asset* asset = nullptr;
  ASSERT_EQ(meshlode_open_buffer(promised_ball().data(), promised_ball().size(), &asset, nullptr), MESHLODE_OK);
  std::vector<meshlode_draw_item> items(expected->clusters().size());
  for (const format::Promise promise : kPromises) {
    const auto number = static_cast<std::uint32_t>(promise);
    meshlode_promise_tables tables{};
    ASSERT_EQ(meshlode_tables_of(asset, number, &tables, nullptr), MESHLODE_OK);
    const PromiseTables same = *expected->tables_of(promise);
    EXPECT_EQ(std::memcmp(tables.meshes, same.meshes.data(), same.meshes.size_bytes()), 0);
    EXPECT_EQ(std::memcmp(tables.groups, same.groups.data(), same.groups.size_bytes()), 0);
    EXPECT_EQ(std::memcmp(tables.nodes, same.nodes.data(), same.nodes.size_bytes()), 0);
    for (int step = 0; step < kSteps; ++step) {
      const View view = view_at(step, promise);
      const meshlode_view c_view{{view.eye[0], view.eye[1], view.eye[2]},
                                 0,
                                 view.fovy_radians,
                                 view.ortho_height,
                                 view.near_distance,
                                 720,
                                 number};
      std::size_t count = 0;
      ASSERT_EQ(meshlode_select_view(asset, &c_view, 1.0, items.data(), items.size(), &count, nullptr), MESHLODE_OK);
      const auto cut = expected->select_view(view, 1.0);
      ASSERT_EQ(count, cut->size());
      EXPECT_EQ(std::memcmp(items.data(), cut->data(), count * sizeof(DrawItem)), 0);
    }
    std::vector<std::uint32_t> clusters(expected->clusters().size());
    std::size_t count = 0;
    double stored_error = 0.0;
    ASSERT_EQ(meshlode_select_uniform(asset, 0, number, 0.01, clusters.data(), clusters.size(), &count, &stored_error,
                                      nullptr),
              MESHLODE_OK);
    clusters.resize(count);
    const auto uniform = expected->select_uniform(0, 0.01, promise);
    EXPECT_EQ(clusters, uniform->clusters);
    EXPECT_EQ(stored_error, uniform->stored_error);
    std::vector<std::uint32_t> order(expected->pages().size());
    ASSERT_EQ(meshlode_streaming_order(asset, number, order.data(), nullptr), MESHLODE_OK);
    EXPECT_EQ(order, *expected->streaming_order(promise));
  }
  meshlode_close(asset);
}

/// Each thread goes through all promises, so that at any time several are in use.
TEST(ApiPromise, ThreadsSelectByDifferentOnesOfOneAsset) {
  const auto asset = AssetFile::view(promised_ball());
  ASSERT_TRUE(asset.ok());
  std::array<std::array<Pairs, kSteps>, kPromises.size()> expected;
  for (std::size_t p = 0; p < kPromises.size(); ++p) {
    for (int step = 0; step < kSteps; ++step) {
      expected[p][static_cast<std::size_t>(step)] = *asset->select_view(view_at(step, kPromises[p]), 1.0);
    }
  }
  const std::vector<std::uint32_t> resident((asset->pages().size() + 31) / 32, 0xFFFFFFFFU);
  std::array<int, 6> differing{};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < differing.size(); ++t) {
    threads.emplace_back([&, t] {
      ResidentSelector selector = asset->resident_selector();
      Pairs items;
      for (std::size_t n = 0; n < 40 * kSteps; ++n) {
        const std::size_t p = (n + t) % kPromises.size(), step = (n * (t + 1)) % kSteps;
        const View view = view_at(static_cast<int>(step), kPromises[p]);
        const auto cut = asset->select_view(view, 1.0);
        const bool is_selected = selector.select(view, 1.0, resident, items).ok();
        const bool is_right =
            cut.ok() && is_selected && is_same(*cut, expected[p][step]) && is_same(items, expected[p][step]);
        differing[t] += is_right ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : differing) EXPECT_EQ(count, 0);
}

TEST(ApiPromise, NoFrameTakesMemory) {
  meshlode_asset* asset = nullptr;
  ASSERT_EQ(meshlode_open_buffer(promised_ball().data(), promised_ball().size(), &asset, nullptr), MESHLODE_OK);
  std::uint32_t clusters = 0, pages = 0;
  (void)meshlode_clusters(asset, &clusters);
  (void)meshlode_pages(asset, &pages);
  std::vector<meshlode_draw_item> items(clusters);
  const std::vector<std::uint32_t> resident((pages + 31) / 32, 0xFFFFFFFFU);
  meshlode_selector* selector = nullptr;
  ASSERT_EQ(meshlode_create_selector(asset, &selector, nullptr), MESHLODE_OK);
  const std::uint64_t before = test::allocation_count();
  std::size_t drawn = 0;
  for (int step = 0; step < kSteps; ++step) {
    for (std::uint32_t promise = 0; promise < kPromises.size(); ++promise) {
      const meshlode_view view = {{0.0, 0.0, 1.5 + step}, 0, 0.8, 1.0, 0.01, 720, promise};
      std::size_t count = 0;
      (void)meshlode_select_resident(selector, &view, nullptr, 1.0, resident.data(), items.data(), items.size(), &count,
                                     nullptr);
      drawn += count;
    }
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(drawn, 0U);
  std::vector<int> counted(1);
  EXPECT_GT(test::allocation_count(), before);  // the count counts
  meshlode_destroy_selector(selector);
  meshlode_close(asset);
}

TEST(ApiPromise, WhatWasNotBuiltIsRefused) {
  const auto bytes = test::build_one(test::Arrays(lab::make_sphere(12)).primitive());
  ASSERT_TRUE(bytes.ok());
  const auto asset = AssetFile::view(*bytes);
  ResidentSelector selector = asset->resident_selector();
  Pairs items;
  const auto refused = [](const auto& result, ErrorCode code) { return !result && result.error().code == code; };
  for (const auto promise : {format::Promise::kTexels, format::Promise::kAppearance, static_cast<format::Promise>(7)}) {
    const ErrorCode code = promise > format::Promise::kAppearance ? ErrorCode::kUsage : ErrorCode::kUnsupported;
    EXPECT_TRUE(refused(asset->tables_of(promise), code));
    EXPECT_TRUE(refused(asset->select_view(view_at(0, promise), 1.0), code));
    EXPECT_TRUE(refused(asset->select_uniform(0, 0.0, promise), code));
    EXPECT_TRUE(refused(asset->streaming_order(promise), code));
    EXPECT_TRUE(refused(selector.select(view_at(0, promise), 1.0, {}, items), code));
  }
}

}  // namespace
}  // namespace meshlode
