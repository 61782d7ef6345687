// SPDX-License-Identifier: GPL-3.0-or-later
// Layouts that are tried are those that a build makes: the same groups in pages of the same sizes.
#include "app/stream/page_layout.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"

namespace meshlode::app {
namespace {

run::Asset build(const scene::Scene& scene, const PageLayout& layout) {
  builder::PipelineOptions options;
  options.codec = format::Codec::kNone;
  options.error_tier = format::ErrorTier::kQem;
  options.page_kib = layout.page_kib;
  options.page_order = layout.order;
  options.root_bytes = layout.root_bytes;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes) << (bytes ? "" : bytes.error().message());
  return std::move(*run::Asset::from_vector(std::move(*bytes)));
}

StreamScene placed_once(const run::Asset& asset) {
  const std::string name = "asset";
  const Placement placement;
  auto scene = make_stream_scene({&asset, 1}, {&name, 1}, {&placement, 1});
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().message());
  return std::move(*scene);
}

/// Per page, ascending: its bytes, and the errors and spheres of its groups.
using Group = std::tuple<std::uint32_t, float, float, float, float, float, std::uint16_t>;
std::vector<std::tuple<std::uint32_t, std::uint32_t, std::vector<Group>>> pages_of(const StreamScene& scene) {
  std::map<std::uint32_t, std::vector<Group>> groups;
  for (const format::GroupRecord& g : scene.groups) {
    groups[g.page].push_back({g.mesh, g.error, g.center[0], g.center[1], g.center[2], g.radius, g.cluster_count});
  }
  std::vector<std::tuple<std::uint32_t, std::uint32_t, std::vector<Group>>> pages;
  for (auto& [page, members] : groups) {
    std::sort(members.begin(), members.end());
    pages.emplace_back(page, scene.pages[page].bytes, std::move(members));
  }
  return pages;
}

TEST(PageLayout, IsThatOfABuild) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_rock(36)));
  scene.meshes.push_back(lab::as_mesh(lab::make_sphere(20)));
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].mesh = MeshId(1U);
  const StreamScene usual = placed_once(build(scene, {}));
  for (const PageLayout& layout :
       {PageLayout{}, PageLayout{16, PageOrder::kLevel, 0}, PageLayout{32, PageOrder::kCovisible, 0},
        PageLayout{16, PageOrder::kCovisible, 65536}}) {
    const StreamScene tried = with_layout(usual, layout), built = placed_once(build(scene, layout));
    EXPECT_EQ(pages_of(tried), pages_of(built)) << layout.text();
    EXPECT_EQ(tried.pages.size(), built.pages.size()) << layout.text();
    EXPECT_EQ(tried.page_bytes(), built.page_bytes()) << layout.text();
    EXPECT_EQ(tried.stored_bytes(), built.stored_bytes()) << layout.text() << ": nothing is compressed";
  }
  EXPECT_GT(with_layout(usual, {16, PageOrder::kLevel, 0}).pages.size(), usual.pages.size() + 2);
}

TEST(PageLayout, ReadsWhatItWrites) {
  const auto layouts = parse_layouts("32,64/covisible,16/level/131072", "--layout");
  ASSERT_TRUE(layouts);
  ASSERT_EQ(layouts->size(), 3U);
  EXPECT_EQ((*layouts)[0].text(), "32/level");
  EXPECT_EQ((*layouts)[1].text(), "64/covisible");
  EXPECT_EQ((*layouts)[2].text(), "16/level/131072");
  for (const char* text : {"", "33", "32/", "32/x", "32/level/", "32/level/0", "32/level/1", "32/level/16384/1", "32,",
                           ",32", "32 ", "-32", "32/level/99999999999", "0x20"}) {
    EXPECT_FALSE(parse_layouts(text, "--layout")) << text;
  }
  std::string many = "16";
  for (int i = 0; i < 32; ++i) many += ",16";
  EXPECT_FALSE(parse_layouts(many, "--layout"));
}

}  // namespace
}  // namespace meshlode::app
