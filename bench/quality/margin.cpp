// SPDX-License-Identifier: GPL-3.0-or-later
// Margin: how true the errors of the tier `measured` are, over many scenes. Builds each scene, brackets uniform cuts as
// `verify` does (V206) and prints the deviation that was met over what is stored, then how many of the whole series are
// above 1 and 1.05, and how many are undecided.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "builder/builder.h"
#include "builder/measure/measure.h"
#include "command_line.h"
#include "judge/verify/deviations.h"
#include "random/scene.h"
#include "run/read/asset.h"
#include "scene/import/import.h"

namespace {

using namespace meshlode;

struct Options {
  std::vector<std::string> scenes;
  std::vector<std::uint64_t> random;  ///< first seed, count, step
  std::uint32_t cuts = 12;
  std::uint32_t budget = judge::kDeviationBudget;
  std::size_t jobs = 0;
  double above = 0.0;
};

std::optional<int> read_options(int argc, char** argv, Options& o) {
  CLI::App app("How true the errors of the tier `measured` are: true over stored of uniform cuts", "bench_margin");
  app.option_defaults()->always_capture_default();
  app.add_option("scenes", o.scenes, "scenes");
  app.add_option("--random", o.random,
                 "FIRST,COUNT,STEP: scenes of the tests' generator (tests/random), seeds FIRST, "
                 "FIRST + STEP, ...")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--cuts", o.cuts, "uniform cuts of each mesh")->check(CLI::PositiveNumber);
  app.add_option("--budget", o.budget, "splits for each triangle, after which a cut is undecided");
  app.add_option("--jobs", o.jobs, bench::kJobsHelp);
  app.add_option("--above", o.above, "print only cuts whose true over stored is above this");
  return bench::read_command_line(app, argc, argv);
}

struct Series {
  std::size_t scenes = 0, refused = 0;
  std::vector<double> ratios;  ///< met over stored, of every cut
  std::size_t undecided = 0;   ///< cuts that may be above 1, and were not seen to be
  double build_seconds = 0.0;
  std::uint64_t triangles = 0;
};

void measure_scene(const std::string& name, const scene::Scene& scene, const Options& options, Series& series) {
  builder::PipelineReport report;
  const auto start = std::chrono::steady_clock::now();
  auto bytes = builder::build_lode(scene, {}, {}, report);
  series.build_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++series.scenes;
  if (!bytes) {
    ++series.refused;
    return;
  }
  const Result<run::Asset> asset = run::Asset::from_vector(std::move(*bytes));
  if (!asset) return;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    series.triangles += asset->meshes()[m].source_triangles;
    const auto brackets = judge::bracket_cuts(*asset, MeshId(m), scene.meshes[m], options.cuts, options.budget);
    if (!brackets) return;
    for (const judge::CutBracket& cut : *brackets) {
      const double ratio = cut.is_above(1.0) ? cut.ratio_of(cut.lower) : std::min(cut.ratio_of(cut.lower), 1.0);
      series.ratios.push_back(ratio);
      if (cut.is_undecided()) ++series.undecided;
      if (!(ratio > options.above)) continue;
      std::printf("%s mesh %u: stored %.6g true %.6g to %.6g ratio %.4f %s at %.9g %.9g %.9g\n", name.c_str(), m,
                  cut.stored, cut.lower, cut.upper, ratio, cut.is_of_source ? "source" : "cut", cut.worst.x,
                  cut.worst.y, cut.worst.z);
    }
  }
  std::fflush(stdout);
}

/// Each through a file, as a user's scene would come. The generator's build options are not used: the tier's defaults
/// are what is measured.
bool measure_random_scenes(const Options& options, Series& series) {
  std::string path = (std::filesystem::temp_directory_path() / "bench_margin.XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) return false;
  const std::filesystem::path folder(path), file = folder / "scene.glb";
  bool is_written = true;
  for (std::uint64_t i = 0; i < options.random[1] && is_written; ++i) {
    const std::uint64_t seed = options.random[0] + i * options.random[2];
    const std::vector<std::uint8_t> glb = test::write_glb(test::random_scene(seed));
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(glb.data()), static_cast<std::streamsize>(glb.size()));
    out.close();
    is_written = out.good();
    const Result<scene::Scene> scene = scene::import_scene(file, {});
    if (scene) measure_scene("seed " + std::to_string(seed), *scene, options, series);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return is_written;
}

std::size_t count_above(const Series& series, double limit) {
  return static_cast<std::size_t>(
      std::count_if(series.ratios.begin(), series.ratios.end(), [&](double r) { return r > limit; }));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (const std::optional<int> exit_code = read_options(argc, argv, options)) return *exit_code;
  const bench::ThreadLimit limit(options.jobs);
  Series series;
  for (const std::string& path : options.scenes) {
    const Result<scene::Scene> scene = scene::import_scene(path, {});
    if (!scene) {
      std::fprintf(stderr, "%s\n", scene.error().message().c_str());
      return 2;
    }
    measure_scene(path, *scene, options, series);
  }
  if (!options.random.empty() && !measure_random_scenes(options, series)) return 2;
  std::sort(series.ratios.begin(), series.ratios.end());
  if (series.ratios.empty()) return 0;
  std::printf("%zu scenes (%zu refused), %llu triangles, built in %.2f s\n", series.scenes, series.refused,
              static_cast<unsigned long long>(series.triangles), series.build_seconds);
  std::printf("%zu cuts, margin %.3f: true/stored median %.3f, largest %.4f\n", series.ratios.size(),
              builder::kMeasuredMargin, series.ratios[series.ratios.size() / 2], series.ratios.back());
  std::printf("undecided: %zu\n", series.undecided);
  for (const double x : {0.97, 0.98, 0.99, 1.0, 1.01, 1.02, 1.05}) {
    std::printf("above %.2f: %zu (%.2f%%)\n", x, count_above(series, x),
                100.0 * static_cast<double>(count_above(series, x)) / static_cast<double>(series.ratios.size()));
  }
  return 0;
}
