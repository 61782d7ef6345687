// SPDX-License-Identifier: GPL-3.0-or-later
// How fast loaded pages become integers and float attributes on one thread: every cluster of an asset, again and again
// into the same arrays. The best of many repetitions, in seconds of the thread's own time, because other work on the
// machine is not ours.
//
//   bench_decode bunny.lode dragon.lode ...
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/unpack/unpack.h"
#include "thread_clock.h"

namespace {

using namespace meshlode;

[[noreturn]] void fail(const std::string& where, const std::string& detail) {
  std::fprintf(stderr, "bench_decode: %s: %s\n", where.c_str(), detail.c_str());
  std::exit(1);
}

template <class Work>
double best_seconds(Work work) {
  constexpr int kRepetitions = 41;
  double best = 1e30;
  for (int r = 0; r < kRepetitions; ++r) {
    const double start = bench::thread_seconds();
    work();
    best = std::min(best, bench::thread_seconds() - start);
  }
  return best;
}

void measure(const std::string& path) {
  const auto asset = run::Asset::open(path);
  if (!asset) fail(path, asset.error().detail);
  std::vector<run::PageBytes> pages;
  for (std::size_t p = 0; p < asset->pages().size(); ++p) {
    auto page = run::load_page(*asset, PageId{p});
    if (!page) fail(path, page.error().detail);
    pages.push_back(std::move(*page));
  }
  run::DecodedCluster cluster;
  run::ClusterAttributes attributes;
  double vertices = 0.0;
  double triangles = 0.0;
  float seen = 0.0F;  // so that nothing is left out
  for (const format::ClusterRecord& record : asset->clusters()) {
    vertices += record.vertex_count();
    triangles += record.triangle_count();
  }
  const auto each_cluster = [&](auto work) {
    for (std::size_t p = 0; p < pages.size(); ++p) {
      const format::PageRecord& record = asset->pages()[p];
      const format::MeshRecord& mesh = asset->meshes()[asset->groups()[record.first_group].mesh];
      for (std::uint32_t i = 0; i < record.cluster_count; ++i)
        work(mesh, pages[p], ClusterId{record.first_cluster + i});
    }
  };
  const double integers = best_seconds([&] {
    each_cluster([&](const format::MeshRecord&, const run::PageBytes& page, ClusterId id) {
      run::decode_cluster(*asset, page, id, cluster);
      seen += static_cast<float>(cluster.channels[0]);
    });
  });
  const double floats = best_seconds([&] {
    each_cluster([&](const format::MeshRecord& mesh, const run::PageBytes& page, ClusterId id) {
      run::decode_vertices(*asset, page, id, cluster);
      run::decode_attributes(mesh, cluster, attributes);
      seen += attributes.positions[0].x;
    });
  });
  std::printf("%s: %.0f vertices, %.0f triangles in clusters\n", std::filesystem::path(path).filename().c_str(),
              vertices, triangles);
  std::printf("  integers and triangles   %7.1f M vertices/s %7.1f M triangles/s\n", vertices / integers * 1e-6,
              triangles / integers * 1e-6);
  std::printf("  float attributes         %7.1f M vertices/s%s\n", vertices / floats * 1e-6, seen == 1e30F ? " " : "");
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) measure(argv[i]);
  return 0;
}
