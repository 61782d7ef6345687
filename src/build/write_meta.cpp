// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/write_meta.h"

#include <nlohmann/json.hpp>

#include "base/version.h"
#include "build/dag/build_dag.h"
#include "build/plan/attributes.h"
#include "build/preset.h"
#include "format/names.h"

namespace meshlode::build {

namespace {

using Json = nlohmann::ordered_json;

/// What a group's deviation is multiplied by on the way to its error. The tier qem has no deviations.
double error_margin_of(format::ErrorTier tier) {
  return tier == format::ErrorTier::kMeasured ? kMeasuredMargin : 1.0;
}

}  // namespace

std::string meta_json(const scene::Scene& scene, const PipelineOptions& options,
                      const std::vector<PlanDecision>& decisions) {
  Json meta;
  meta["generator"] = program_version();
  meta["source"] = {{"file", scene.source_name}, {"hash", scene.source_hash}};
  Json settings;
  settings["preset"] = name_of(options.preset);
  settings["error_tier"] = format::name_of(options.error_tier);
  settings["error_margin"] = error_margin_of(options.error_tier);
  settings["attributes"] = name_of(options.attributes);
  // By name only where a name made a difference: one that made none changes no byte.
  for (const bool kept : {true, false}) {
    const std::vector<std::string> names = names_of_attributes(forced_attributes(decisions, kept));
    if (!names.empty()) settings[kept ? "keep" : "drop"] = names;
  }
  settings["grid"] = options.grid_step > 0.0 ? Json(options.grid_step) : Json("auto");
  settings["codec"] = format::name_of(options.codec);
  settings["repair"] = options.repair;
  if (!scene.choice.empty()) settings["scene"] = scene.choice;
  settings["cluster_triangles"] = options.max_cluster_triangles;
  settings["cluster_vertices"] = options.max_cluster_vertices;
  settings["position_error"] = options.position_error > 0.0 ? Json(options.position_error) : Json("auto");
  settings["normal_error"] = options.normal_error;
  settings["uv_error"] = options.uv_error;
  settings["uv_error_unit"] = options.uv_error_is_texels ? "texels" : "uv";
  meta["settings"] = settings;
  meta["plan"] = Json::array();
  for (const PlanDecision& decision : decisions) {
    meta["plan"].push_back({{"what", decision.what}, {"kept", decision.kept}, {"reason", decision.reason}});
  }
  meta["left_out"] = Json::array();
  for (const scene::LeftOut& item : scene.left_out)
    meta["left_out"].push_back({{"what", item.what}, {"why", item.why}});
  for (const PlanDecision& decision : decisions) {
    if (!decision.kept) meta["left_out"].push_back({{"what", decision.what}, {"why", decision.reason}});
  }
  // Names come from files: bytes that are not UTF-8 are replaced, never thrown on.
  return meta.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace meshlode::build
