// SPDX-License-Identifier: GPL-3.0-or-later
// Quality: uniform cuts of an asset against its source. For each threshold: triangles, true maximum and RMS deviation
// both ways, stored error. Then triangles at equal deviation: the fewest over all actual cuts whose true figure is at
// most x, by the selection error and for the RMS by the quadric's too, and what that very cut does to shading normals
// and UVs; with --normals the fewest that keep the normals as well. docs/log/quality.md explains the measures.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "app/report/info.h"
#include "command_line.h"
#include "format/names.h"
#include "judge/metrics/attribute_drift.h"
#include "judge/metrics/cut_judge.h"
#include "judge/metrics/cut_search.h"
#include "quality_report.h"
#include "reference.h"
#include "run/decode/decode.h"
#include "run/select/select.h"
#include "scene/import/import.h"

namespace {

using namespace meshlode;
using namespace meshlode::bench;

struct Options {
  std::string scene, asset, json, by = name_in(run::kCutErrorNames, run::CutError::kSelection), drift = "equal";
  bool with_reference = false;
  int cuts = 24;
  std::size_t jobs = 0;
  std::uint64_t samples = 200000;
  double from = 1e-4, to = 2e-2;
  double normals = 0.0;  ///< degrees; 0: no bound
  std::vector<double> at_max{1e-3, 2e-3, 5e-3}, at_rms{1e-4, 3e-4, 1e-3};
};

std::optional<int> read_options(int argc, char** argv, Options& o) {
  CLI::App app("Uniform cuts of an asset against its source", "bench_quality");
  app.option_defaults()->always_capture_default();
  app.add_option("scene", o.scene, "the source")->required();
  app.add_option("asset", o.asset, "what was built from it")->required();
  app.add_option("--cuts", o.cuts, "cuts in the table, thresholds evenly in logarithms; 0 for none")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--from", o.from, "least threshold, a share of the diagonal")->check(CLI::PositiveNumber);
  app.add_option("--to", o.to, "largest threshold, a share of the diagonal")->check(CLI::PositiveNumber);
  app.add_option("--by", o.by, "the stored number that the table's cuts go by: selection or quadric")
      ->check(CLI::IsMember({"selection", "quadric"}));
  bench::add_numbers(app, "--max", o.at_max, "triangles at equal true maximum (1e-3,2e-3,5e-3; none)");
  bench::add_numbers(app, "--rms", o.at_rms, "triangles at equal true RMS (1e-4,3e-4,1e-3; none)");
  app.add_option("--drift", o.drift, "normals and UVs of all cuts, of those at equal deviation, of none")
      ->check(CLI::IsMember({"all", "equal", "none"}));
  app.add_option("--normals", o.normals,
                 "cuts at equal maximum must also keep normals within so many degrees RMS, the worse way");
  app.add_flag("--reference", o.with_reference, "OpenMesh's decimater (quadrics, whole mesh) at the same deviations");
  app.add_option("--samples", o.samples, bench::kSamplesHelp);
  app.add_option("--jobs", o.jobs, bench::kJobsHelp);
  app.add_option("--json", o.json, "write the figures there too");
  return bench::read_command_line(app, argc, argv);
}

/// One mesh with everything that its cuts are measured against.
class MeshBench {
 public:
  MeshBench(const scene::SourceMesh& source, const run::Asset& asset, std::span<const run::DecodedCluster> decoded,
            MeshId mesh, const Options& options)
      : asset_(asset),
        decoded_(decoded),
        mesh_(mesh),
        options_(options),
        source_(judge::surface_of_source(source)),
        shaded_(judge::shaded_surface_of_source(source)),
        judge_(source_, asset, decoded, mesh, options.samples) {}

  bench::MeshQuality run() {
    const format::MeshRecord& record = asset_.meshes()[mesh_.value];
    bench::MeshQuality out;
    out.name = std::string(asset_.string(record.name));
    out.diagonal = record.diagonal;
    out.source_triangles = record.source_triangles;
    out.tier = format::name_of(record.error_tier);
    if (!(record.diagonal > 0.0) || source_.triangles.empty()) return out;
    const run::CutError by = *value_in(run::kCutErrorNames, options_.by);
    for (int i = 0; i < options_.cuts; ++i) {
      const double share = options_.cuts > 1 ? static_cast<double>(i) / (options_.cuts - 1) : 0.0;
      const double threshold = options_.from * std::pow(options_.to / options_.from, share);
      const run::UniformCut cut = run::select_uniform(asset_, mesh_, threshold * record.diagonal, by);
      const judge::CutFigures figures = judge_.measure(cut.clusters);
      if (!out.cuts.empty() && out.cuts.back().figures.triangles == figures.triangles) continue;
      out.cuts.push_back(measured(threshold, cut, figures, options_.drift == "all"));
    }
    for (const double x : options_.at_max)
      out.equal.push_back(equal(run::CutError::kSelection, judge::Figure::kMax, x));
    for (const double x : options_.at_rms) {
      out.equal.push_back(equal(run::CutError::kSelection, judge::Figure::kRms, x));
      out.equal.push_back(equal(run::CutError::kQuadric, judge::Figure::kRms, x));
    }
    if (options_.with_reference) add_reference(out);
    return out;
  }

 private:
  /// One decimation from fine to coarse, measured at every step: a step is a tenth of the faces, so a count is that
  /// coarse.
  void add_reference(bench::MeshQuality& out) {
    constexpr double kStep = 0.9;
    const auto start = std::chrono::steady_clock::now();
    bench::ReferenceSimplifier reference(source_);
    out.notes.push_back("reference: OpenMesh decimater, quadric and normal flipping modules; left out before it: " +
                        std::to_string(reference.degenerate_count()) + " faces without area, refused by it: " +
                        std::to_string(reference.refused_count()) + " (complex edges or vertices)");
    std::vector<bench::EqualDeviation> wanted;
    for (const double x : options_.at_max) wanted.push_back({"openmesh", "max", x, {}, 0, 0, 0.0});
    for (const double x : options_.at_rms) wanted.push_back({"openmesh", "rms", x, {}, 0, 0, 0.0});
    bool goes_on = !wanted.empty();
    for (std::size_t steps = 1; goes_on; ++steps) {
      const auto faces =
          static_cast<std::size_t>(static_cast<double>(reference.face_count()) * (steps == 1 ? 0.5 : kStep));
      goes_on = reference.decimate_to(faces);
      const judge::CutFigures figures = judge_.measure(reference.surface());
      bool is_any_within = false;
      for (bench::EqualDeviation& one : wanted) {
        const double figure = (one.figure == "max" ? figures.max() : figures.rms()) / out.diagonal;
        one.cuts_measured = steps;
        // A figure may fall again, but not from far above.
        is_any_within = is_any_within || figure <= 2.0 * one.x;
        if (figure <= one.x) one.cut = bench::MeasuredCut{0.0, 0.0, figures, {}};
      }
      goes_on = goes_on && is_any_within && reference.face_count() > 16;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (bench::EqualDeviation& one : wanted) {
      one.seconds = seconds;
      out.equal.push_back(std::move(one));
    }
  }

  bench::MeasuredCut measured(double threshold, const run::UniformCut& cut, const judge::CutFigures& figures,
                              bool with_drift) {
    const double diagonal = asset_.meshes()[mesh_.value].diagonal;
    bench::MeasuredCut out{threshold, cut.stored_error / diagonal, figures, {}};
    if (with_drift) {
      const judge::DriftSurface surface(judge::shaded_surface_of_clusters(asset_, decoded_, mesh_, cut.clusters));
      // A seam may have moved sideways by as much as the surface has moved at all.
      out.drift = judge::measure_drift(
          shaded_, surface, {.samples = options_.samples, .tie = 1e-7 * diagonal, .seam_reach = figures.max()});
    }
    return out;
  }

  bench::EqualDeviation equal(run::CutError by, judge::Figure figure, double x) {
    const auto start = std::chrono::steady_clock::now();
    const double diagonal = asset_.meshes()[mesh_.value].diagonal;
    bench::EqualDeviation out{by == run::CutError::kQuadric ? "quadric cuts" : "cuts",
                              figure == judge::Figure::kMax ? "max" : "rms",
                              x,
                              {},
                              0,
                              0,
                              0.0};
    judge::CutSearch search{by, figure, x * diagonal};
    if (options_.normals > 0.0 && figure == judge::Figure::kMax) {
      search.accepts = [&](const run::UniformCut& cut, const judge::CutFigures& figures) {
        const bench::MeasuredCut one = measured(0.0, cut, figures, true);
        return one.drift && std::max(one.drift->normal_a_to_b.rms, one.drift->normal_b_to_a.rms) <= options_.normals;
      };
    }
    const auto found = judge::find_fewest_triangles(judge_, asset_, mesh_, search);
    if (found) {
      out.cut = measured(found->threshold / diagonal, found->cut, found->figures, options_.drift != "none");
      out.cuts_measured = found->cuts_measured;
      out.cuts_of_mesh = found->cuts_of_mesh;
    }
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
  }

  const run::Asset& asset_;
  std::span<const run::DecodedCluster> decoded_;
  MeshId mesh_;
  const Options& options_;
  judge::Surface source_;
  judge::DriftSurface shaded_;
  judge::CutJudge judge_;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (const std::optional<int> exit_code = read_options(argc, argv, options)) return *exit_code;
  if (!(options.to >= options.from)) {
    std::fputs("--to is less than --from\n", stderr);
    return 1;
  }
  const bench::ThreadLimit limit(options.jobs);
  const Result<scene::Scene> scene = scene::import_scene(options.scene, {});
  const Result<run::Asset> asset = run::Asset::open(options.asset);
  if (!scene || !asset) {
    std::fprintf(stderr, "%s\n", (!scene ? scene.error() : asset.error()).message().c_str());
    return 2;
  }
  if (scene->meshes.size() != asset->meshes().size()) {
    std::fputs("the scene and the asset have different numbers of meshes\n", stderr);
    return 2;
  }
  const Result<std::vector<run::DecodedCluster>> decoded = run::decode_all(*asset);
  if (!decoded) {
    std::fprintf(stderr, "%s\n", decoded.error().message().c_str());
    return 3;
  }
  std::vector<bench::MeshQuality> meshes;
  for (std::uint32_t m = 0; m < asset->meshes().size(); ++m) {
    MeshBench bench(scene->meshes[m], *asset, *decoded, MeshId(m), options);
    meshes.push_back(bench.run());
    std::fputs(bench::quality_text(meshes.back()).c_str(), stdout);
    std::fflush(stdout);
  }
  if (!options.json.empty()) {
    std::ofstream file(options.json, std::ios::binary);
    file << bench::quality_json(std::filesystem::path(options.scene).filename().string(),
                                std::filesystem::path(options.asset).filename().string(), meshes);
    if (!file.flush()) {
      std::fprintf(stderr, "%s: cannot be written\n", options.json.c_str());
      return 2;
    }
  }
  return 0;
}
