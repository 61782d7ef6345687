// SPDX-License-Identifier: MIT
// A stranger's engine: opens an asset, selects a cut, decodes it.
#include <cstdio>

#include <meshlode/runtime.h>

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const auto asset = meshlode::AssetFile::open(argv[1]);
  if (!asset) {
    std::puts(asset.error().message().c_str());
    return 1;
  }
  meshlode::View view;
  view.eye = {0.0, 0.0, 5.0};
  const auto items = asset->select_view(view, 1.0);
  if (!items || items->empty()) return 1;
  std::size_t triangles = 0;
  for (const meshlode::DrawItem& item : *items) {
    const auto page = asset->load_page(asset->page_of(item.cluster));
    meshlode::ClusterFloats cluster;
    if (!page || !asset->decode(*page, item.cluster, cluster)) return 1;
    triangles += cluster.triangles.size();
  }
  std::printf("%zu triangle(s) drawn\n", triangles);
  return triangles == 1 ? 0 : 1;
}
