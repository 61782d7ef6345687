// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/source_measure.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "app/report/info.h"
#include "base/hash.h"
#include "base/try.h"
#include "judge/metrics/attribute_drift.h"
#include "judge/metrics/cut_judge.h"
#include "judge/metrics/cut_search.h"
#include "judge/verify/source_parts.h"
#include "lab/sweep/metrics.h"
#include "run/decode/decode.h"

namespace meshlode::lab {

namespace {

/// Thresholds of the cuts that stored and measured errors are compared at, shares of the diagonal. Attributes are
/// measured of the first, the finest cut: they take as long as the rest together.
constexpr std::array<double, 5> kThresholds{0.0, 3e-4, 1e-3, 3e-3, 1e-2};

/// Largest deviations that the fewest triangles are looked for at.
constexpr std::array<double, 3> kEqualMax{3e-4, kAtMax, 3e-3};

void raise(std::optional<double>& worst, double value) {
  worst = std::max(worst.value_or(0.0), value);
}

void raise(std::map<std::string, double>& figures, const char* key, double value) {
  const auto [at, is_new] = figures.try_emplace(key, value);
  if (!is_new) at->second = std::max(at->second, value);
}

/// One mesh, its figures added to those of the meshes before.
class MeshMeasure {
 public:
  MeshMeasure(const std::shared_ptr<const judge::CutSource>& source, const judge::DriftSurface& shaded,
              const run::Asset& asset, std::span<const run::DecodedCluster> decoded, MeshId mesh)
      : asset_(asset),
        decoded_(decoded),
        mesh_(mesh),
        samples_(source->samples),
        diagonal_(asset.meshes()[mesh.value].diagonal),
        shaded_(shaded),
        judge_(source, asset, decoded, mesh) {}

  void add(Measurement& out) {
    for (std::size_t i = 0; i < kThresholds.size(); ++i) add_cut(kThresholds[i], out.cuts[i], out.figures);
    for (EqualRow& row : out.equal) add_equal(row);
  }

 private:
  void add_cut(double threshold, CutRow& row, std::map<std::string, double>& figures) {
    const run::UniformCut cut = run::select_uniform(asset_, mesh_, threshold * diagonal_);
    const judge::CutFigures measured = judge_.measure(cut.clusters);
    row.triangles += measured.triangles;
    row.stored = std::max(row.stored, cut.stored_error / diagonal_);
    row.max = std::max(row.max, measured.max() / diagonal_);
    row.rms = std::max(row.rms, measured.rms() / diagonal_);
    if (threshold > 0.0) return;
    raise(figures, "deviation", measured.max() / diagonal_);
    raise(figures, "deviation_rms", measured.rms() / diagonal_);
    const judge::DriftSurface surface(judge::shaded_surface_of_clusters(asset_, decoded_, mesh_, cut.clusters));
    // A layer beside another, and a chart beside its neighbour, may have moved by as much as the surface has at all.
    const double moved = std::max(measured.max(), double{asset_.meshes()[mesh_.value].level0_deviation});
    const judge::DriftReport drift =
        judge::measure_drift(shaded_, surface, {.samples = samples_, .tie = 1e-7 * diagonal_, .side_reach = moved});
    if (drift.has_normals()) {
      raise(row.normal, std::max(drift.normal_a_to_b.rms, drift.normal_b_to_a.rms));
      raise(figures, "normal_rms", std::max(drift.normal_a_to_b.rms, drift.normal_b_to_a.rms));
      raise(figures, "normal_max", std::max(drift.normal_a_to_b.max, drift.normal_b_to_a.max));
    }
    if (drift.has_uvs()) {
      raise(row.uv, std::max(drift.uv_a_to_b.rms, drift.uv_b_to_a.rms));
      raise(figures, "uv_rms", std::max(drift.uv_a_to_b.rms, drift.uv_b_to_a.rms));
      raise(figures, "uv_max", std::max(drift.uv_a_to_b.max, drift.uv_b_to_a.max));
    }
  }

  void add_equal(EqualRow& row) {
    if (!row.triangles) return;  // a mesh before has none
    judge::CutSearch search;
    search.figure = row.figure == "max" ? judge::Figure::kMax : judge::Figure::kRms;
    search.x = row.x * diagonal_;
    const auto found = judge::find_fewest_triangles(judge_, asset_, mesh_, search);
    if (!found) {
      row.triangles = std::nullopt;
      row.threshold = std::nullopt;
      return;
    }
    row.triangles = *row.triangles + found->figures.triangles;
    raise(row.threshold, found->threshold / diagonal_);
  }

  const run::Asset& asset_;
  std::span<const run::DecodedCluster> decoded_;
  MeshId mesh_;
  std::uint64_t samples_;
  double diagonal_;
  const judge::DriftSurface& shaded_;
  judge::CutJudge judge_;
};

AssetFacts facts_of(const run::Asset& asset, const app::AssetInfo& info) {
  AssetFacts facts;
  facts.content_hash = content_hash_of(asset);
  facts.settings = info.meta.settings;
  facts.clusters = asset.clusters().size();
  facts.groups = asset.groups().size();
  facts.levels = info.levels;
  facts.stuck_groups = info.stuck_groups;
  facts.stored_triangles = info.stored_triangles;
  facts.stored_vertices = info.stored_vertices;
  for (const app::MeshInfo& mesh : info.meshes) {
    for (const app::LevelInfo& level : mesh.levels) {
      if (facts.level_triangles.size() <= level.level) facts.level_triangles.resize(std::size_t{level.level} + 1, 0);
      facts.level_triangles[level.level] += level.triangles;
    }
  }
  for (const format::SectionEntry& section : asset.sections()) {
    facts.sections.push_back(
        {app::section_name(section.id), section.bytes, app::section_decoded_bytes(asset, section)});
  }
  return facts;
}

}  // namespace

struct SourceMeasure::Mesh {
  std::shared_ptr<const judge::CutSource> source;
  judge::DriftSurface shaded;
};

SourceMeasure::SourceMeasure(const scene::Scene& source, std::uint64_t samples, Searches searches)
    : source_(source), samples_(samples), searches_(searches), meshes_(source.meshes.size()) {}
SourceMeasure::~SourceMeasure() = default;
SourceMeasure::SourceMeasure(SourceMeasure&&) noexcept = default;

std::string content_hash_of(const run::Asset& asset) {
  Hash128 hash{};
  std::copy_n(asset.header().content_hash, hash.size(), hash.begin());
  return to_hex(hash);
}

void describe_sizes(const run::Asset& asset, Measurement& out) {
  const app::AssetInfo info = app::describe_asset(asset);
  out.asset = facts_of(asset, info);
  out.figures["file_bytes"] = static_cast<double>(asset.bytes().size());
  out.figures["geometry_bytes"] = static_cast<double>(info.geometry_bytes);
  std::uint64_t pages = 0;
  for (const format::PageRecord& page : asset.pages()) pages += page.bytes;
  out.figures["decoded_bytes"] = static_cast<double>(pages);
}

void take_content_figures(const Measurement& from, Measurement& out) {
  out.cuts = from.cuts;
  out.equal = from.equal;
  for (const Metric& metric : all_metrics()) {
    const auto found = from.figures.find(metric.key);
    const std::string_view group = metric.group;
    if (found != from.figures.end() && (group == "accuracy" || group == "triangles")) out.figures.insert(*found);
  }
}

Status SourceMeasure::measure(const run::Asset& asset, Measurement& out) {
  if (const std::optional<scene::Scene> split = judge::split_source(asset, source_)) {
    return SourceMeasure(*split, samples_, searches_).measure(asset, out);
  }
  if (source_.meshes.size() != asset.meshes().size()) {
    return Error{ErrorCode::kInvalid, "", "the scene and the asset have different numbers of meshes"};
  }
  TRY_LET(decoded, run::decode_all(asset));
  describe_sizes(asset, out);
  for (const double threshold : kThresholds) out.cuts.push_back({threshold, 0, 0.0, 0.0, 0.0, {}, {}});
  for (const double x : kEqualMax) {
    if (searches_ == Searches::kAll || x == kAtMax) out.equal.push_back({"max", x, 0, std::nullopt});
  }
  if (searches_ == Searches::kAll) out.equal.push_back({"rms", kAtRms, 0, std::nullopt});
  bool is_any_measured = false;
  for (std::uint32_t m = 0; m < asset.meshes().size(); ++m) {
    if (!meshes_[m]) {
      const scene::SourceMesh& source = source_.meshes[m];
      meshes_[m] = std::make_unique<Mesh>(
          Mesh{std::make_shared<const judge::CutSource>(judge::surface_of_source(source), samples_),
               judge::DriftSurface(judge::shaded_surface_of_source(source))});
    }
    // A mesh without extent has nothing that a share of it could say.
    const Mesh& mesh = *meshes_[m];
    if (!(asset.meshes()[m].diagonal > 0.0) || mesh.source->points.empty()) continue;
    MeshMeasure(mesh.source, mesh.shaded, asset, *decoded, MeshId(m)).add(out);
    is_any_measured = true;
  }
  if (!is_any_measured) {
    out.cuts.clear();
    out.equal.clear();
  }
  for (const EqualRow& row : out.equal) {
    const bool is_figure = row.x == (row.figure == "max" ? kAtMax : kAtRms);
    if (row.triangles && is_figure) out.figures["triangles_at_" + row.figure] = static_cast<double>(*row.triangles);
  }
  return Ok{};
}

}  // namespace meshlode::lab
