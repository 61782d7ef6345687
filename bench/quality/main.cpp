// SPDX-License-Identifier: GPL-3.0-or-later
// Quality: uniform cuts of an asset against its source. For each threshold: triangles, true maximum and RMS deviation
// (both ways, share of the diagonal), stored error, and true over stored. Then triangles at equal deviation.
//
//   bench_quality SCENE.glb ASSET.lode [--cuts N] [--samples N] [--from T] [--to T] [--by selection|quadric]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "decode/decode.h"
#include "import/import.h"
#include "metrics/metrics.h"
#include "select/select.h"

namespace {

using namespace meshlode;

struct Options {
  std::string scene, asset;
  int cuts = 24;
  std::uint64_t samples = 200000;
  double from = 1e-4, to = 2e-2;
  CutError by = CutError::kSelection;
};

struct Row {
  double threshold = 0.0, max = 0.0, rms = 0.0, stored = 0.0;
  std::size_t triangles = 0;
};

Surface surface_of_source(const SourceMesh& mesh) {
  Surface surface;
  for (const Primitive& primitive : mesh.primitives) {
    const auto base = static_cast<std::uint32_t>(surface.positions.size());
    surface.positions.insert(surface.positions.end(), primitive.positions.begin(), primitive.positions.end());
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      surface.triangles.push_back(
          {base + primitive.indices[i], base + primitive.indices[i + 1], base + primitive.indices[i + 2]});
    }
  }
  return surface;
}

/// The fewest triangles over all cuts whose figure is at most x; between two cuts, interpolated in logarithms.
double triangles_at(const std::vector<Row>& rows, double Row::*figure, double x) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].*figure <= x) best = std::min(best, static_cast<double>(rows[i].triangles));
    if (i + 1 < rows.size() && rows[i].*figure <= x && rows[i + 1].*figure > x && rows[i].*figure > 0.0) {
      const double t = std::log(x / (rows[i].*figure)) / std::log(rows[i + 1].*figure / (rows[i].*figure));
      const double a = std::log(static_cast<double>(rows[i].triangles));
      const double b = std::log(static_cast<double>(rows[i + 1].triangles));
      best = std::min(best, std::exp(a + t * (b - a)));
    }
  }
  return best;
}

bool parse(int argc, char** argv, Options& options) {
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0) {
      files.push_back(word);
      continue;
    }
    if (i + 1 >= argc) return false;
    const char* value = argv[++i];
    if (word == "--cuts") {
      options.cuts = std::atoi(value);
    } else if (word == "--samples") {
      options.samples = std::strtoull(value, nullptr, 10);
    } else if (word == "--from") {
      options.from = std::atof(value);
    } else if (word == "--to") {
      options.to = std::atof(value);
    } else if (word == "--by") {
      options.by = std::strcmp(value, "quadric") == 0 ? CutError::kQuadric : CutError::kSelection;
    } else {
      return false;
    }
  }
  if (files.size() != 2 || options.cuts < 2) return false;
  options.scene = files[0];
  options.asset = files[1];
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::fputs("usage: bench_quality SCENE ASSET [--cuts N] [--samples N] [--from T] [--to T] [--by selection|quadric]\n",
               stderr);
    return 1;
  }
  const Result<Scene> scene = import_scene(options.scene, {});
  const Result<Asset> asset = Asset::open(options.asset);
  if (!scene || !asset) {
    std::fprintf(stderr, "%s\n", (!scene ? scene.error() : asset.error()).message().c_str());
    return 2;
  }
  const Result<std::vector<DecodedCluster>> decoded = decode_all(*asset);
  if (!decoded) {
    std::fprintf(stderr, "%s\n", decoded.error().message().c_str());
    return 3;
  }
  for (std::uint32_t m = 0; m < asset->meshes().size(); ++m) {
    const double diagonal = asset->meshes()[m].diagonal;
    const Surface source = surface_of_source(scene->meshes[m]);
    std::vector<Row> rows;
    for (int i = 0; i < options.cuts; ++i) {
      Row row;
      row.threshold = options.from * std::pow(options.to / options.from, static_cast<double>(i) / (options.cuts - 1));
      const UniformCut cut = select_uniform(*asset, MeshId(m), row.threshold * diagonal, options.by);
      const Surface surface = surface_of_clusters(*asset, *decoded, MeshId(m), cut.clusters);
      if (!rows.empty() && rows.back().triangles == surface.triangles.size()) continue;
      const DeviationReport report = measure_deviation(source, surface, {.samples = options.samples});
      row.triangles = surface.triangles.size();
      row.max = report.max() / diagonal;
      row.rms = report.rms() / diagonal;
      row.stored = cut.stored_error / diagonal;
      rows.push_back(row);
      std::printf("mesh %u  T %.3e  triangles %8zu  max %.3e (fwd %.2e back %.2e)  rms %.3e  stored %.3e  true/stored %.3f\n",
                  m, row.threshold, row.triangles, row.max, report.a_to_b.max / diagonal, report.b_to_a.max / diagonal,
                  row.rms, row.stored, row.max / row.stored);
      std::fflush(stdout);
    }
    std::printf("mesh %u  triangles at max   1e-3: %.0f   2e-3: %.0f   5e-3: %.0f\n", m, triangles_at(rows, &Row::max, 1e-3),
                triangles_at(rows, &Row::max, 2e-3), triangles_at(rows, &Row::max, 5e-3));
    std::printf("mesh %u  triangles at rms   1e-4: %.0f   3e-4: %.0f   1e-3: %.0f\n", m, triangles_at(rows, &Row::rms, 1e-4),
                triangles_at(rows, &Row::rms, 3e-4), triangles_at(rows, &Row::rms, 1e-3));
    std::vector<double> ratios;
    for (const Row& row : rows) ratios.push_back(row.max / row.stored);
    std::sort(ratios.begin(), ratios.end());
    if (!ratios.empty()) {
      std::printf("mesh %u  true/stored: median %.3f  worst %.3f over %zu cuts\n", m, ratios[ratios.size() / 2], ratios.back(),
                  ratios.size());
    }
  }
  return 0;
}
