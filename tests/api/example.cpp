// SPDX-License-Identifier: GPL-3.0-or-later
// The example of docs/reference/api.md: a grid of hills built from arrays, then drawn from near and from far.
#include <cstdio>
#include <vector>

#include <meshlode/build.h>
#include <meshlode/runtime.h>

int main(int argc, char** argv) {
  if (argc != 2) return 1;

  // 1. A surface in plain arrays: 3 floats a vertex, 3 indices a triangle.
  constexpr std::uint32_t kSide = 129;
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const float x = static_cast<float>(i) / 64.0F - 1.0F, z = static_cast<float>(j) / 64.0F - 1.0F;
      positions.insert(positions.end(), {x, 0.5F * x * x * z * z, z});
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const std::uint32_t a = j * kSide + i, b = a + kSide;
      indices.insert(indices.end(), {a, b, a + 1, a + 1, b, b + 1});
    }
  }

  // 2. Build it and write the asset.
  meshlode::PrimitiveInput primitive;
  primitive.positions = positions;
  primitive.indices = indices;
  meshlode::MeshInput mesh;
  mesh.name = "hills";
  mesh.primitives = {&primitive, 1};
  meshlode::SceneInput scene;
  scene.meshes = {&mesh, 1};
  meshlode::BuildOptions options;
  options.on_progress = [](const meshlode::BuildProgress& p) { std::printf("%3.0f%%\n", 100.0 * p.fraction); };
  if (auto status = meshlode::build_asset_file(scene, argv[1], options); !status) {
    std::fprintf(stderr, "%s\n", status.error().message().c_str());
    return static_cast<int>(status.error().code);
  }

  // 3. Open it, choose what two cameras need, and decode that.
  const auto asset = meshlode::AssetFile::open(argv[1]);
  if (!asset) {
    std::fprintf(stderr, "%s\n", asset.error().message().c_str());
    return static_cast<int>(asset.error().code);
  }
  for (const double distance : {2.0, 200.0}) {
    meshlode::View view;
    view.eye = {0.0, distance, 0.0};
    const auto items = asset->select_view(view, 1.0);
    if (!items) return 1;
    std::size_t triangles = 0;
    meshlode::ClusterFloats cluster;
    for (const meshlode::DrawItem& item : *items) {
      const auto page = asset->load_page(asset->page_of(item.cluster));  // a renderer keeps its pages
      if (!page || !asset->decode(*page, item.cluster, cluster)) return 1;
      triangles += cluster.triangles.size();
    }
    std::printf("from %g away: %zu clusters, %zu triangles\n", distance, items->size(), triangles);
  }
  return 0;
}
