// SPDX-License-Identifier: GPL-3.0-or-later
// What page size, page order and root size change of an asset, and what they leave.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/parallel.h"
#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "scene/import/gltf_builder.h"

namespace meshlode::testing {
namespace {

using builder::PipelineOptions;

scene::Scene import_sample(const char* name) {
  const std::vector<std::uint8_t> glb = lab::make_sample_file(name).bytes;
  const TempFolder folder;
  auto scene = scene::import_scene(folder.write("scene.glb", std::string(glb.begin(), glb.end())), {});
  EXPECT_TRUE(scene) << describe(scene);
  return scene ? std::move(*scene) : scene::Scene{};
}

/// With estimated errors: quick, and no page knows the difference.
std::vector<std::uint8_t> build_pages(const scene::Scene& scene, const PipelineOptions& options = {}) {
  builder::PipelineReport report;
  PipelineOptions quick = options;
  quick.preset = Preset::kFast;
  quick.error_tier = format::ErrorTier::kQem;
  auto bytes = builder::build_lode(scene, quick, {}, report);
  EXPECT_TRUE(bytes) << (bytes ? "" : bytes.error().message());
  return bytes ? std::move(*bytes) : std::vector<std::uint8_t>{};
}

PipelineOptions covisible(std::uint32_t page_kib, std::uint32_t root_bytes) {
  PipelineOptions options;
  options.page_kib = page_kib;
  options.page_order = PageOrder::kCovisible;
  options.root_bytes = root_bytes;
  return options;
}

Hash128 hash_of(const run::DecodedCluster& cluster) {
  Hasher hasher;
  const auto add = [&](const void* data, std::size_t bytes) {
    hasher.update({static_cast<const std::uint8_t*>(data), bytes});
  };
  add(cluster.channels.data(), cluster.channels.size() * sizeof cluster.channels[0]);
  add(cluster.triangles.data(), cluster.triangles.size() * sizeof cluster.triangles[0]);
  add(cluster.triangle_material.data(), cluster.triangle_material.size() * sizeof cluster.triangle_material[0]);
  return hasher.digest();
}

/// What each cluster holds, with its error of both sides: the asset but for the order of its groups.
std::vector<std::string> contents(const run::Asset& asset) {
  const auto clusters = run::decode_all(asset);
  EXPECT_TRUE(clusters);
  std::vector<std::string> out;
  for (std::size_t c = 0; clusters && c < clusters->size(); ++c) {
    const format::ClusterRecord& record = asset.clusters()[c];
    const float own = record.own_group == format::kNone ? -1.0F : asset.groups()[record.own_group].error;
    out.push_back(to_hex(hash_of((*clusters)[c])) + " " + std::to_string(record.level) + " " + std::to_string(own) +
                  " " + std::to_string(asset.groups()[record.coarser_group].error));
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(PageLayout, HoldsTheSameClustersInPagesOfTheSizeAskedFor) {
  for (const char* name : {"rock.glb", "city.glb"}) {
    const scene::Scene scene = import_sample(name);
    const auto usual_bytes = build_pages(scene), bytes = build_pages(scene, covisible(16, 40000));
    const auto usual = run::Asset::from_bytes(usual_bytes), asset = run::Asset::from_bytes(bytes);
    ASSERT_TRUE(usual && asset) << name;  // opening checks that pages depend on earlier ones alone
    EXPECT_EQ(contents(*usual), contents(*asset)) << name;
    std::size_t large = 0;
    for (std::size_t p = 0; p < asset->pages().size(); ++p) {
      const format::PageRecord& page = asset->pages()[p];
      const std::uint32_t mesh = asset->groups()[page.first_group].mesh;
      const bool is_first = page.first_group == asset->meshes()[mesh].first_group;
      if (is_first) large += page.bytes > 16384 ? 1 : 0;
      if (page.group_count == 1) continue;
      EXPECT_LE(page.bytes, is_first ? 40000U : 16384U) << name << ", page " << p;
    }
    if (std::string(name) == "rock.glb") {
      EXPECT_EQ(large, 1U);
      EXPECT_GT(asset->pages().size(), usual->pages().size());
    }
  }
}

TEST(PageLayout, LevelsNeverMixAndTerminalGroupsStayFirst) {
  const auto bytes = build_pages(import_sample("rock.glb"), covisible(16, 0));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset);
  for (std::size_t g = 1; g < asset->groups().size(); ++g) {
    const format::GroupRecord &before = asset->groups()[g - 1], &group = asset->groups()[g];
    if (group.mesh != before.mesh) continue;
    ASSERT_GE(before.level, group.level) << g;
    if (before.level == group.level) {
      ASSERT_GE(before.flags & format::kGroupTerminal, group.flags & format::kGroupTerminal) << g;
    }
  }
}

TEST(PageLayout, ThreadsChangeNoByteAndTheOrderIsAnother) {
  const scene::Scene scene = import_sample("rock.glb");
  PipelineOptions small;
  small.page_kib = 16;
  const auto level = build_pages(scene, small), order = build_pages(scene, covisible(16, 0));
  EXPECT_NE(level, order);
  EXPECT_EQ(with_threads_at_most(1, [&] { return build_pages(scene, covisible(16, 0)); }), order);
}

Vec3d center_of(const format::GroupRecord& group) {
  return {group.center[0], group.center[1], group.center[2]};
}

/// Mean bytes of pages that a view from outside needs, over cameras that the order was not made for.
double mean_needed_bytes(const run::Asset& asset) {
  const format::MeshRecord& mesh = asset.meshes()[0];
  double sum = 0.0;
  constexpr int kViews = 200;
  for (int v = 0; v < kViews; ++v) {
    // A spiral around the mesh, looking at its middle with an opening of 20 degrees: a stretch of the surface.
    const double height = 1.0 - 2.0 * (v + 0.5) / kViews, out = std::sqrt(1.0 - height * height);
    const Vec3d axis(out * std::cos(2.4 * v), out * std::sin(2.4 * v), height);
    const Vec3d eye = center_of(asset.groups()[0]) + axis * (0.8 * mesh.diagonal);
    std::vector<bool> is_needed(asset.pages().size());
    for (const format::GroupRecord& group : asset.groups()) {
      const Vec3d to = center_of(group) - eye;
      const double distance = glm::length(to), radius = group.radius;
      const bool is_seen = glm::dot(to, -axis) > 0.98 * distance - radius;
      const bool fails = double{group.error} * 2000.0 > std::max(distance - radius, 0.01 * mesh.diagonal);
      if (is_seen && fails) is_needed[group.page] = true;
    }
    for (std::size_t p = 0; p < is_needed.size(); ++p) sum += is_needed[p] ? asset.pages()[p].bytes : 0.0;
  }
  return sum / kViews;
}

TEST(PageLayout, SmallPagesLoadLess) {
  scene::Scene scene = import_sample("rock.glb");
  scene.meshes.at(0).primitives.assign(1, lab::make_sphere(120));
  scene.meshes[0].primitives[0].material = MaterialId(0U);
  PipelineOptions small;
  small.page_kib = 32;
  const auto usual = build_pages(scene), level = build_pages(scene, small),
             order = build_pages(scene, covisible(32, 0));
  const auto a = run::Asset::from_bytes(usual), b = run::Asset::from_bytes(level), c = run::Asset::from_bytes(order);
  ASSERT_TRUE(a && b && c);
  const double of_usual = mean_needed_bytes(*a), of_level = mean_needed_bytes(*b), of_order = mean_needed_bytes(*c);
  RecordProperty("level", std::to_string(of_level / of_usual));
  RecordProperty("covisible", std::to_string(of_order / of_usual));
  EXPECT_LT(of_level, 0.7 * of_usual);
  EXPECT_LT(of_order, 0.7 * of_usual);
}

}  // namespace
}  // namespace meshlode::testing
