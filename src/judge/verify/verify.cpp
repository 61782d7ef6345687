// SPDX-License-Identifier: GPL-3.0-or-later
// The whole proof in the order of the invariants: the structural rules, the source, then cuts as a cross-check.
#include "judge/verify/verify.h"

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <iterator>

#include "base/memory.h"
#include "base/release.h"
#include "format/names.h"
#include "judge/validate/file_tables.h"
#include "judge/verify/coverage_rule.h"
#include "judge/verify/cuts.h"
#include "judge/verify/deviations.h"
#include "judge/verify/id_rule.h"
#include "judge/verify/locked_borders.h"
#include "judge/verify/promises.h"
#include "judge/verify/source_parts.h"
#include "judge/verify/source_rules.h"
#include "scene/count/file_triangles.h"

namespace meshlode::judge {

namespace {

/// Uniform cuts of a mesh whose edges are counted: a sort of all their edges each.
constexpr std::uint32_t kCrowdedCuts = 12;
constexpr std::uint32_t kCoverageSizes = 10;

class Report {
 public:
  void add_check(std::string invariant, std::string what, std::uint64_t items, std::uint64_t failures) {
    out.checks.push_back({std::move(invariant), std::move(what), items, failures, false});
  }
  void skip(std::string invariant, std::string what) {
    out.checks.push_back({std::move(invariant), std::move(what), 0, 0, true});
  }
  void take(RuleLog& log) {
    out.finding_count += log.finding_count();
    std::vector<Finding> findings = log.take_findings();
    std::move(findings.begin(), findings.end(), std::back_inserter(out.findings));
  }
  /// Nothing behind this can be looked at.
  void stop(std::string invariant, const Error& error) {
    add_check(std::move(invariant), "not reached: " + error.message(), 0, 1);
    if (out.finding_count > 0) return;
    out.findings.push_back(make_finding(Rule::kL204, error.where, error.detail));
    out.finding_count = 1;
  }
  VerifyReport finish() {
    std::stable_sort(
        out.checks.begin(), out.checks.end(),
        [](const VerifyReport::Check& a, const VerifyReport::Check& b) { return a.invariant < b.invariant; });
    return std::move(out);
  }
  VerifyReport out;
};

std::uint64_t failures_of(const RuleLog& log, std::initializer_list<Rule> rules) {
  std::uint64_t sum = 0;
  for (const Rule rule : rules) sum += log.count_of(rule);
  return sum;
}

/// The rules of validate, summed by invariant.
void add_structure(const run::Asset& asset, Report& report) {
  ValidationReport structure = validate_asset(asset.bytes());
  const auto failures = [&](auto&& counts) {
    return static_cast<std::uint64_t>(std::count_if(structure.findings.begin(), structure.findings.end(), counts));
  };
  const auto has_invariant = [&](const char* invariant) {
    return failures([&](const Finding& f) { return f.invariant == invariant && f.id[1] >= '3'; });
  };
  const auto groups = static_cast<std::uint64_t>(asset.groups().size());
  const auto clusters = static_cast<std::uint64_t>(asset.clusters().size());
  const auto ran = [&](Rule rule) {
    return std::find(structure.checked.begin(), structure.checked.end(), info_of(rule).id) != structure.checked.end();
  };
  report.add_check("", "container, tables and pages follow the format (L0, L1, L2)", asset.bytes().size(),
                   failures([](const Finding& f) { return f.id[1] < '3'; }));
  report.add_check("I2", "clusters within the caps, groups within pages", clusters, has_invariant("I2"));
  report.add_check("I4", "errors grow and LOD spheres nest along the DAG, in exact arithmetic", groups,
                   has_invariant("I4"));
  report.add_check("I5", "levels, roots and replacements form a DAG without gaps", clusters, has_invariant("I5"));
  report.add_check("I8", "the hierarchy bounds every group and cluster", asset.nodes().size(), has_invariant("I8"));
  if (ran(Rule::kL507)) {
    report.add_check("I3", "shared borders keep positions and attributes", groups, has_invariant("I3"));
    report.add_check("I6", "border proof: a group's coarser set has the border of its finer set", groups,
                     has_invariant("I6"));
  } else {
    report.add_check("I3", "not reached: the file is broken before its surface can be read", 0, 1);
    report.add_check("I6", "not reached: the file is broken before its surface can be read", 0, 1);
  }
  report.out.finding_count += structure.finding_count;
  std::move(structure.findings.begin(), structure.findings.end(), std::back_inserter(report.out.findings));
}

bool locks_any(const run::Asset& asset, const MetaFacts& facts) {
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    if (facts.of_mesh(m).locks_borders) return true;
  }
  return false;
}

void add_source(const run::Asset& asset, const scene::Scene& source, std::span<const run::DecodedCluster> clusters,
                bool is_quick, Report& report) {
  RuleLog log;
  SourceCounts totals;
  LockedTotals locked;
  const MetaFacts facts = read_meta_facts(asset.meta_json());
  const std::size_t count = std::min(asset.meshes().size(), source.meshes.size());
  log.expect(
      asset.meshes().size() == source.meshes.size(), Rule::kV103, [] { return std::string("meshes"); },
      [&] {
        return differs("stored", std::uint64_t{asset.meshes().size()}, "source", std::uint64_t{source.meshes.size()});
      });
  for (std::size_t m = 0; m < count && !is_quick; ++m) {
    const bool is_locked = facts.of_mesh(m).locks_borders;
    const SourceCounts counts = check_source_triangles(asset, MeshId(m), source.meshes[m], clusters, is_locked, log);
    if (is_locked) {
      check_locked_border(asset, build_surface(asset, MeshId(m), clusters), counts.border, locked, log);
    }
    totals.source_triangles += counts.source_triangles;
    totals.level0_triangles += counts.level0_triangles;
    totals.corners += counts.corners;
  }
  check_scene(asset, source, clusters, log);
  if (is_quick) {
    report.add_check("", "the source has as many meshes", 1, failures_of(log, {Rule::kV103}));
    report.skip("I1", "not checked: quick; the source's triangles are not searched");
    report.skip("I3", "not checked: quick; level-0 attributes are not compared with the source's");
    if (locks_any(asset, facts)) report.skip("I6", "not checked: quick; locked borders are not checked");
  } else {
    report.add_check("I1", "every source triangle is in exactly one level-0 cluster", totals.source_triangles,
                     failures_of(log, {Rule::kV101}));
    report.add_check("I1", "dropped and source triangles are counted correctly", count,
                     failures_of(log, {Rule::kV102, Rule::kV103}));
    report.add_check("I3", "level-0 attributes are the source's within their quantization", totals.corners,
                     failures_of(log, {Rule::kV104}));
    if (locked.meshes > 0) {
      report.add_check("I6",
                       "every vertex of locked borders is in every cut, by " + std::to_string(locked.groups) +
                           " groups and " + std::to_string(locked.cuts) + " random cuts",
                       locked.vertices, failures_of(log, {Rule::kV114}));
    }
  }
  report.add_check("", "attributes that the source's shading needs are stored", count, failures_of(log, {Rule::kV110}));
  report.add_check("I2", "clusters keep the caps of the settings", asset.clusters().size(),
                   failures_of(log, {Rule::kV111}));
  report.add_check("", "level 0 is within the accuracy budgets of the settings", count,
                   failures_of(log, {Rule::kV113}));
  report.add_check("I7", "the error tier is that of the settings", count, failures_of(log, {Rule::kV112}));
  if (!is_quick) {
    report.add_check("", "level-0 deviation is the largest move of a vertex onto the grid", count,
                     failures_of(log, {Rule::kV105}));
  }
  report.add_check("", "materials, instances, images and scene are the source's",
                   source.materials.size() + source.instances.size() + source.blobs.size(),
                   failures_of(log, {Rule::kV106, Rule::kV107, Rule::kV109}));
  report.add_check("", "the source is the one the asset was built from", 1, failures_of(log, {Rule::kV108}));
  report.take(log);
}

/// What no reader that build and verify share can hide.
void add_file_triangles(const run::Asset& asset, const scene::Scene& source, std::span<const std::uint8_t> file,
                        Report& report) {
  const auto found = file.empty() ? std::nullopt : scene::count_file_triangles(file, source.source_name);
  if (!found) return;
  std::uint64_t told = 0;  // what --repair removed is among them; a sum that a hostile record chose may wrap around
  for (const format::MeshRecord& mesh : asset.meshes()) told += mesh.source_triangles;
  RuleLog log;
  log.expect(
      found->at_least <= told && told <= found->at_most, Rule::kV115, [] { return std::string("meshes"); },
      [&] {
        return "the asset accounts for " + std::to_string(told) + " triangles, " + found->words + " " +
               std::to_string(found->at_least) +
               (found->at_least == found->at_most                  ? ""
                : found->at_most == scene::FileTriangles{}.at_most ? " or more"
                                                                   : " to " + std::to_string(found->at_most));
      });
  report.add_check("", "the asset has the triangles that the source's file holds, by its size or its lines",
                   found->at_least, failures_of(log, {Rule::kV115}));
  report.take(log);
}

void add_crowded_cuts(const run::Asset& asset, std::span<const MeshJudge> judges, std::uint32_t uniform_cuts,
                      Report& report) {
  const bool keeps_topology = read_meta_facts(asset.meta_json()).keeps_topology;
  const std::uint32_t count = keeps_topology ? uniform_cuts : std::min(uniform_cuts, kCrowdedCuts);
  RuleLog log;
  CrowdedTotals totals;
  for (const MeshJudge& judge : judges) {
    count_crowded_cuts(asset, judge.surface, count, keeps_topology, totals, log);
  }
  report.add_check(keeps_topology ? "I6" : "",
                   std::string(keeps_topology ? "no cut has more than level 0" : "reported, not a fault") +
                       ": edges of more than two triangles, " + std::to_string(totals.of_source) +
                       " at level 0, at most " + std::to_string(totals.of_cuts) + " in a cut",
                   totals.cuts, failures_of(log, {Rule::kV207}));
  report.out.crowded_edges = {totals.cuts, totals.of_source, totals.of_cuts, keeps_topology};
  report.take(log);
}

void add_cuts(const run::Asset& asset, std::span<const run::DecodedCluster> clusters, const VerifyOptions& options,
              Report& report) {
  RuleLog log;
  std::vector<MeshJudge> judges;
  CutTotals uniform;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    judges.push_back(make_mesh_judge(asset, MeshId(m), clusters));
    const CutTotals totals = check_uniform_cuts(asset, judges.back(), options.uniform_cuts, log);
    uniform.cuts += totals.cuts;
    uniform.open_cuts += totals.open_cuts;
  }
  report.add_check("I5", "uniform cuts draw each piece of surface exactly once, by the rule", uniform.cuts,
                   failures_of(log, {Rule::kV201, Rule::kV204, Rule::kV205}));
  report.add_check(
      "I6",
      "uniform cuts have no border that the source has not (" + std::to_string(uniform.open_cuts) + " of open meshes)",
      uniform.cuts, failures_of(log, {Rule::kV202}));
  report.take(log);
  add_crowded_cuts(asset, judges, options.uniform_cuts, report);
  RuleLog camera_log;
  const CameraTotals cameras = check_cameras(asset, judges, options.cameras, options.seed, camera_log);
  report.add_check("I5", "camera cuts draw each piece of surface exactly once", cameras.cuts,
                   failures_of(camera_log, {Rule::kV201}));
  report.add_check("I5",
                   "the rule in double precision agrees (" + std::to_string(cameras.too_close) + " within rounding)",
                   cameras.decisions, failures_of(camera_log, {Rule::kV204}));
  report.add_check("I6", "camera cuts have no border that the source has not", cameras.cuts,
                   failures_of(camera_log, {Rule::kV202}));
  report.add_check("I8", "hierarchy traversal selects what the flat rule selects", cameras.cameras,
                   failures_of(camera_log, {Rule::kV203}));
  report.take(camera_log);
}

void add_resident_cuts(const run::Asset& asset, std::span<const run::DecodedCluster> clusters,
                       const VerifyOptions& options, Report& report) {
  std::vector<MeshJudge> judges;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) judges.push_back(make_mesh_judge(asset, MeshId(m), clusters));
  RuleLog log;
  const ResidentTotals totals = check_resident_cuts(asset, judges, options.residencies, options.seed, log);
  if (totals.residencies == 0) {
    report.skip("I5", "not checked: no instance can be drawn");
  } else {
    report.add_check("I5", describe(totals), totals.residencies, failures_of(log, {Rule::kV212}));
  }
  report.take(log);
  RuleLog error_log;
  const ShownErrors errors = check_shown_errors(asset, clusters, totals.samples, error_log);
  if (errors.cuts == 0) {
    report.skip("I7", describe(errors));
  } else {
    report.add_check("I7", describe(errors), errors.cuts, failures_of(error_log, {Rule::kV212}));
  }
  report.take(error_log);
  report.out.streaming = {totals, errors};
}

void add_coverage(const run::Asset& asset, const VerifyOptions& options, Report& report) {
  const std::uint32_t sizes = options.is_quick ? 1 : std::min(options.deviation_cuts, kCoverageSizes);
  RuleLog log;
  const CoverageTotals totals = check_coverage(asset, sizes, log);
  if (totals.cuts == 0 && failures_of(log, {Rule::kV208}) == 0) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "aggregates cover what they stand for: at most %.3f of noise, %.2f%% more or less, contrast %.3f",
                totals.rms, 100.0 * totals.mean, totals.contrast);
  report.add_check("I7", text, totals.cuts, failures_of(log, {Rule::kV208}));
  report.take(log);
}

std::string describe(std::span<const CutBracket> brackets) {
  double lower = 0.0, upper = 0.0;
  std::uint64_t above = 0, undecided = 0;
  for (const CutBracket& cut : brackets) {
    lower = std::max(lower, cut.ratio_of(cut.lower));
    upper = std::max(upper, cut.ratio_of(cut.upper));
    if (cut.is_above(1.0)) ++above;
    if (cut.is_undecided()) ++undecided;
  }
  char text[160];
  std::snprintf(text, sizeof text,
                "cuts deviate by what they store: true/stored at most [%.3f, %.3f], above 1 in %llu cuts, undecided in "
                "%llu",
                lower, upper, static_cast<unsigned long long>(above), static_cast<unsigned long long>(undecided));
  return text;
}

void add_deviations(const run::Asset& asset, const scene::Scene& source, const VerifyOptions& options, Report& report) {
  const auto meshes = asset.meshes();
  const bool is_qem = std::all_of(meshes.begin(), meshes.end(),
                                  [](const format::MeshRecord& m) { return m.error_tier == format::ErrorTier::kQem; });
  const auto groups = asset.groups();
  const auto goes_by_coverage = [](const format::GroupRecord& group) {
    return (group.flags & (format::kGroupAggregate | format::kGroupTerminal)) != 0;
  };
  const bool has_aggregate = std::any_of(groups.begin(), groups.end(), [](const format::GroupRecord& group) {
    return (group.flags & format::kGroupAggregate) != 0;
  });
  if (has_aggregate && std::all_of(groups.begin(), groups.end(), goes_by_coverage)) return;  // all by what they cover
  if (is_qem) return report.skip("I7", "not checked: tier qem states the quadric's estimate");
  const std::uint32_t cuts = options.is_quick ? 1 : options.deviation_cuts;
  if (cuts == 0) return report.skip("I7", "not checked: no cut was to be measured");
  const std::uint32_t budget =
      options.is_quick ? std::min(options.deviation_budget, kQuickDeviationBudget) : options.deviation_budget;
  RuleLog log;
  report.out.brackets = check_deviations(asset, source, cuts, budget, log);
  report.add_check("I7", describe(report.out.brackets), report.out.brackets.size(), failures_of(log, {Rule::kV206}));
  report.take(log);
}

/// Nothing is said of an asset that promises positions alone.
void add_promises(const run::Asset& asset, const scene::Scene& source, const VerifyOptions& options, Report& report) {
  if (asset.promises().empty()) return;
  RuleLog units;
  check_promise_units(asset, source, units);
  report.add_check("I7", "what UVs and normals count as in promises is what the source says", asset.meshes().size(),
                   failures_of(units, {Rule::kV210}));
  report.take(units);
  const std::uint32_t cuts = options.is_quick ? 1 : options.deviation_cuts;
  for (const format::Promise promise : {format::Promise::kTexels, format::Promise::kAppearance}) {
    if (!asset.has_promise(promise)) continue;
    const std::string name(format::name_of(promise));
    if (cuts == 0) {
      report.skip("I7", "not checked: no cut was to be measured for the promise of " + name);
      continue;
    }
    RuleLog log;
    const DeviationTotals totals = check_promise(asset, source, promise, cuts, options.deviation_samples, log);
    char text[200];
    std::snprintf(text, sizeof text,
                  "cuts keep what is promised of %s: true/stored median %.2f, largest %.3f, above 1 in %llu cuts",
                  name.c_str(), totals.median, totals.worst, static_cast<unsigned long long>(totals.exceeded));
    report.add_check("I7", text, totals.cuts, failures_of(log, {Rule::kV209}));
    report.out.promises.push_back({name, totals.cuts, totals.exceeded, totals.median, totals.worst});
    report.take(log);
  }
}

void add_ids(const run::Asset& asset, const scene::Scene& source, const VerifyOptions& options, Report& report) {
  if (options.is_quick) return report.skip("I7", "not checked: quick; which surface pixels show is not drawn");
  RuleLog log;
  const std::uint32_t cameras = std::min(options.cameras, kIdCameras);
  const IdTotals totals = check_ids(asset, source, cameras, options.seed, log);
  if (totals.pictures == 0) {
    return report.skip("I7", "not checked: no camera draws which surface pixels show, or there is too much to draw");
  }
  report.out.surfaces = totals;
  if (has_estimates(asset)) {
    return report.skip("I7", describe(totals) + " (not judged: tier qem states the quadric's estimate)");
  }
  report.add_check("I7", describe(totals), totals.pictures, failures_of(log, {Rule::kV211}));
  report.take(log);
}

}  // namespace

VerifyReport verify_asset(const run::Asset& asset, const scene::Scene& whole, const VerifyOptions& options) {
  const std::optional<scene::Scene> split = split_source(asset, whole);
  const scene::Scene& source = split ? *split : whole;
  Report report;
  add_structure(asset, report);
  Result<std::vector<run::DecodedCluster>> clusters = run::decode_all(asset);
  if (clusters) {
    add_source(asset, source, *clusters, options.is_quick, report);
    add_file_triangles(asset, source, options.source_bytes, report);
    if (options.is_quick) {
      report.skip("I5", "not checked: quick; neither uniform cuts nor cameras");
    } else {
      add_cuts(asset, *clusters, options, report);
    }
    if (options.residencies > 0) add_resident_cuts(asset, *clusters, options, report);
    release(*clusters);  // cuts are decoded one by one
    give_back_freed_memory();
    add_deviations(asset, source, options, report);
    add_promises(asset, source, options, report);
    add_coverage(asset, options, report);
    add_ids(asset, source, options, report);
  } else {
    report.stop("I1", clusters.error());
  }
  return report.finish();
}

VerifyReport verify_streaming(const run::Asset& asset, const VerifyOptions& options) {
  Report report;
  add_structure(asset, report);
  report.skip("", "not checked: no source was given; the asset was not compared with it");
  if (const Result<std::vector<run::DecodedCluster>> clusters = run::decode_all(asset)) {
    add_resident_cuts(asset, *clusters, options, report);
  } else {
    report.stop("I5", clusters.error());
  }
  return report.finish();
}

}  // namespace meshlode::judge
