// SPDX-License-Identifier: GPL-3.0-or-later
#include "extract_stuck.h"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <vector>

#include "app/export/colored_sets.h"
#include "app/report/info.h"
#include "base/json_writer.h"
#include "base/printable.h"
#include "format/names.h"
#include "streams.h"

namespace meshlode::cli {

namespace {

struct Look {
  format::StuckReason reason;
  const char* color_name;
  std::array<float, 3> color;  ///< linear
};

constexpr std::array<Look, 7> kLooks{{
    {format::StuckReason::kLocked, "red", {0.80F, 0.03F, 0.03F}},
    {format::StuckReason::kFlips, "orange", {0.90F, 0.30F, 0.01F}},
    {format::StuckReason::kSeams, "blue", {0.02F, 0.15F, 0.80F}},
    {format::StuckReason::kComponents, "green", {0.03F, 0.45F, 0.05F}},
    {format::StuckReason::kTooSmall, "grey", {0.35F, 0.35F, 0.35F}},
    {format::StuckReason::kTopology, "purple", {0.35F, 0.05F, 0.55F}},
    {format::StuckReason::kBorder, "yellow", {0.80F, 0.60F, 0.02F}},
}};

struct ReasonCount {
  std::uint64_t groups = 0, triangles = 0;
};

}  // namespace

FileOutcome extract_stuck(const run::Asset& asset, const std::string& output, const OutputOptions& options) {
  const app::AssetInfo info = app::describe_asset(asset);
  std::array<ReasonCount, kLooks.size()> counts{};
  std::vector<app::ColoredSet> sets;
  for (const app::MeshInfo& mesh : info.meshes) {
    for (std::size_t k = 0; k < kLooks.size(); ++k) {
      app::ColoredSet set{MeshId(), format::name_of(kLooks[k].reason), kLooks[k].color, {}};
      for (const app::StuckGroupInfo& stuck : mesh.stuck) {
        if (stuck.reason != kLooks[k].reason) continue;
        set.mesh = MeshId(stuck.mesh);
        const format::GroupRecord& group = asset.groups()[stuck.group];
        for (std::uint32_t c = 0; c < group.cluster_count; ++c) set.clusters.emplace_back(group.first_cluster + c);
        ++counts[k].groups;
        counts[k].triangles += stuck.triangles;
      }
      if (!set.clusters.empty()) sets.push_back(std::move(set));
    }
  }
  FileOutcome out;
  const auto fail = [&](const Error& error) {
    out.fail(error);
    return out;
  };
  const auto glb = app::export_colored_sets(asset, sets);
  if (!glb) return fail(glb.error());
  if (const Status status = write_output(output, *glb); !status) return fail(status.error());

  std::uint64_t triangles = 0;
  for (const ReasonCount& count : counts) triangles += count.triangles;
  out.cells = {grouped_digits(triangles), grouped_digits(glb->size())};
  if (options.json()) {
    JsonWriter w;
    w.begin_object();
    w.key("meshes");
    w.begin_array();
    w.end_array();
    w.key("stuck");
    w.begin_object();
    for (std::size_t k = 0; k < kLooks.size(); ++k) {
      if (counts[k].groups == 0) continue;
      w.key(format::name_of(kLooks[k].reason));
      w.begin_object();
      w.field("groups", counts[k].groups);
      w.field("triangles", counts[k].triangles);
      w.field("color", kLooks[k].color_name);
      w.end_object();
    }
    w.end_object();
    w.field("triangles", triangles);
    w.field("bytes", glb->size());
    w.end_object();
    out.text = w.text();
    return out;
  }
  if (options.quiet) return out;
  std::string text;
  char line[160];
  for (std::size_t k = 0; k < kLooks.size(); ++k) {
    if (counts[k].groups == 0) continue;
    std::snprintf(line, sizeof line, "%s: %" PRIu64 " group(s), %" PRIu64 " triangles, %s\n",
                  format::name_of(kLooks[k].reason), counts[k].groups, counts[k].triangles, kLooks[k].color_name);
    text += line;
  }
  if (sets.empty()) text += "no stuck group: a glTF without meshes\n";
  text += output + ": " + std::to_string(triangles) + " triangles, " + std::to_string(glb->size()) + " bytes\n";
  (output == kStream ? out.notes : out.text) = std::move(text);  // beside what went to stdout
  return out;
}

}  // namespace meshlode::cli
