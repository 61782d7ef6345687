// SPDX-License-Identifier: GPL-3.0-or-later
// bench_aggregate ASSET...: the triangles of uniform cuts at one pixel, by pixels across the model, and how far what
// they cover is from what level 0 covers (judge/metrics/coverage.h), as a Markdown table. Of each asset its first mesh,
// or the part of it that is an aggregate.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "judge/metrics/coverage.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace {

using namespace meshlode;

std::uint64_t count_triangles(const run::Asset& asset, std::span<const ClusterId> clusters) {
  std::uint64_t sum = 0;
  for (const ClusterId c : clusters) sum += asset.clusters()[c.value].triangle_count();
  return sum;
}

int measure(const char* path) {
  const Result<run::Asset> opened = run::Asset::open(path);
  if (!opened) {
    std::fprintf(stderr, "%s\n", opened.error().message().c_str());
    return 2;
  }
  const run::Asset& asset = *opened;
  const format::MeshRecord& mesh = asset.meshes()[0];
  double longest = 0.0;
  const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (double{1} * mesh.bounds_max[k] - mesh.bounds_min[k]) * step);
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset);
  const auto covering = [&](const std::vector<ClusterId>& clusters) {
    return judge::covering_triangles(asset, masks, MeshId(0U), clusters);
  };
  const auto source = covering(run::select_uniform(asset, MeshId(0U), -1.0).clusters);
  if (!source) return 3;
  for (const double pixels : {300.0, 150.0, 100.0, 72.0, 50.0, 30.0, 20.0, 10.0, 5.0}) {
    const run::UniformCut cut = run::select_uniform(asset, MeshId(0U), longest / pixels);
    const auto drawn = covering(cut.clusters);
    if (!drawn) return 3;
    const auto drift = judge::measure_coverage(*source, *drawn, masks, longest / pixels);
    if (!drift) continue;
    std::printf("| %s | %.0f | %llu | %.3f | %+.2f%% | %.3f | %.1f%% |\n", std::filesystem::path(path).stem().c_str(),
                pixels, static_cast<unsigned long long>(count_triangles(asset, cut.clusters)), drift->rms,
                100.0 * drift->mean, drift->contrast, 100.0 * drift->worst_direction);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::puts("| asset | pixels across | triangles | noise | covered | contrast | worst direction |");
  std::puts("| --- | ---: | ---: | ---: | ---: | ---: | ---: |");
  int code = 0;
  for (int i = 1; i < argc; ++i) code = std::max(code, measure(argv[i]));
  return code;
}
