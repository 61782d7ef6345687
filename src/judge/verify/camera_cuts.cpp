// SPDX-License-Identifier: GPL-3.0-or-later
// Random cameras: the flat rule against the hierarchy (I8), against the rule in double precision, and each instance's
// cut against coverage and border (I5, I6).
#include <algorithm>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "judge/verify/cuts.h"
#include "judge/verify/judged_view.h"

namespace meshlode::judge {

namespace {

constexpr std::size_t kMostFaultyInstances = 1000;  ///< of a camera; the rest is not looked at

struct CameraFaults {
  std::string hierarchy;  ///< V203
  std::vector<std::pair<std::uint32_t, CutFaults>> of_instance;
  CameraTotals totals;
};

void check_rule(const run::Asset& asset, const JudgedView& view, const format::InstanceRecord& instance,
                const MeshSurface& surface, std::span<const std::uint8_t> drawn, CutFaults& faults,
                CameraTotals& totals) {
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  std::vector<Answer> answers(surface.group_count);
  for (std::uint32_t k = 0; k < surface.group_count; ++k) {
    answers[k] = weigh(view, instance, mesh, asset.groups()[surface.first_group + k]).answer;
    ++totals.decisions;
    totals.too_close += answers[k] == Answer::kTooClose ? 1 : 0;
  }
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[surface.first_cluster + c];
    const Answer own =
        cluster.own_group == format::kNone ? Answer::kPasses : answers[cluster.own_group - surface.first_group];
    const Answer coarser = answers[cluster.coarser_group - surface.first_group];
    const bool surely_drawn = own == Answer::kPasses && coarser == Answer::kFails;
    const bool surely_not = own == Answer::kFails || coarser == Answer::kPasses;
    if ((surely_drawn && drawn[c] == 0) || (surely_not && drawn[c] != 0)) {
      faults.rule = place("cluster", surface.first_cluster + c) + (surely_drawn ? " is not drawn" : " is drawn");
      return;
    }
  }
}

CameraFaults judge_camera(const run::Asset& asset, std::span<const MeshJudge> judges, const JudgedView& view,
                          const Selectors& selectors) {
  CameraFaults out;
  const std::vector<run::ClusterInstance> flat = selectors.flat(asset, view.camera, view.pixel_error);
  const std::vector<run::ClusterInstance> bvh = selectors.bvh(asset, view.camera, view.pixel_error);
  if (flat != bvh) {
    const auto [a, b] = std::mismatch(flat.begin(), flat.end(), bvh.begin(), bvh.end());
    const run::ClusterInstance& first = b == bvh.end() || (a != flat.end() && *a < *b) ? *a : *b;
    out.hierarchy = std::to_string(flat.size()) + " flat, " + std::to_string(bvh.size()) +
                    " by hierarchy; first difference at " +
                    place("instance", first.instance.value, "cluster", first.cluster.value);
  }
  std::size_t next = 0;
  std::vector<std::uint8_t> drawn;
  for (std::uint32_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    const std::size_t begin = next;
    while (next < flat.size() && flat[next].instance.value == i) ++next;
    CutFaults faults;
    if (!is_drawable(asset, instance)) {
      if (next != begin) faults.coverage = "an instance that is not drawable is drawn";
    } else {
      const MeshJudge& judge = judges[instance.mesh];
      const MeshSurface& surface = judge.surface;
      drawn.assign(surface.cluster_count, 0);
      bool foreign = false;
      for (std::size_t k = begin; k < next; ++k) {
        const std::uint32_t c = flat[k].cluster.value - surface.first_cluster;
        if (c < surface.cluster_count)
          ++drawn[c];
        else
          foreign = true;
      }
      if (begin == next)
        faults.coverage = "the cut is empty";
      else if (foreign)
        faults.coverage = "clusters of another mesh are drawn";
      else
        faults.coverage = find_coverage_fault(asset, judge, drawn);
      faults.border = find_border_fault(judge, drawn);
      check_rule(asset, view, instance, surface, drawn, faults, out.totals);
      ++out.totals.cuts;
    }
    if (!faults.coverage.empty() || !faults.border.empty() || !faults.rule.empty())
      out.of_instance.emplace_back(i, faults);
    // Texts of instances times cameras are a product that a file chooses; so many say enough.
    if (out.of_instance.size() >= kMostFaultyInstances) return out;
  }
  if (next != flat.size())
    out.hierarchy = "the flat selection is not ascending or names an instance that does not exist";
  return out;
}

}  // namespace

CameraTotals check_cameras(const run::Asset& asset, std::span<const MeshJudge> judges, std::uint32_t count,
                           std::uint64_t seed, RuleLog& log, const Selectors& selectors) {
  CameraTotals totals;
  std::vector<std::uint32_t> drawable;
  for (std::uint32_t i = 0; i < asset.instances().size(); ++i) {
    if (is_drawable(asset, asset.instances()[i])) drawable.push_back(i);
  }
  for (const Rule rule : {Rule::kV201, Rule::kV202, Rule::kV203, Rule::kV204}) log.check(rule);
  if (drawable.empty()) return totals;
  SplitMix64 random(seed);
  std::vector<JudgedView> views;
  for (std::uint32_t i = 0; i < count; ++i) views.push_back(random_view(asset, drawable, i, random));
  std::vector<CameraFaults> faults(views.size());
  parallel_for_each_index(views.size(), 1,
                          [&](std::size_t i) { faults[i] = judge_camera(asset, judges, views[i], selectors); });
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const std::string camera = place("camera", i) + " (" + views[i].kind + ", seed " + std::to_string(seed) + ")";
    if (!faults[i].hierarchy.empty()) log.add(Rule::kV203, camera, faults[i].hierarchy);
    for (const auto& [instance, fault] : faults[i].of_instance) {
      const std::string where = camera + ", " + place("instance", instance);
      if (!fault.coverage.empty()) log.add(Rule::kV201, where, fault.coverage);
      if (!fault.border.empty()) log.add(Rule::kV202, where, fault.border);
      if (!fault.rule.empty()) log.add(Rule::kV204, where, fault.rule);
    }
    totals.cuts += faults[i].totals.cuts;
    totals.decisions += faults[i].totals.decisions;
    totals.too_close += faults[i].totals.too_close;
  }
  totals.cameras = views.size();
  return totals;
}

}  // namespace meshlode::judge
