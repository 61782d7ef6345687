// SPDX-License-Identifier: GPL-3.0-or-later
// Pools and links by hand on a DAG of three levels, a page per group; then whole assets against laws that hold for any.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "app/stream/check_cut.h"
#include "app/stream/report.h"
#include "app/stream/simulate.h"
#include "base/parallel.h"
#include "builder/builder.h"
#include "lab/samples/samples.h"
#include "run/select/resident.h"
#include "scene/import/gltf_builder.h"

namespace meshlode::app {
namespace {

using testing::TempFolder;

/// Group 0 is terminal and has cluster 0, made from group 1, whose members 1 and 2 are made from groups 2 and 3 of two
/// clusters of level 0 each. A page of 1,000 bytes per group. `count` such meshes in a row, 100 apart.
StreamScene chain_scene(std::uint32_t count = 1) {
  StreamScene scene;
  for (std::uint32_t m = 0; m < count; ++m) {
    const auto group = static_cast<std::uint32_t>(scene.groups.size());
    const auto cluster = static_cast<std::uint32_t>(scene.clusters.size());
    const auto node = static_cast<std::uint32_t>(scene.nodes.size());
    format::MeshRecord mesh{};
    mesh.grid = {0, 1};
    mesh.first_group = group;
    mesh.group_count = 4;
    mesh.first_cluster = cluster;
    mesh.cluster_count = 7;
    mesh.first_node = node;
    mesh.node_count = 5;
    mesh.sphere_log2 = -8;
    mesh.level_count = 3;
    scene.meshes.push_back(mesh);
    const float errors[4] = {format::kInfiniteError, 0.1F, 0.01F, 0.01F};
    const std::uint16_t sizes[4] = {1, 2, 2, 2};
    std::uint32_t next = cluster;
    for (std::uint32_t g = 0; g < 4; ++g) {
      format::GroupRecord record{};
      record.radius = 1.0F;
      record.error = errors[g];
      record.first_cluster = next;
      record.cluster_count = sizes[g];
      record.mesh = m;
      record.page = static_cast<std::uint32_t>(scene.pages.size());
      record.level = static_cast<std::uint16_t>(g == 0 ? 2 : g == 1 ? 1 : 0);
      record.flags = g == 0 ? format::kGroupTerminal : 0;
      next += sizes[g];
      scene.groups.push_back(record);
      scene.pages.push_back({1000, 1000});
    }
    const std::uint32_t own[7] = {1, 2, 3, format::kNone, format::kNone, format::kNone, format::kNone};
    const std::uint32_t coarser[7] = {0, 1, 1, 2, 2, 3, 3};
    for (std::uint32_t c = 0; c < 7; ++c) {
      format::ClusterRecord record{};
      record.radius = 128;  // half a unit
      record.own_group = own[c] == format::kNone ? format::kNone : group + own[c];
      record.coarser_group = group + coarser[c];
      record.level = static_cast<std::uint16_t>(c == 0 ? 2 : c < 3 ? 1 : 0);
      scene.clusters.push_back(record);
      scene.cluster_bytes.push_back(c == 0 ? 988U : 494U);
    }
    scene.nodes.push_back({{0.0F, 0.0F, 0.0F}, 1.0F, format::kInfiniteError, node + 1, 4});
    for (std::uint32_t g = 0; g < 4; ++g) scene.nodes.push_back({{0.0F, 0.0F, 0.0F}, 1.0F, errors[g], group + g, 0});
    format::InstanceRecord instance{};
    instance.transform[0] = instance.transform[5] = instance.transform[10] = 1.0;
    instance.transform[3] = 100.0 * m;
    instance.scale = 1.0;
    instance.mesh = m;
    scene.instances.push_back(instance);
  }
  scene.box = {Vec3d(-1.0), Vec3d(1.0 + 100.0 * (count - 1), 1.0, 1.0)};
  return scene;
}

StreamView small_view() {
  StreamView view;
  view.width = view.height = 1000;
  view.fps = 10;
  return view;
}

/// Near enough for level 0: 0.01 over a distance of 1 is eight pixels.
std::vector<PathFrame> stand(std::size_t frames, double x = 0.0) {
  std::vector<PathFrame> path(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    path[f] = {static_cast<std::int64_t>(f) * 100000, {x, 0.0, 2.0}, {x, 0.0, 0.0}, 1.0, f == 0};
  }
  return path;
}

RunResult run_one(const StreamScene& scene, const std::vector<PathFrame>& path, const RunSpec& spec) {
  const Simulation simulation = simulate(scene, path, small_view(), {&spec, 1}, {.checks = true});
  EXPECT_EQ(count_findings(simulation), 0U);
  for (const RunResult& run : simulation.runs) {
    for (const std::string& text : run.findings) ADD_FAILURE() << text;
  }
  return simulation.runs[0];
}

TEST(Simulate, PagesFollowEachOtherOnTheLinkAndArriveItsLatencyLater) {
  const RunResult run = run_one(chain_scene(), stand(3), {std::nullopt, {1.0, 2.0}});
  ASSERT_EQ(run.log.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(run.log[i].page, i + 1);
    EXPECT_EQ(run.log[i].sent_us, 1000 * i);
    EXPECT_EQ(run.log[i].arrival_us, 1000 * i + 1000 + 2000);
  }
  EXPECT_EQ(run.loaded_bytes, 3000U);
  EXPECT_EQ(run.peak_pool_bytes, 4000U);
  // 0.1 at a distance of 2 - 0.5, by 1000 rows of an opening of one radian; then level 0, which shows nothing.
  EXPECT_NEAR(run.max_px[0], 0.1 / 1.5 * 1000.0 / (2.0 * std::tan(0.5)), 1e-3);
  EXPECT_EQ(run.max_px[1], 0.0F);
  EXPECT_EQ(run.missing_pages, (std::vector<std::uint32_t>{3, 0, 0}));
  EXPECT_EQ(run.asked.jumps, 1U);
  EXPECT_EQ(run.asked.max_ms, 100.0);
}

TEST(Simulate, ASlowLinkSendsOnePageAfterTheOther) {
  const RunResult run = run_one(chain_scene(), stand(9), {std::nullopt, {0.004, 10.0}});  // 250 ms a page
  ASSERT_EQ(run.log.size(), 3U);
  EXPECT_EQ(run.log[0].arrival_us, 260000);
  EXPECT_EQ(run.log[1].sent_us, 250000);
  EXPECT_EQ(run.log[2].sent_us, 500000);
  EXPECT_EQ(run.missing_pages, (std::vector<std::uint32_t>{3, 3, 3, 2, 2, 2, 1, 1, 0}));
  EXPECT_EQ(run.worst_bytes, 3000U);
  EXPECT_EQ(run.asked.max_ms, 800.0);
}

TEST(Simulate, APoolIsNeverExceededAndNeedsRoomForTheRoots) {
  const RunResult half = run_one(chain_scene(), stand(4), {2500, {1.0, 0.0}});
  EXPECT_EQ(half.requests, 1U);
  EXPECT_EQ(half.peak_pool_bytes, 2000U);
  EXPECT_EQ(half.asked.not_reached, 1U);
  EXPECT_FALSE(run_one(chain_scene(), stand(4), {999, {1.0, 0.0}}).fits);
  EXPECT_TRUE(run_one(chain_scene(), stand(4), {1000, {1.0, 0.0}}).fits);
}

TEST(Simulate, WhatIsNotSeenMakesPlaceForWhatIs) {
  const StreamScene scene = chain_scene(2);
  std::vector<PathFrame> path = stand(3);
  for (const PathFrame& frame : stand(3, 100.0)) {
    path.push_back(frame);
    path.back().time_us += 300000;
  }
  const RunResult run = run_one(scene, path, {5000, {1.0, 0.0}});  // two roots and three more
  ASSERT_EQ(run.log.size(), 6U);
  EXPECT_EQ(run.log[3].page, 5U);
  EXPECT_EQ(run.log[3].evicted, (std::vector<std::uint32_t>{3}));  // of equal worth the largest id first
  EXPECT_EQ(run.log[5].evicted, (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(run.reloads, 0U);
  EXPECT_EQ(run.max_px.back(), 0.0F);
}

TEST(Simulate, DemandIsWhatAFrameNeeds) {
  const Demand demand = simulate(chain_scene(2), stand(1), small_view(), {}, {.checks = true}).demand;
  EXPECT_EQ(demand.max_bytes, 5000U) << "the mesh in view, and the root of the other";
  EXPECT_EQ(demand.root_pages, 2U);
  EXPECT_EQ(demand.root_reads, 2U) << "other pages lie between them";
  EXPECT_NEAR(demand.drawn_share, 4 * 494.0 / 5000.0, 1e-12);
  EXPECT_NEAR(demand.whole_group_share, 4 * 494.0 / (4 * 988.0), 1e-12);
}

TEST(Simulate, NeighboursInAFileAreOneRead) {
  StreamScene scene = chain_scene(2);
  for (format::GroupRecord& group : scene.groups) group.flags = format::kGroupTerminal;  // each page is a root
  EXPECT_EQ(simulate(scene, stand(1), small_view(), {}).demand.root_pages, 8U);
  EXPECT_EQ(simulate(scene, stand(1), small_view(), {}).demand.root_reads, 1U);
  scene.first_mesh_of_file = {0, 1};
  EXPECT_EQ(simulate(scene, stand(1), small_view(), {}).demand.root_reads, 2U);
  scene.first_mesh_of_file = {0, 0, 2};  // files without meshes
  EXPECT_EQ(simulate(scene, stand(1), small_view(), {}).demand.root_reads, 1U);
}

TEST(CutCheck, FindsWhatIsWrongWithACut) {
  const StreamScene scene = chain_scene();
  run::Camera camera;
  camera.eye = {0.0, 0.0, 2.0};
  camera.near_distance = 0.01;
  CutCheck check(scene);
  const auto fault = [&](const std::vector<std::uint32_t>& clusters, const std::vector<std::uint8_t>& resident) {
    std::vector<run::ClusterInstance> items;
    for (const std::uint32_t c : clusters) items.push_back({InstanceId(0U), ClusterId(c)});
    return check.find_fault(camera, 1.0, resident, items).value_or("none");
  };
  EXPECT_EQ(fault({3, 4, 5, 6}, {1, 1, 1, 1}), "none");
  EXPECT_EQ(fault({1, 5, 6}, {1, 1, 0, 1}), "none");
  EXPECT_EQ(fault({0}, {1, 0, 1, 1}), "none");
  EXPECT_EQ(fault({3, 4, 5, 6}, {1, 1, 0, 1}), "page 2 is drawn and not there");
  EXPECT_EQ(fault({3, 5, 6}, {1, 1, 1, 1}), "nothing is drawn for instance 0, cluster 4");
  EXPECT_EQ(fault({0, 3}, {1, 0, 1, 1}), "instance 0, cluster 3 is drawn twice on a path");
  EXPECT_EQ(fault({1, 5, 6}, {1, 1, 1, 1}), "instance 0, cluster 1 could be finer");
  EXPECT_EQ(fault({0}, {1, 1, 0, 0}), "instance 0, cluster 0 could be finer");
  EXPECT_EQ(fault({}, {1, 1, 1, 1}), "nothing is drawn for instance 0, cluster 3");
}

run::Asset build_sample(const char* name) {
  const std::vector<std::uint8_t> glb = lab::make_sample_file(name).bytes;
  const TempFolder folder;
  const auto scene = scene::import_scene(folder.write("scene.glb", std::string(glb.begin(), glb.end())), {});
  builder::PipelineOptions options;
  options.preset = Preset::kFast;
  options.error_tier = format::ErrorTier::kQem;
  options.page_kib = 16;
  builder::PipelineReport report;
  return std::move(*run::Asset::from_vector(*builder::build_lode(*scene, options, {}, report)));
}

/// Replays a log: what is there or on its way, page by page.
void expect_sound_log(const StreamScene& scene, const RunSpec& spec, const RunResult& run) {
  std::set<std::uint32_t> held;
  for (const format::GroupRecord& group : scene.groups) {
    if ((group.flags & format::kGroupTerminal) != 0) held.insert(group.page);
  }
  const std::set<std::uint32_t> roots = held;
  std::uint64_t loaded = 0;
  std::int64_t free_us = 0;
  for (const Transfer& transfer : run.log) {
    for (const std::uint32_t page : transfer.evicted) {
      ASSERT_EQ(held.erase(page), 1U);
      ASSERT_FALSE(roots.contains(page));
    }
    ASSERT_TRUE(held.insert(transfer.page).second) << "is there already";
    ASSERT_GE(transfer.sent_us, free_us) << "two at a time";
    free_us = transfer.arrival_us - static_cast<std::int64_t>(spec.link.latency_ms * 1000.0);
    ASSERT_GE(free_us, transfer.sent_us);
    loaded += scene.pages[transfer.page].stored_bytes;
    std::uint64_t used = 0;
    for (const std::uint32_t page : held) used += scene.pages[page].bytes;
    ASSERT_LE(used, spec.pool_bytes.value_or(~std::uint64_t{0}));
  }
  EXPECT_EQ(loaded, run.loaded_bytes);
}

TEST(Simulate, LawsHoldOnAssetsAndThreadsChangeNoByte) {
  std::vector<run::Asset> assets;
  assets.push_back(build_sample("rock.glb"));
  assets.push_back(build_sample("city.glb"));
  const Placement placements[] = {
      {0, {0.0, 0.0, 0.0}, 0.0, 1.0}, {0, {3.0, 0.0, 1.0}, 40.0, 0.5}, {1, {0.0, -2.0, 0.0}, 0.0, 0.1}};
  const std::vector<std::string> names{"rock", "city"};
  const auto scene = make_stream_scene(assets, names, placements);
  ASSERT_TRUE(scene) << scene.error().message();
  std::vector<RunSpec> specs;
  for (const auto& pool : {std::optional<std::uint64_t>(), std::optional(scene->page_bytes() / 3)}) {
    for (const double bandwidth : {0.2, 20.0}) specs.push_back({pool, {bandwidth, 7.5}});
  }
  for (const BuiltinPath kind : {BuiltinPath::kFly, BuiltinPath::kWalk, BuiltinPath::kTurn, BuiltinPath::kTeleport}) {
    StreamView view;
    view.fps = 12;
    const auto path = sample_path(builtin_path(kind, *scene), view.fps, "path");
    ASSERT_TRUE(path);
    const auto text = [&] {
      const Simulation simulation = simulate(*scene, *path, view, specs, {true, true});
      EXPECT_EQ(count_findings(simulation), 0U) << name_in(kBuiltinPathNames, kind);
      for (std::size_t i = 0; i < specs.size(); ++i) expect_sound_log(*scene, specs[i], simulation.runs[i]);
      return stream_json({{"a", "b"}, "p", *scene, *path, view, specs, simulation, true, true});
    };
    EXPECT_EQ(text(), with_threads_at_most(1, text));
  }
}

TEST(StreamScene, MoreInstancesThanAPictureShowsAreRefused) {
  std::vector<run::Asset> assets;
  assets.push_back(build_sample("city.glb"));  // 51 instances
  const std::vector<Placement> placements(2000, Placement{});
  const std::vector<std::string> names{"city"};
  const auto scene = make_stream_scene(assets, names, placements);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace meshlode::app
