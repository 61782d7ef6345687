// SPDX-License-Identifier: GPL-3.0-or-later
// DAG rules (L301 … L312): who replaces whom, levels, errors, attribute deviations and LOD spheres (I4, I5).
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "judge/validate/exact.h"
#include "judge/validate/file_tables.h"
#include "judge/validate/margin.h"

namespace meshlode::judge {

namespace {

using format::ClusterRecord;
using format::GroupRecord;

constexpr double kLargestError = 0x1p120;  // of what is finite: a larger deviation cannot have a larger one

template <class Record>
ExactBall ball_of(const Record& r) {
  return {{r.center[0], r.center[1], r.center[2]}, r.radius};
}

bool is_ball(const ExactBall& b) {
  return std::isfinite(b.center[0]) && std::isfinite(b.center[1]) && std::isfinite(b.center[2]) &&
         std::isfinite(b.radius) && b.radius >= 0.0F;
}

bool is_terminal(const GroupRecord& group) {
  return (group.flags & format::kGroupTerminal) != 0;
}

// A renderer compares these with a bound. Measured for some groups of a mesh alone they would be no bound for the
// others.
template <class Place>
void check_attribute_deviation(const char* name, float value, bool is_terminal_group, std::optional<bool>& is_measured,
                               const Place& at, RuleLog& log) {
  const auto detail = [&](const char* what) { return std::string(name) + " is " + std::to_string(value) + what; };
  if (!log.expect(std::isfinite(value) && value >= 0.0F && !std::signbit(value), Rule::kL312, at,
                  [&] { return detail(""); })) {
    return;
  }
  if (is_terminal_group) {
    log.expect(value == format::kInfiniteError, Rule::kL312, at, [&] { return detail(" in a terminal group"); });
    return;
  }
  const bool is_here = value != format::kInfiniteError;
  if (!is_measured) is_measured = is_here;
  log.expect(*is_measured == is_here, Rule::kL312, at,
             [&] { return detail(": measured in some groups of the mesh alone"); });
}

// A deviation is of its group alone, so it may fall going coarser; the error has the margin of the settings, and is the
// largest of all below. The deviation was rounded up to a float after the error was made of it.
template <class Place>
void check_deviation(const GroupRecord& group, bool is_terminal_group, double margin, const Place& at, RuleLog& log) {
  if (is_terminal_group) {
    log.expect(group.deviation == format::kInfiniteError, Rule::kL311, at,
               [&] { return "deviation is " + std::to_string(group.deviation) + " in a terminal group"; });
    return;
  }
  constexpr double kRounding = 1.0 + 0x1p-22;
  const double needed = std::min(margin * double{group.deviation}, kLargestError);
  log.expect(group.deviation >= 0.0F && !std::signbit(group.deviation) && group.deviation < format::kInfiniteError &&
                 needed <= kRounding * double{group.error},
             Rule::kL311, at, [&] {
               return differs("deviation", double{group.deviation}, "error", double{group.error}) + "; the margin is " +
                      std::to_string(margin);
             });
}

/// META's error_margin; 1 where it says nothing. \pre META is sound, or it says nothing
double margin_of(const FileTables& file, RuleLog& log) {
  const std::optional<double> margin = file.facts.error_margin;
  if (!margin) return 1.0;
  const bool is_sound = log.expect(
      *margin >= 1.0 && *margin <= 2.0, Rule::kL311, [] { return std::string("section META: /settings/error_margin"); },
      [&] { return "is " + std::to_string(*margin) + ", not in 1 to 2"; });
  return is_sound ? *margin : 1.0;
}

void check_groups(const FileTables& file, RuleLog& log) {
  const double margin = margin_of(file, log);
  for (std::size_t m = 0; m < file.meshes.size(); ++m) {
    const format::MeshRecord& mesh = file.meshes[m];
    std::vector<std::uint32_t> made(mesh.group_count, 0);
    for (std::uint32_t k = 0; k < mesh.cluster_count; ++k) {
      const std::uint32_t own = file.clusters[mesh.first_cluster + k].own_group;
      if (own != format::kNone) ++made[own - mesh.first_group];
    }
    std::optional<bool> is_normal_measured, is_uv_measured;  // by the first group that is not terminal
    std::uint32_t level_before = 0xFFFFU;
    for (std::uint32_t k = 0; k < mesh.group_count; ++k) {
      const std::size_t g = std::size_t{mesh.first_group} + k;
      const GroupRecord& group = file.groups[g];
      const auto at = [&] { return place("mesh", m, "group", g); };

      std::uint32_t level = 0;
      for (std::uint32_t c = 0; c < group.cluster_count; ++c) {
        level = std::max<std::uint32_t>(level, file.clusters[group.first_cluster + c].level);
      }
      log.expect(group.level == level, Rule::kL304, at, [&] {
        return differs("level", std::uint64_t{group.level}, "largest of its members", std::uint64_t{level});
      });
      log.expect(group.level <= level_before, Rule::kL304, at,
                 [] { return std::string("is coarser than the group before"); });
      level_before = group.level;

      const bool terminal = is_terminal(group);
      const bool stuck = (group.flags & format::kGroupStuck) != 0;
      log.expect(terminal == (group.error == format::kInfiniteError), Rule::kL305, at, [&] {
        return std::string(terminal ? "terminal with a finite error" : "infinite error and not terminal");
      });
      log.expect((group.flags & format::kGroupAggregate) == 0 || !terminal, Rule::kL305, at,
                 [] { return std::string("an aggregate and terminal"); });
      log.expect(!stuck || terminal, Rule::kL305, at, [] { return std::string("stuck and not terminal"); });
      log.expect(stuck == (group.stuck_reason != format::StuckReason::kNotStuck), Rule::kL305, at,
                 [] { return std::string("the stuck flag and its reason disagree"); });
      log.expect(terminal == (made[k] == 0), Rule::kL306, at, [&] {
        return std::string(terminal ? "terminal, yet clusters were made from it"
                                    : "nothing was made from it and it is not terminal");
      });

      log.expect(std::isfinite(group.error) && group.error >= 0.0F && !std::signbit(group.error), Rule::kL307, at,
                 [&] { return "error is " + std::to_string(group.error); });
      // No decision of the run-time rule may rest on a denormal.
      log.expect(group.error == 0.0F || group.error >= 0x1p-100F, Rule::kL309, at,
                 [&] { return std::string("error is neither 0 nor at least 2^-100"); });
      log.expect(is_ball(ball_of(group)), Rule::kL308, at,
                 [] { return std::string("sphere is not finite or negative"); });
      log.expect(std::isfinite(group.quadric_error) && group.quadric_error >= 0.0F &&
                     terminal == (group.quadric_error == format::kInfiniteError),
                 Rule::kL311, at, [&] { return "quadric_error is " + std::to_string(group.quadric_error); });
      if (mesh.error_tier == format::ErrorTier::kQem) {
        log.expect(group.deviation == format::kInfiniteError, Rule::kL311, at,
                   [] { return std::string("the qem tier measures nothing, yet a deviation is stored"); });
      } else {
        check_deviation(group, terminal, margin, at, log);
      }
      check_attribute_deviation("normal_deviation", group.normal_deviation, terminal, is_normal_measured, at, log);
      check_attribute_deviation("uv_deviation", group.uv_deviation, terminal, is_uv_measured, at, log);
    }
  }
}

void check_cluster(const FileTables& file, std::size_t m, std::size_t c, RuleLog& log) {
  const ClusterRecord& cluster = file.clusters[c];
  const GroupRecord& coarser = file.groups[cluster.coarser_group];
  const auto at = [&] { return place("mesh", m, "cluster", c); };
  log.expect((cluster.level == 0) == (cluster.own_group == format::kNone), Rule::kL301, at, [&] {
    return "level " + std::to_string(cluster.level) + (cluster.own_group == format::kNone ? " without" : " with") +
           " an own group";
  });
  log.expect(c >= coarser.first_cluster && c - coarser.first_cluster < coarser.cluster_count, Rule::kL302, at,
             [&] { return "is not a member of its " + place("coarser group", cluster.coarser_group); });
  const bool is_level0 = cluster.own_group == format::kNone;
  // Both ends of what a replacement moves lie in the LOD sphere: the finest surface, and what was made of it.
  const std::uint32_t around = is_level0 ? cluster.coarser_group : cluster.own_group;
  const ExactBall lod = ball_of(file.groups[around]);
  const ExactBall culling = ball_of(format::cull_sphere(file.meshes[m], cluster));
  log.expect(!is_ball(lod) || !is_ball(culling) || contains_ball(lod, culling), Rule::kL310, at,
             [&] { return "culling sphere leaves the LOD sphere of " + place("group", around); });
  if (is_level0) return;
  const GroupRecord& own = file.groups[cluster.own_group];
  log.expect(cluster.level == own.level + 1U, Rule::kL303, at, [&] {
    return differs("level", std::uint64_t{cluster.level}, "level of its own group", std::uint64_t{own.level});
  });
  const auto pair = [&] {
    return place("mesh", m, "group", cluster.own_group) + ", " + place("coarser group", cluster.coarser_group);
  };
  const float fine = own.error;
  const float coarse = coarser.error;
  log.expect(coarse > fine || (coarse == 0.0F && fine == 0.0F), Rule::kL307, pair,
             [&] { return differs("finer error", double{fine}, "coarser error", double{coarse}); });
  log.expect(coarser.quadric_error >= own.quadric_error, Rule::kL311, pair, [&] {
    return differs("finer quadric error", double{own.quadric_error}, "coarser", double{coarser.quadric_error});
  });
  log.expect(coarser.normal_deviation >= own.normal_deviation, Rule::kL312, pair, [&] {
    return differs("finer normal deviation", double{own.normal_deviation}, "coarser", double{coarser.normal_deviation});
  });
  log.expect(coarser.uv_deviation >= own.uv_deviation, Rule::kL312, pair, [&] {
    return differs("finer UV deviation", double{own.uv_deviation}, "coarser", double{coarser.uv_deviation});
  });
  const ExactBall outer = ball_of(coarser);
  const ExactBall inner = ball_of(own);
  if (!is_ball(outer) || !is_ball(inner)) return;
  if (log.expect(contains_ball(outer, inner), Rule::kL308, pair,
                 [] { return std::string("the coarser sphere does not contain the finer one"); })) {
    log.expect(has_error_margin(fine, coarse) && has_sphere_margin(outer, inner), Rule::kL309, pair,
               [] { return std::string("contained, but without the margin"); });
  }
}

}  // namespace

void check_dag(const FileTables& file, RuleLog& log) {
  for (const Rule rule : {Rule::kL301, Rule::kL302, Rule::kL303, Rule::kL304, Rule::kL305, Rule::kL306, Rule::kL307,
                          Rule::kL308, Rule::kL309, Rule::kL310, Rule::kL311, Rule::kL312}) {
    log.check(rule);
  }
  check_groups(file, log);
  for (std::size_t m = 0; m < file.meshes.size(); ++m) {
    const format::MeshRecord& mesh = file.meshes[m];
    for (std::uint32_t k = 0; k < mesh.cluster_count; ++k)
      check_cluster(file, m, std::size_t{mesh.first_cluster} + k, log);
  }
}

}  // namespace meshlode::judge
