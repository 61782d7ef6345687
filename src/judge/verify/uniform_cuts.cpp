// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "judge/verify/cuts.h"

namespace meshlode::judge {

std::vector<float> finite_group_errors(const run::Asset& asset, const MeshSurface& surface) {
  std::vector<float> errors;
  for (std::uint32_t k = 0; k < surface.group_count; ++k) {
    const float error = asset.groups()[surface.first_group + k].error;
    if (error < format::kInfiniteError) errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  errors.erase(std::unique(errors.begin(), errors.end()), errors.end());
  return errors;
}

namespace {

/// Half at exact errors (evenly by rank), a quarter just below them, a quarter evenly in the logarithm; 0 first.
std::vector<double> choose_thresholds(const run::Asset& asset, const MeshSurface& surface, std::uint32_t count) {
  const std::vector<float> errors = finite_group_errors(asset, surface);
  std::vector<double> thresholds{0.0};
  if (errors.empty()) return thresholds;
  const std::uint32_t at = count / 2;
  const std::uint32_t below = count / 4;
  const auto pick = [&](std::uint32_t i, std::uint32_t n) {
    return errors[n < 2 ? errors.size() - 1 : std::size_t{i} * (errors.size() - 1) / (n - 1)];
  };
  for (std::uint32_t i = 0; i < at; ++i) thresholds.push_back(pick(i, at));
  for (std::uint32_t i = 0; i < below; ++i) thresholds.push_back(std::nextafter(pick(i, below), 0.0F));
  const float* positive = std::upper_bound(errors.data(), errors.data() + errors.size(), 0.0F);
  if (positive != errors.data() + errors.size()) {
    const double low = std::log(double{*positive} * 0.5);
    const double high = std::log(double{errors.back()} * 2.0);
    const std::uint32_t n = count > at + below + 1 ? count - at - below - 1 : 0;
    for (std::uint32_t i = 0; i < n; ++i) thresholds.push_back(std::exp(low + (high - low) * (i + 0.5) / n));
  }
  return thresholds;
}

CutFaults judge_uniform_cut(const run::Asset& asset, const MeshJudge& judge, double threshold,
                            const Selectors& selectors) {
  const MeshSurface& surface = judge.surface;
  const format::MeshRecord& mesh = asset.meshes()[surface.mesh.value];
  CutFaults faults;
  const run::UniformCut cut = selectors.uniform(asset, surface.mesh, threshold);
  std::vector<std::uint8_t> drawn(surface.cluster_count, 0);
  double error = mesh.level0_deviation;
  for (const ClusterId id : cut.clusters) {
    if (id.value < surface.first_cluster || id.value - surface.first_cluster >= surface.cluster_count) {
      faults.rule = place("cluster", id.value) + " is not of the mesh";
      return faults;
    }
    ++drawn[id.value - surface.first_cluster];
  }
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[surface.first_cluster + c];
    const auto passes = [&](std::uint32_t g) {
      const float e = asset.groups()[g].error;
      return e < format::kInfiniteError && double{e} <= threshold;
    };
    const bool is_level0 = cluster.own_group == format::kNone;
    const bool should = (is_level0 || passes(cluster.own_group)) && !passes(cluster.coarser_group);
    if (drawn[c] != (should ? 1 : 0))
      faults.rule = place("cluster", surface.first_cluster + c) + (should ? " is not drawn" : " is drawn");
    if (should && !is_level0) error = std::max(error, double{asset.groups()[cluster.own_group].error});
  }
  if (cut.stored_error != error) faults.error = differs("stored error", cut.stored_error, "largest selected", error);
  if (cut.clusters.empty() && surface.cluster_count > 0) faults.coverage = "the cut is empty";
  if (faults.coverage.empty()) faults.coverage = find_coverage_fault(asset, judge, drawn);
  faults.border = find_border_fault(judge, drawn);
  return faults;
}

}  // namespace

CutTotals check_uniform_cuts(const run::Asset& asset, const MeshJudge& judge, std::uint32_t count, RuleLog& log,
                             const Selectors& selectors) {
  for (const Rule rule : {Rule::kV201, Rule::kV202, Rule::kV204, Rule::kV205}) log.check(rule);
  CutTotals totals;
  if (count == 0 || judge.surface.cluster_count == 0) return totals;
  const std::vector<double> thresholds = choose_thresholds(asset, judge.surface, count);
  std::vector<CutFaults> faults(thresholds.size());
  parallel_for_each_index(thresholds.size(), 4, [&](std::size_t i) {
    faults[i] = judge_uniform_cut(asset, judge, thresholds[i], selectors);
  });
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const auto report = [&](Rule rule, const std::string& fault) {
      if (fault.empty()) return;
      char text[48];
      std::snprintf(text, sizeof text, ", uniform cut at %.9g", thresholds[i]);
      log.add(rule, place("mesh", judge.surface.mesh.value) + text, fault);
    };
    report(Rule::kV201, faults[i].coverage);
    report(Rule::kV202, faults[i].border);
    report(Rule::kV204, faults[i].rule);
    report(Rule::kV205, faults[i].error);
  }
  totals.cuts = thresholds.size();
  totals.open_cuts = judge.border.is_closed ? 0 : thresholds.size();
  return totals;
}

}  // namespace meshlode::judge
