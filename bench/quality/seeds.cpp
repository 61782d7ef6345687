// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds: triangles at equal true deviation of one scene under several seeds of the partitioner. A partition is partly
// luck; how much shows in how the figures differ from seed to seed. compare_seeds.py holds two runs against each other.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <tbb/global_control.h>

#include "base/json_writer.h"
#include "build/build.h"
#include "build/preset.h"
#include "cut_judge.h"
#include "cut_search.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "scene/import/import.h"

namespace {

using namespace meshlode;

constexpr const char* kUsage =
    "usage: bench_seeds SCENE... [options]\n"
    "  --seeds N      seeds 1 to N of the partitioner (5)\n"
    "  --preset NAME  fast, default or best (default)\n"
    "  --samples N    area-uniform samples each way, all vertices on top (200000)\n"
    "  --jobs N       threads (one per core)\n"
    "  --json FILE    write the figures there too\n";

/// Shares of the diagonal.
constexpr double kAtMax[] = {1e-3, 2e-3, 5e-3};
constexpr double kAtRms[] = {1e-4, 3e-4, 1e-3};
/// Meshes with fewer triangles have a handful of clusters: nothing to choose among.
constexpr std::size_t kFewTriangles = 1000;

struct Options {
  std::vector<std::string> scenes;
  std::string json, preset = "default";
  std::uint32_t seeds = 5;
  std::uint64_t samples = 200000;
  std::size_t jobs = 0;
};

/// One figure of one mesh under one seed; no triangles where no cut is within x.
struct SeedCut {
  std::string scene;
  std::uint32_t mesh = 0, seed = 0;
  const char* figure = "max";
  double x = 0.0;
  std::uint64_t triangles = 0;
};

template <class Number>
bool read_number(const std::string& text, Number& out) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc{} && stop == text.data() + text.size();
}

bool parse(int argc, char** argv, Options& o) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0) {
      o.scenes.push_back(word);
      continue;
    }
    if (i + 1 >= argc) return false;
    const std::string value = argv[++i];
    const bool is_read = word == "--seeds"     ? read_number(value, o.seeds)
                         : word == "--samples" ? read_number(value, o.samples)
                         : word == "--jobs"    ? read_number(value, o.jobs)
                         : word == "--preset"  ? (o.preset = value, true)
                         : word == "--json"    ? (o.json = value, true)
                                               : false;
    if (!is_read) return false;
  }
  return !o.scenes.empty() && o.seeds > 0;
}

void measure_mesh(const scene::SourceMesh& source, const run::Asset& asset,
                  const std::vector<run::DecodedCluster>& decoded, const Options& options, SeedCut one,
                  std::vector<SeedCut>& out) {
  const double diagonal = asset.meshes()[one.mesh].diagonal;
  const judge::Surface surface = judge::surface_of_source(source);
  if (surface.triangles.size() < kFewTriangles || !(diagonal > 0.0)) return;
  bench::CutJudge judge(surface, asset, decoded, MeshId(one.mesh), options.samples);
  const auto find = [&](bench::Figure figure, const char* name, double x) {
    const auto found =
        bench::find_fewest_triangles(judge, asset, MeshId(one.mesh), {run::CutError::kSelection, figure, x * diagonal});
    one.figure = name;
    one.x = x;
    one.triangles = found ? found->figures.triangles : 0;
    out.push_back(one);
    std::printf("%s mesh %u seed %u: %s <= %.0e: %llu triangles\n", one.scene.c_str(), one.mesh, one.seed, name, x,
                static_cast<unsigned long long>(one.triangles));
    std::fflush(stdout);
  };
  for (const double x : kAtMax) find(bench::Figure::kMax, "max", x);
  for (const double x : kAtRms) find(bench::Figure::kRms, "rms", x);
}

/// Error: what the build or the reader says.
Status measure_scene(const std::string& path, const Options& options, build::PipelineOptions pipeline,
                     std::vector<SeedCut>& out) {
  const Result<scene::Scene> scene = scene::import_scene(path, {});
  if (!scene) return scene.error();
  for (std::uint32_t seed = 1; seed <= options.seeds; ++seed) {
    pipeline.partition_seed = seed;
    build::PipelineReport report;
    auto bytes = build::build_lode(*scene, pipeline, {}, report);
    if (!bytes) return bytes.error();
    const Result<run::Asset> asset = run::Asset::from_vector(std::move(*bytes));
    if (!asset) return asset.error();
    const Result<std::vector<run::DecodedCluster>> decoded = run::decode_all(*asset);
    if (!decoded) return decoded.error();
    for (std::uint32_t m = 0; m < scene->meshes.size(); ++m) {
      measure_mesh(scene->meshes[m], *asset, *decoded, options,
                   {.scene = std::filesystem::path(path).stem().string(), .mesh = m, .seed = seed}, out);
    }
  }
  return Ok{};
}

std::string seeds_json(const std::vector<SeedCut>& cuts) {
  JsonWriter w;
  w.begin_object();
  w.key("cuts");
  w.begin_array();
  for (const SeedCut& one : cuts) {
    w.begin_object();
    w.field("scene", one.scene);
    w.field("mesh", one.mesh);
    w.field("seed", one.seed);
    w.field("figure", one.figure);
    w.field("x", one.x);
    w.field("triangles", one.triangles);
    w.end_object();
  }
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::fputs(kUsage, stderr);
    return 1;
  }
  const std::optional<Preset> preset = value_in(build::kPresetNames, options.preset);
  if (!preset) {
    std::fputs(kUsage, stderr);
    return 1;
  }
  build::PipelineOptions pipeline;
  pipeline.preset = *preset;
  pipeline.error_tier = build::settings_of(*preset).error_tier;
  const std::size_t allowed =
      options.jobs > 0 ? options.jobs : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, allowed);
  std::vector<SeedCut> cuts;
  for (const std::string& path : options.scenes) {
    const Status measured = measure_scene(path, options, pipeline, cuts);
    if (!measured) {
      std::fprintf(stderr, "%s: %s\n", path.c_str(), measured.error().message().c_str());
      return 2;
    }
  }
  if (options.json.empty()) return 0;
  std::ofstream file(options.json, std::ios::binary);
  file << seeds_json(cuts);
  if (file.flush()) return 0;
  std::fprintf(stderr, "%s: cannot be written\n", options.json.c_str());
  return 2;
}
