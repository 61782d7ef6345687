// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/doctor/asset_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include <meshlode/format.h>

#include "app/report/info.h"
#include "app/report/read_meta.h"
#include "base/append_format.h"
#include "base/printable.h"

namespace meshlode::app {

namespace {

using format::StuckReason;

constexpr std::size_t kMaxListedGroups = 16;
constexpr std::uint64_t kFewestGroups = 20;  ///< of a mesh, so that a twentieth of them is one
constexpr double kLeastErrorShare = 0.5;
constexpr std::size_t kManySmallDraws = 16;  ///< as scene::kManySmallDraws
constexpr double kLowShare = 1e-4;           ///< of what has no share: named last

struct Words {
  const char *id, *title, *remedy;
  const char* hard_case = "";  ///< of docs/reference/hard-cases.md
};

constexpr Words kEmpty{"nothing-to-draw", "asset with nothing left to draw",
                       "check the source with `doctor`, and what was left out; build --strict refuses such a scene"};
constexpr Words kFewGroups{"error-in-few-groups", "5% of the groups cause half of the first level's error",
                           "check them with `extract --error`: spikes and slivers there keep the whole level fine"};
constexpr Words kDropped{"dropped-faces", "triangles of the source that the build dropped",
                         "remove degenerate and doubled faces from the source", "repeated"};
constexpr Words kCollapsed{"grid-collapsed", "triangles of level 0 that have no area on the position grid",
                           "give fine parts a mesh of their own, or --position-error a smaller distance; slivers and "
                           "triangles on a line are better removed from the source",
                           "two-sizes"};
constexpr Words kSmall{"small-meshes", "meshes of one cluster, drawn as they are at any distance",
                       "merge meshes that lie together and share materials"};
constexpr Words kUnmeasured{"unmeasured-errors", "meshes whose errors are estimates of the quadric",
                            "build with --error-tier measured"};

struct StuckWords {
  StuckReason reason;
  Words words;
};
constexpr std::array<StuckWords, 6> kStuck{{
    {StuckReason::kLocked,
     {"stuck-locked", "groups that could not be simplified: too much is shared with other groups",
      "weld seams, and remove T-junctions and points of hundreds of triangles around them"}},
    {StuckReason::kFlips,
     {"stuck-flips", "groups that could not be simplified: every collapse would flip a triangle",
      "remove needles and folded faces there"}},
    {StuckReason::kSeams,
     {"stuck-seams", "groups that could not be simplified: seams of attributes or borders of materials",
      "make fewer UV islands, smooth normals except at sharp edges, and join materials in an atlas"}},
    {StuckReason::kComponents,
     {"stuck-components", "groups that could not be simplified: loose pieces that share no vertex",
      "weld pieces that touch; draw leaves and gravel as instances or cards"}},
    {StuckReason::kTooSmall,
     {"stuck-too-small", "groups that could not be simplified: nothing is left to remove",
      "nothing, or merge small meshes that lie together"}},
    {StuckReason::kTopology,
     {"stuck-topology", "groups that could not be simplified: every collapse would break the surface",
      "take edges of more than two triangles apart, or build with --repair"}},
}};

Diagnosis diagnosis_of(const Words& words) {
  Diagnosis diagnosis;
  diagnosis.id = words.id;
  diagnosis.title = words.title;
  diagnosis.remedy = words.remedy;
  diagnosis.hard_case = words.hard_case;
  return diagnosis;
}

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : std::min(1.0, static_cast<double>(part) / static_cast<double>(whole));
}

class Examiner {
 public:
  explicit Examiner(const run::Asset& asset) : asset_(asset), info_(describe_asset(asset)) {}

  std::vector<Diagnosis> take() {
    for (std::uint32_t m = 0; m < asset_.meshes().size(); ++m) {
      add_stuck(m);
      add_error_holders(m);
      add_dropped(m);
      add_unmeasured(m);
    }
    add_empty();
    add_small();
    add_left_out();
    return std::move(out_);
  }

 private:
  [[nodiscard]] DiagnosisPlace place_of(std::uint32_t mesh) const {
    DiagnosisPlace place;
    place.mesh = mesh;
    place.where = mesh_words(mesh, asset_.string(asset_.meshes()[mesh].name));
    return place;
  }
  static void add_triangles(DiagnosisPlace& place, const char* kind, std::uint64_t triangles) {
    place.triangle_count = triangles;
    place.costs.push_back({kind, static_cast<double>(triangles), "triangles"});
  }

  void add_stuck(std::uint32_t mesh) {
    for (const StuckWords& stuck : kStuck) {
      DiagnosisPlace place = place_of(mesh);
      std::uint64_t triangles = 0;
      for (const StuckGroupInfo& group : info_.meshes[mesh].stuck) {
        if (group.reason != stuck.reason) continue;
        ++place.count;
        triangles += group.triangles;
        if (place.groups.size() < kMaxListedGroups) place.groups.push_back(group.group);
      }
      if (place.count == 0) continue;
      add_triangles(place, "time", triangles);
      place.share = share_of(triangles, info_.source_triangles);
      append_format(place.detail, "%s with %s that nothing coarser replaces", counted(place.count, "groups").c_str(),
                    counted(triangles, "triangles").c_str());
      add_place(out_, diagnosis_of(stuck.words), std::move(place));
    }
  }

  /// The error of a group is its squared error times its triangles; of those that consume level 0.
  void add_error_holders(std::uint32_t mesh) {
    const format::MeshRecord& record = asset_.meshes()[mesh];
    std::vector<std::pair<double, std::uint32_t>> order;
    double total = 0.0;
    for (std::uint32_t g = record.first_group; g < record.first_group + record.group_count; ++g) {
      const format::GroupRecord& group = asset_.groups()[g];
      if (group.level != 0 || (group.flags & format::kGroupTerminal) != 0) continue;
      const double error = static_cast<double>(group.error);
      const double held = error * error * static_cast<double>(triangles_of(group));
      if (!std::isfinite(held)) continue;
      order.emplace_back(-held, g);
      total += held;
    }
    if (order.size() < kFewestGroups) return;
    std::sort(order.begin(), order.end());
    DiagnosisPlace place = place_of(mesh);
    place.count = order.size() / kFewestGroups;
    double held = 0.0;
    std::uint64_t triangles = 0;
    for (std::size_t i = 0; i < place.count; ++i) {
      held -= order[i].first;
      triangles += triangles_of(asset_.groups()[order[i].second]);
      if (i < kMaxListedGroups) place.groups.push_back(order[i].second);
    }
    if (!(total > 0.0) || held < kLeastErrorShare * total) return;
    place.triangle_count = triangles;
    const double worst = static_cast<double>(asset_.groups()[order[0].second].error);
    place.costs.push_back({"accuracy", worst, "object units"});
    place.share = held / total * share_of(record.source_triangles, info_.source_triangles);
    append_format(place.detail, "%zu of %zu groups over level 0 hold %.0f%% of their error",
                  static_cast<std::size_t>(place.count), order.size(), 100.0 * held / total);
    add_place(out_, diagnosis_of(kFewGroups), std::move(place));
  }

  [[nodiscard]] std::uint64_t triangles_of(const format::GroupRecord& group) const {
    std::uint64_t triangles = 0;
    for (std::uint32_t c = 0; c < group.cluster_count; ++c) {
      triangles += asset_.clusters()[group.first_cluster + c].triangle_count();
    }
    return triangles;
  }

  void add_dropped(std::uint32_t mesh) {
    const format::MeshRecord& record = asset_.meshes()[mesh];
    const auto digits = [](std::uint64_t count) { return grouped_digits(count); };
    DiagnosisPlace place = place_of(mesh);
    // A sum that a hostile record chose may wrap around; it is a number all the same.
    place.count = record.dropped_degenerate + record.dropped_duplicate + record.dropped_repaired;
    if (place.count > 0) {
      add_triangles(place, "time", place.count);
      place.share = share_of(place.count, info_.source_triangles);
      append_format(place.detail, "%s degenerate, %s duplicate, %s by --repair",
                    digits(record.dropped_degenerate).c_str(), digits(record.dropped_duplicate).c_str(),
                    digits(record.dropped_repaired).c_str());
      add_place(out_, diagnosis_of(kDropped), std::move(place));
    }
    place = place_of(mesh);
    place.count = record.grid_collapsed;
    if (place.count == 0) return;
    add_triangles(place, "accuracy", place.count);
    place.share = share_of(place.count, info_.source_triangles);
    append_format(place.detail, "%s, on a grid of %.3g object units", counted(place.count, "triangles").c_str(),
                  std::ldexp(record.grid.mantissa, record.grid.log2));
    add_place(out_, diagnosis_of(kCollapsed), std::move(place));
  }

  void add_unmeasured(std::uint32_t mesh) {
    if (asset_.meshes()[mesh].error_tier != format::ErrorTier::kQem || asset_.meshes()[mesh].level_count <= 1) return;
    DiagnosisPlace place = place_of(mesh);
    place.count = 1;
    add_triangles(place, "accuracy", asset_.meshes()[mesh].source_triangles);
    place.share = kLowShare * share_of(place.triangle_count, info_.source_triangles);
    place.detail = "tier qem: what a cut deviates by was not measured";
    add_place(out_, diagnosis_of(kUnmeasured), std::move(place));
  }

  void add_empty() {
    if (!asset_.clusters().empty()) return;
    DiagnosisPlace place;
    place.where = "scene";
    place.count = 1;
    add_triangles(place, "accuracy", info_.source_triangles);
    place.share = 1.0;
    place.detail = info_.source_triangles == 0
                       ? "no triangle"
                       : counted(info_.source_triangles, "triangles") + " in the source, none with an area";
    add_place(out_, diagnosis_of(kEmpty), std::move(place));
  }

  void add_small() {
    DiagnosisPlace place;
    place.where = "scene";
    std::vector<std::uint64_t> draws(asset_.meshes().size(), 0);
    for (const format::InstanceRecord& instance : asset_.instances()) {
      if (instance.mesh < draws.size()) ++draws[instance.mesh];
    }
    double all = 0.0, small = 0.0;
    std::uint64_t small_draws = 0;
    for (std::size_t m = 0; m < draws.size(); ++m) {
      const format::MeshRecord& record = asset_.meshes()[m];
      const double drawn = static_cast<double>(record.source_triangles) * static_cast<double>(draws[m]);
      all += drawn;
      if (record.cluster_count != 1 || draws[m] == 0) continue;
      ++place.count;
      small += drawn;
      small_draws += draws[m];
      place.triangle_count += record.source_triangles;
    }
    if (small_draws < kManySmallDraws || !(all > 0.0)) return;
    place.costs.push_back({"time", small, "triangles"});
    place.share = small / all;
    append_format(place.detail, "%s of one cluster, drawn %s times", counted(place.count, "meshes").c_str(),
                  grouped_digits(small_draws).c_str());
    add_place(out_, diagnosis_of(kSmall), std::move(place));
  }

  /// What the plan left out it left out for good reasons: nothing is lost by it.
  void add_left_out() {
    std::set<std::pair<std::string, std::string>> planned;
    for (const MetaInfo::Decision& decision : info_.meta.decisions) {
      if (!decision.is_kept) planned.emplace(decision.what, decision.reason);
    }
    for (const MetaInfo::LeftOut& left : info_.meta.left_outs) {
      if (planned.count({left.what, left.why}) == 0) app::add_left_out(out_, left.what, left.why);
    }
  }

  const run::Asset& asset_;
  AssetInfo info_;
  std::vector<Diagnosis> out_;
};

}  // namespace

std::vector<std::string> asset_fault_ids() {
  std::vector<std::string> ids{kEmpty.id, kFewGroups.id,  kDropped.id, kCollapsed.id,
                               kSmall.id, kUnmeasured.id, kLeftOutId};
  ids.reserve(ids.size() + kStuck.size());
  for (const StuckWords& stuck : kStuck) ids.emplace_back(stuck.words.id);
  return ids;
}

std::vector<std::string> asset_hard_cases() {
  std::vector<std::string> cases;
  const auto add = [&](const Words& words) {
    if (*words.hard_case != '\0') cases.emplace_back(words.hard_case);
  };
  for (const Words* words : {&kFewGroups, &kDropped, &kCollapsed, &kSmall, &kUnmeasured}) add(*words);
  for (const StuckWords& stuck : kStuck) add(stuck.words);
  return cases;
}

std::vector<Diagnosis> diagnose_asset(const run::Asset& asset) {
  return Examiner(asset).take();
}

}  // namespace meshlode::app
