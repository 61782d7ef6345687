// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts of resident pages (V212): random cameras, and for each random pages that are resident. Internal to the judge.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "judge/validate/rules.h"
#include "judge/verify/cuts.h"
#include "run/select/resident.h"

namespace meshlode::judge {

struct ResidentCut {
  std::vector<run::ClusterInstance> items;
  std::vector<run::PageRequest> requests;
};
/// What is judged, so that a test may put something wrong in its place: made once for tables, then asked.
using ResidentSelection = std::function<ResidentCut(const run::SelectTables&, const run::ResidentQuery&)>;
[[nodiscard]] ResidentSelection make_resident_selection(const run::SelectTables& tables);

/// A cut of one mesh, of which errors are measured.
struct SampledCut {
  std::uint64_t camera = 0;
  MeshId mesh;
  std::vector<ClusterId> clusters;
};
constexpr std::size_t kSampledCuts = 4;

struct ResidentTotals {
  std::uint64_t cameras = 0;
  std::uint64_t residencies = 0;    ///< of one instance, with the pages of its roots
  std::uint64_t others = 0;         ///< without these pages, of all instances, or of all pages
  std::uint64_t naive_open = 0;     ///< of `residencies`: a rule that looks at a group's own page alone opens the cut
  std::uint64_t borders = 0;        ///< cuts whose border was held against the source's, edge by edge
  std::uint64_t requests = 0;       ///< pages, of all queries
  std::vector<SampledCut> samples;  ///< of the first cameras that draw something coarser than level 0, whole
};

/// `count` random residencies, up to kResidenciesPerCamera for each of as many cameras. `judges` has one entry per
/// mesh.
ResidentTotals check_resident_cuts(
    const run::Asset& asset, std::span<const MeshJudge> judges, std::uint32_t count, std::uint64_t seed, RuleLog& log,
    const std::function<ResidentSelection(const run::SelectTables&)>& make_selection = make_resident_selection);

struct ShownErrors {
  std::uint64_t cuts = 0;      ///< measured
  double largest_ratio = 0.0;  ///< deviation from level 0 over the largest error that a cut shows, of all cuts
};
/// One line each: what was checked, or why nothing was.
[[nodiscard]] std::string describe(const ResidentTotals& totals);
[[nodiscard]] std::string describe(const ShownErrors& errors);
/// Adds V212 where a cut deviates from level 0, either way, by more than the largest error of what it draws and level
/// 0's own. Not of meshes whose errors are estimates (tier qem) or that have an aggregate. `decoded`: all clusters.
ShownErrors check_shown_errors(const run::Asset& asset, std::span<const run::DecodedCluster> decoded,
                               std::span<const SampledCut> cuts, RuleLog& log);

/// So many share what a camera costs: two cuts of all instances, and the rule for each group.
constexpr std::uint32_t kResidenciesPerCamera = 50;

}  // namespace meshlode::judge
