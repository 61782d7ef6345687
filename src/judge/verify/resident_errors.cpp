// SPDX-License-Identifier: GPL-3.0-or-later
// Is a cut of resident pages off by no more than it shows? Its error is the largest that a drawn cluster was made with;
// the surface that it deviates from is level 0 of the same asset, so that no source is needed.
#include <algorithm>
#include <cstdio>

#include "judge/metrics/metrics.h"
#include "judge/verify/deviations.h"
#include "judge/verify/resident_cuts.h"

namespace meshlode::judge {

namespace {

/// Each way, beside all vertices: where a cut is off most is at vertices, of one surface or the other.
constexpr std::uint64_t kShownSamples = 20000;

bool promises_errors(const run::Asset& asset, const format::MeshRecord& mesh) {
  const auto groups = asset.groups().subspan(mesh.first_group, mesh.group_count);
  return mesh.error_tier != format::ErrorTier::kQem &&
         std::none_of(groups.begin(), groups.end(),
                      [](const format::GroupRecord& group) { return (group.flags & format::kGroupAggregate) != 0; });
}

}  // namespace

std::string describe(const ShownErrors& errors) {
  if (errors.cuts == 0) return "not checked: no cut of resident pages was measured, or its tier promises nothing";
  char text[100];
  std::snprintf(text, sizeof text, "cuts of resident pages are off by no more than they show, at most %.3f of it",
                errors.largest_ratio);
  return text;
}

ShownErrors check_shown_errors(const run::Asset& asset, std::span<const run::DecodedCluster> decoded,
                               std::span<const SampledCut> cuts, RuleLog& log) {
  ShownErrors out;
  for (std::uint32_t m = 0; m < asset.meshes().size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    const auto is_own = [&](const SampledCut& cut) { return cut.mesh.value == m; };
    if (std::none_of(cuts.begin(), cuts.end(), is_own) || !promises_errors(asset, mesh)) continue;
    std::vector<ClusterId> level0;
    for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
      if (asset.clusters()[c].own_group == format::kNone) level0.emplace_back(c);
    }
    const Surface finest = surface_of_clusters(asset, decoded, MeshId(m), level0);
    const DeviationFrom from(finest, {.samples = kShownSamples});
    const double shortfall = mesh.error_tier == format::ErrorTier::kMeasured ? kMeasuredShortfall : 0.0;
    for (const SampledCut& cut : cuts) {
      if (!is_own(cut)) continue;
      double shown = 0.0;
      for (const ClusterId cluster : cut.clusters) {
        const std::uint32_t own = asset.clusters()[cluster.value].own_group;
        if (own != format::kNone) shown = std::max(shown, double{asset.groups()[own].error});
      }
      const double deviation = from.measure(surface_of_clusters(asset, decoded, MeshId(m), cut.clusters)).max();
      const double allowed = shown * (1.0 + shortfall) + mesh.level0_deviation + position_rounding(mesh);
      log.expect(
          deviation <= allowed, Rule::kV212, [&] { return place("camera", cut.camera) + ", " + place("mesh", m); },
          [&] { return differs("the cut deviates from level 0 by", deviation, "and shows an error of", shown); });
      if (shown > 0.0) out.largest_ratio = std::max(out.largest_ratio, deviation / shown);
      ++out.cuts;
    }
  }
  return out;
}

}  // namespace meshlode::judge
