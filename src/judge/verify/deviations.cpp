// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/deviations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "judge/metrics/coverage.h"
#include "run/select/select.h"

namespace meshlode::judge {

std::vector<double> spread_thresholds(std::span<const format::GroupRecord> groups, std::uint32_t count) {
  float low = format::kInfiniteError;
  float high = 0.0F;
  bool any_zero = false;
  for (const format::GroupRecord& group : groups) {
    if (group.error == 0.0F) any_zero = true;
    if (group.error >= format::kInfiniteError || !(group.error > 0.0F)) continue;
    low = std::min(low, group.error);
    high = std::max(high, group.error);
  }
  std::vector<double> thresholds;
  if (any_zero && (count > 1 || (count == 1 && !(high > 0.0F)))) thresholds.push_back(0.0);
  if (!(high > 0.0F)) return thresholds;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = count < 2 ? 0.5 : static_cast<double>(i) / (count - 1);
    thresholds.push_back(double{low} * std::pow(double{high} / low, t) * (1.0 + 1e-12));
  }
  return thresholds;
}

double position_rounding(const format::MeshRecord& mesh) {
  const double farthest = std::max({std::abs(mesh.origin[0]), std::abs(mesh.origin[1]), std::abs(mesh.origin[2])});
  return 1e-12 * mesh.diagonal + 0x1p-51 * (farthest + mesh.diagonal);
}

void summarize(std::vector<double> ratios, DeviationTotals& totals) {
  if (ratios.empty()) return;
  std::sort(ratios.begin(), ratios.end());
  totals.worst = ratios.back();
  totals.median = ratios[ratios.size() / 2];
}

Result<std::vector<CutDeviation>> measure_cuts(const run::Asset& asset, MeshId mesh, const scene::SourceMesh& source,
                                               std::uint32_t cuts, std::uint64_t samples) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const Surface truth = surface_of_source(source);
  const DeviationFrom from_truth(truth, {.samples = samples});
  std::vector<CutDeviation> measured;
  std::vector<ClusterId> previous;
  for (const double threshold :
       spread_thresholds(asset.groups().subspan(record.first_group, record.group_count), cuts)) {
    const run::UniformCut cut = run::select_uniform(asset, mesh, threshold);
    if (cut.clusters == previous) continue;
    previous = cut.clusters;
    const Result<Surface> surface = surface_of_clusters(asset, mesh, cut.clusters);
    if (!surface) return surface.error();
    measured.push_back({threshold, cut.stored_error, from_truth.find_largest(*surface), position_rounding(record)});
  }
  return measured;
}

DeviationTotals check_deviations(const run::Asset& asset, const scene::Scene& source, std::uint32_t cuts,
                                 std::uint64_t samples, RuleLog& log) {
  DeviationTotals totals;
  std::vector<double> ratios;
  for (std::uint32_t m = 0; m < std::min(asset.meshes().size(), source.meshes.size()); ++m) {
    const format::ErrorTier tier = asset.meshes()[m].error_tier;
    if (tier == format::ErrorTier::kQem || has_aggregates(asset, MeshId(m))) continue;
    const double limit = tier == format::ErrorTier::kCertified ? 1.0 : 1.0 + kMeasuredShortfall;
    const auto measured = measure_cuts(asset, MeshId(m), source.meshes[m], cuts, samples);
    if (!measured) {
      log.add(Rule::kL204, measured.error().where, measured.error().detail);
      continue;
    }
    for (const CutDeviation& cut : *measured) {
      ratios.push_back(cut.ratio());
      ++totals.cuts;
      if (cut.is_above(1.0)) ++totals.exceeded;
      log.expect(
          !cut.is_above(limit), Rule::kV206, [&] { return place("mesh", m); },
          [&] {
            char text[160];
            std::snprintf(text, sizeof text, "the cut at error %.6g stores %.6g and deviates by %.6g, %.3f times that",
                          cut.threshold, cut.stored, cut.truth.max, cut.ratio());
            return std::string(text);
          });
    }
  }
  summarize(std::move(ratios), totals);
  return totals;
}

}  // namespace meshlode::judge
