// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/coverage_rule.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "run/select/select.h"

namespace meshlode::judge {

namespace {

// What is beyond the limits by less than this many times may be luck of the samples, and is looked at with so many
// times as many. What is further off needs no second look, which takes longer.
constexpr double kMostLuck = 2.0, kCloser = 8.0;

bool is_within(const CoverageDrift& drift, double times = 1.0) {
  return drift.rms <= times * kMostCoverageRms && std::abs(drift.mean) <= times * kMostCoverageMean &&
         drift.contrast <= times * kMostCoverageContrast;
}

}  // namespace

CoverageTotals check_coverage(const run::Asset& asset, std::uint32_t sizes, RuleLog& log) {
  CoverageTotals totals;
  const draw::AlphaMasks masks = draw::load_alpha_masks(asset);
  const auto triangles_at = [&](std::uint32_t mesh, double size) {
    const std::vector<ClusterId> drawn = run::select_uniform(asset, MeshId(mesh), size).clusters;
    return covering_triangles(asset, masks, MeshId(mesh), clusters_of_aggregates(asset, drawn));
  };
  for (std::uint32_t m = 0; m < asset.meshes().size(); ++m) {
    if (!has_aggregates(asset, MeshId(m))) continue;
    const auto source = triangles_at(m, -1.0);
    if (!source) {
      log.add(Rule::kL204, source.error().where, source.error().detail);
      continue;
    }
    for (const double size : coverage_sizes(asset, MeshId(m), sizes)) {
      const auto cut = triangles_at(m, size);
      if (!cut) {
        log.add(Rule::kL204, cut.error().where, cut.error().detail);
        break;
      }
      std::optional<CoverageDrift> drift = measure_coverage(*source, *cut, masks, size);
      if (!drift) continue;
      if (!is_within(*drift) && is_within(*drift, kMostLuck)) {
        if (const auto closer = measure_coverage(*source, *cut, masks, size, kCloser)) drift = closer;
      }
      ++totals.cuts;
      totals.rms = std::max(totals.rms, drift->rms);
      totals.mean = std::max(totals.mean, std::abs(drift->mean));
      totals.contrast = std::max(totals.contrast, drift->contrast);
      totals.worst_direction = std::max(totals.worst_direction, drift->worst_direction);
      log.expect(
          is_within(*drift), Rule::kV208, [&] { return place("mesh", m); },
          [&] {
            char text[200];
            std::snprintf(
                text, sizeof text,
                "the cut at pixel size %.6g covers %+.2f%%, pixels differ by %.3f of what they have, contrast %.3f",
                size, 100.0 * drift->mean, drift->rms, drift->contrast);
            return std::string(text);
          });
    }
  }
  return totals;
}

}  // namespace meshlode::judge
