// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds: triangles at equal true deviation of one scene under several seeds of the partitioner. A partition is partly
// luck; how much shows in how the figures differ from seed to seed. compare_seeds.py holds two runs against each other.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "base/json_writer.h"
#include "builder/builder.h"
#include "builder/preset.h"
#include "command_line.h"
#include "judge/metrics/cut_judge.h"
#include "judge/metrics/cut_search.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "scene/import/import.h"

namespace {

using namespace meshlode;

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

std::optional<int> read_options(int argc, char** argv, Options& o) {
  CLI::App app("Triangles at equal true deviation under several seeds of the partitioner", "bench_seeds");
  app.option_defaults()->always_capture_default();
  app.add_option("scenes", o.scenes, "scenes")->required();
  app.add_option("--seeds", o.seeds, "seeds 1 to N of the partitioner")->check(CLI::PositiveNumber);
  app.add_option("--preset", o.preset, "fast, default or best")->check(CLI::IsMember({"fast", "default", "best"}));
  app.add_option("--samples", o.samples, bench::kSamplesHelp);
  app.add_option("--jobs", o.jobs, bench::kJobsHelp);
  app.add_option("--json", o.json, "write the figures there too");
  return bench::read_command_line(app, argc, argv);
}

void measure_mesh(const scene::SourceMesh& source, const run::Asset& asset,
                  const std::vector<run::DecodedCluster>& decoded, const Options& options, SeedCut one,
                  std::vector<SeedCut>& out) {
  const double diagonal = asset.meshes()[one.mesh].diagonal;
  const judge::Surface surface = judge::surface_of_source(source);
  if (surface.triangles.size() < kFewTriangles || !(diagonal > 0.0)) return;
  judge::CutJudge judge(surface, asset, decoded, MeshId(one.mesh), options.samples);
  const auto find = [&](judge::Figure figure, const char* name, double x) {
    const auto found =
        judge::find_fewest_triangles(judge, asset, MeshId(one.mesh), {run::CutError::kSelection, figure, x * diagonal});
    one.figure = name;
    one.x = x;
    one.triangles = found ? found->figures.triangles : 0;
    out.push_back(one);
    std::printf("%s mesh %u seed %u: %s <= %.0e: %llu triangles\n", one.scene.c_str(), one.mesh, one.seed, name, x,
                static_cast<unsigned long long>(one.triangles));
    std::fflush(stdout);
  };
  for (const double x : kAtMax) find(judge::Figure::kMax, "max", x);
  for (const double x : kAtRms) find(judge::Figure::kRms, "rms", x);
}

/// Error: what the build or the reader says.
Status measure_scene(const std::string& path, const Options& options, builder::PipelineOptions pipeline,
                     std::vector<SeedCut>& out) {
  const Result<scene::Scene> scene = scene::import_scene(path, {});
  if (!scene) return scene.error();
  for (std::uint32_t seed = 1; seed <= options.seeds; ++seed) {
    pipeline.partition_seed = seed;
    builder::PipelineReport report;
    auto bytes = builder::build_lode(*scene, pipeline, {}, report);
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
  if (const std::optional<int> exit_code = read_options(argc, argv, options)) return *exit_code;
  builder::PipelineOptions pipeline;
  pipeline.preset = *value_in(builder::kPresetNames, options.preset);
  pipeline.error_tier = builder::settings_of(pipeline.preset).error_tier;
  const bench::ThreadLimit limit(options.jobs);
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
