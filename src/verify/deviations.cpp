// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/deviations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "metrics/metrics.h"
#include "select/select.h"

namespace meshlode {

namespace {

/// Errors to cut at: from the smallest positive to the largest finite one, evenly in the logarithm.
std::vector<double> thresholds_of(const Asset& asset, const format::MeshRecord& mesh, std::uint32_t count) {
  float low = format::kInfiniteError;
  float high = 0.0F;
  for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
    const float error = asset.groups()[g].error;
    if (error >= format::kInfiniteError || !(error > 0.0F)) continue;
    low = std::min(low, error);
    high = std::max(high, error);
  }
  std::vector<double> thresholds;
  if (!(high > 0.0F)) return thresholds;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = count < 2 ? 1.0 : static_cast<double>(i) / (count - 1);
    thresholds.push_back(double{low} * std::pow(double{high} / low, t) * (1.0 + 1e-12));
  }
  return thresholds;
}

}  // namespace

DeviationTotals check_deviations(const Asset& asset, const Scene& source, std::span<const DecodedCluster> clusters,
                                 std::uint32_t cuts, std::uint64_t samples, RuleLog& log) {
  DeviationTotals totals;
  std::vector<double> ratios;
  for (std::uint32_t m = 0; m < std::min(asset.meshes().size(), source.meshes.size()); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    if (mesh.error_tier == format::ErrorTier::kQem) continue;
    const bool is_certified = mesh.error_tier == format::ErrorTier::kCertified;
    const double limit = is_certified ? 1.0 : 1.0 + kMeasuredShortfall;
    const Surface truth = surface_of_source(source.meshes[m]);
    std::vector<ClusterId> previous;
    for (const double threshold : thresholds_of(asset, mesh, cuts)) {
      const UniformCut cut = select_uniform(asset, MeshId(m), threshold);
      if (cut.clusters == previous) continue;
      previous = cut.clusters;
      const Surface surface = surface_of_clusters(asset, clusters, MeshId(m), cut.clusters);
      const double deviation = measure_deviation(truth, surface, {.samples = samples}).max();
      // Decoded positions carry the last bit of a double; a flat cut deviates by that and stores 0.
      const double rounding = 1e-12 * mesh.diagonal;
      const double ratio =
          cut.stored_error > 0.0 ? deviation / cut.stored_error : (deviation <= rounding ? 0.0 : HUGE_VAL);
      ratios.push_back(ratio);
      ++totals.cuts;
      if (deviation > cut.stored_error + rounding) ++totals.exceeded;
      log.expect(
          deviation <= limit * cut.stored_error + rounding, "V206", [&] { return place("mesh", m); },
          [&] {
            char text[160];
            std::snprintf(text, sizeof text, "the cut at error %.6g stores %.6g and deviates by %.6g, %.3f times that",
                          threshold, cut.stored_error, deviation, ratio);
            return std::string(text);
          });
    }
  }
  std::sort(ratios.begin(), ratios.end());
  if (!ratios.empty()) {
    totals.worst = ratios.back();
    totals.median = ratios[ratios.size() / 2];
  }
  return totals;
}

}  // namespace meshlode
