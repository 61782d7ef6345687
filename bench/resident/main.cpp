// SPDX-License-Identifier: GPL-3.0-or-later
// bench_resident ASSET…: what selecting by residency costs a frame. A field of 20 x 20 instances that take the meshes
// of the assets in turn, and one of 1,000 of which nine tenths are far away or behind; a walk at 1 pixel, 1920 x 1080,
// 60 degrees. One thread; its processor time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "run/read/asset.h"
#include "run/select/resident.h"
#include "thread_clock.h"

namespace {

using namespace meshlode;

/// The tables of several assets as one.
struct Scene {
  std::vector<format::MeshRecord> meshes;
  std::vector<format::InstanceRecord> instances;
  std::vector<format::GroupRecord> groups;
  std::vector<format::ClusterRecord> clusters;
  std::vector<format::NodeRecord> nodes;
  std::uint32_t pages = 0;
  [[nodiscard]] run::SelectTables tables() const { return {meshes, instances, groups, clusters, nodes}; }

  void add(const run::Asset& asset) {
    const auto first = [](const auto& records) { return static_cast<std::uint32_t>(records.size()); };
    const std::uint32_t mesh0 = first(meshes), group0 = first(groups), cluster0 = first(clusters), node0 = first(nodes);
    for (format::MeshRecord mesh : asset.meshes()) {
      mesh.first_group += group0, mesh.first_cluster += cluster0, mesh.first_node += node0;
      meshes.push_back(mesh);
    }
    for (format::GroupRecord group : asset.groups()) {
      group.mesh += mesh0, group.first_cluster += cluster0, group.page += pages;
      groups.push_back(group);
    }
    for (format::ClusterRecord cluster : asset.clusters()) {
      cluster.coarser_group += group0;
      if (cluster.own_group != format::kNone) cluster.own_group += group0;
      clusters.push_back(cluster);
    }
    for (format::NodeRecord node : asset.nodes()) {
      node.first += node.child_count == 0 ? group0 : node0;
      nodes.push_back(node);
    }
    pages += first(asset.pages());
  }

  /// Scaled to a half diagonal of 1, its middle there.
  void place(std::uint32_t mesh_id, double x, double z) {
    const format::MeshRecord& mesh = meshes[mesh_id];
    format::InstanceRecord instance{};
    instance.mesh = mesh_id;
    instance.scale = 2.0 / mesh.diagonal;
    const double step = std::ldexp(mesh.grid.mantissa, mesh.grid.log2), at[3] = {x, 0.0, z};
    for (int i = 0; i < 3; ++i) {
      const double middle = mesh.origin[i] + 0.5 * step * (double{1} * mesh.bounds_min[i] + mesh.bounds_max[i]);
      instance.transform[5 * i] = instance.scale;
      instance.transform[4 * i + 3] = at[i] - instance.scale * middle;
    }
    instance.scale *= 1.0 + 1e-12;
    instances.push_back(instance);
  }
};

void measure(const Scene& scene, const char* name, double share) {
  std::vector<std::uint32_t> resident((scene.pages + 31) / 32);
  std::uint32_t state = 1;
  const run::SelectTables tables = scene.tables();
  for (std::uint32_t p = 0; p < scene.pages; ++p) {
    state = state * 1664525U + 1013904223U;
    if ((state >> 8U) * 0x1p-24 < share) resident[p / 32] |= 1U << p % 32;
  }
  for (const format::GroupRecord& group : scene.groups) {
    if ((group.flags & format::kGroupTerminal) != 0) resident[group.page / 32] |= 1U << group.page % 32;
  }
  run::ResidentSelector selector(tables);
  std::vector<run::ClusterInstance> items(4000000);
  constexpr int kFrames = 200;
  std::vector<double> milliseconds;
  double drawn = 0.0, requests = 0.0;
  for (int frame = 0; frame < kFrames; ++frame) {
    run::Camera camera;
    const double along = 24.0 * frame / kFrames;  // half diagonals
    camera.eye = {along - 12.0 + 0.37, 0.8, 0.6 * along - 7.0};
    camera.target = camera.eye + Vec3d(1.0, -0.1, 0.6);
    camera.width = 1920;
    camera.height = 1080;
    camera.fovy = 1.0471975511965976;
    camera.near_distance = 0.01;
    const run::Frustum frustum = run::frustum_of(camera);
    const double start = bench::thread_seconds();
    const std::size_t count = selector.select(tables, {camera, 1.0, resident, &frustum}, items);
    milliseconds.push_back(1e3 * (bench::thread_seconds() - start));
    drawn += static_cast<double>(count) / kFrames;
    requests += static_cast<double>(selector.requests().size()) / kFrames;
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  double mean = 0.0;
  for (const double ms : milliseconds) mean += ms / kFrames;
  std::printf("%-28s %5.0f%% of %4u pages  %9.0f clusters  %6.1f requests  ms: mean %.3f median %.3f largest %.3f\n",
              name, 100.0 * share, scene.pages, drawn, requests, mean, milliseconds[kFrames / 2], milliseconds.back());
}

}  // namespace

int main(int argc, char** argv) {
  Scene scene;
  for (int a = 1; a < argc; ++a) {
    const auto asset = run::Asset::open(argv[a]);
    if (!asset) {
      std::fprintf(stderr, "%s\n", asset.error().message().c_str());
      return 1;
    }
    scene.add(*asset);
  }
  if (scene.meshes.empty()) return 1;
  const auto mesh = [&](int i) {
    return static_cast<std::uint32_t>(i) % static_cast<std::uint32_t>(scene.meshes.size());
  };
  for (int i = 0; i < 400; ++i) scene.place(mesh(i), 3.0 * (i % 20) - 28.5, 3.0 * (i / 20) - 28.5);
  for (const double share : {1.0, 0.25}) measure(scene, "20 x 20", share);
  scene.instances.clear();
  // A hundred around the walk, the others a thousand half diagonals away, on all sides.
  for (int i = 0; i < 100; ++i) scene.place(mesh(i), 6.0 * (i % 10) - 27.0, 6.0 * (i / 10) - 27.0);
  for (int i = 0; i < 900; ++i) {
    scene.place(mesh(i), 1000.0 * std::cos(0.01 * i * 6.28), 1000.0 * std::sin(0.01 * i * 6.28) + 3.0 * (i / 100));
  }
  for (const double share : {1.0, 0.25}) measure(scene, "1,000, nine tenths far", share);
  return 0;
}
