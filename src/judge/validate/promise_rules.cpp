// SPDX-License-Identifier: GPL-3.0-or-later
// L117 and L313: what an asset promises besides positions, from docs/reference/format.md ("Promises").
#include <cmath>
#include <string>

#include "judge/validate/file_tables.h"
#include "judge/validate/margin.h"

namespace meshlode::judge {

namespace {

constexpr std::uint32_t kTexels = format::kPromisesTexels;
constexpr std::uint32_t kAll = format::kPromisesTexels | format::kPromisesAppearance;

bool is_length(float value) {
  return std::isfinite(value) && value >= 0.0F && !std::signbit(value);
}

void check_mesh(const FileTables& file, std::size_t m, RuleLog& log) {
  const format::PromiseMeshRecord& record = file.promises[m];
  const format::MeshRecord& mesh = file.meshes[m];
  const auto at = [&] { return place("PRMS, mesh", m); };
  const auto expect = [&](bool holds, const char* detail) {
    log.expect(holds, Rule::kL117, at, [&] { return std::string(detail); });
  };
  expect((record.promises & kTexels) != 0 && (record.promises & ~kAll) == 0, "promises has another bit, or not bit 0");
  expect(record.promises == file.promises[0].promises, "promises is not that of the first mesh");
  const bool has_appearance = (record.promises & format::kPromisesAppearance) != 0;
  expect(is_length(record.normal_object), "normal_object is not finite, or negative");
  expect(has_appearance || record.normal_object == 0.0F, "normal_object without appearance");
  expect(mesh.normal_mode != format::NormalMode::kNone || record.normal_object == 0.0F,
         "normal_object without normals");
  for (std::uint32_t set = 0; set < format::kMaxUvSets; ++set) {
    const auto& [along_u, along_v] = record.uv_object[set];
    expect(is_length(along_u) && is_length(along_v), "uv_object is not finite, or negative");
    expect((along_u == 0.0F) == (along_v == 0.0F), "uv_object is 0 along one axis alone");
    expect(set < mesh.uv_set_count || (along_u == 0.0F && along_v == 0.0F), "uv_object of a set that is not stored");
  }
  expect(is_length(record.level0_texels) && record.level0_texels >= mesh.level0_deviation,
         "level0_texels is not finite, or below level0_deviation");
  expect(has_appearance ? is_length(record.level0_appearance) && record.level0_appearance >= record.level0_texels
                        : record.level0_appearance == 0.0F,
         "level0_appearance is not finite or below level0_texels, or not 0 where it is not promised");
}

void check_error(const char* name, float error, float least, const format::GroupRecord& group, std::size_t g,
                 RuleLog& log) {
  const auto at = [&] { return place("PRMG, group", g); };
  const auto detail = [&](const char* what) { return std::string(name) + " is " + std::to_string(error) + what; };
  const bool is_terminal = (group.flags & format::kGroupTerminal) != 0;
  log.expect(is_length(error) && error >= least, Rule::kL313, at,
             [&] { return detail(", below ") + std::to_string(least); });
  log.expect(is_terminal == (error == format::kInfiniteError), Rule::kL313, at,
             [&] { return detail(is_terminal ? " in a terminal group" : " in a group that is not terminal"); });
  // No decision of the run-time rule may rest on a denormal.
  log.expect(error == 0.0F || error >= 0x1p-100F, Rule::kL313, at, [&] { return detail(": neither 0 nor 2^-100"); });
}

void check_pair(const char* name, float finer, float coarser, std::size_t own, std::size_t above, RuleLog& log) {
  log.expect((coarser > finer || (coarser == 0.0F && finer == 0.0F)) && has_error_margin(finer, coarser), Rule::kL313,
             [&] { return place("PRMG, group", own) + ", " + place("coarser group", above); },
             [&] { return std::string(name) + ": " + differs("finer", double{finer}, "coarser", double{coarser}); });
}

}  // namespace

void check_promises(const FileTables& file, RuleLog& log) {
  log.check(Rule::kL117);
  log.check(Rule::kL313);
  if (!file.has_promises && !file.has_promise_errors) return;
  const bool is_whole = log.expect(
      file.has_promises && file.has_promise_errors && file.promises.size() == file.meshes.size() &&
          file.promise_errors.size() == file.groups.size(),
      Rule::kL117, [] { return std::string("PRMS and PRMG"); },
      [] { return std::string("one is missing, or they are not of each mesh and of each group"); });
  if (!is_whole) return;
  for (std::size_t m = 0; m < file.promises.size(); ++m) check_mesh(file, m, log);
  const auto has_appearance = [&](const format::GroupRecord& group) {
    return (file.promises[group.mesh].promises & format::kPromisesAppearance) != 0;
  };
  for (std::size_t g = 0; g < file.groups.size(); ++g) {
    const format::GroupRecord& group = file.groups[g];
    const format::PromiseGroupRecord& record = file.promise_errors[g];
    check_error("texel_error", record.texel_error, group.error, group, g, log);
    if (has_appearance(group)) {
      check_error("appearance_error", record.appearance_error, record.texel_error, group, g, log);
    } else {
      log.expect(
          record.appearance_error == 0.0F, Rule::kL313, [&] { return place("PRMG, group", g); },
          [] { return std::string("appearance_error is not 0 where it is not promised"); });
    }
  }
  for (const format::ClusterRecord& cluster : file.clusters) {
    if (cluster.own_group == format::kNone) continue;
    const format::PromiseGroupRecord& own = file.promise_errors[cluster.own_group];
    const format::PromiseGroupRecord& coarser = file.promise_errors[cluster.coarser_group];
    check_pair("texel_error", own.texel_error, coarser.texel_error, cluster.own_group, cluster.coarser_group, log);
    if (!has_appearance(file.groups[cluster.own_group])) continue;
    check_pair("appearance_error", own.appearance_error, coarser.appearance_error, cluster.own_group,
               cluster.coarser_group, log);
  }
}

}  // namespace meshlode::judge
