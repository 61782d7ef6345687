// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/gather.h"

#include <algorithm>
#include <string>
#include <utility>

#include "builder/hooks.h"
#include "builder/plan/features.h"
#include "builder/stage_options.h"

namespace meshlode::builder {

namespace {

/// What the asset says of its scene beside the meshes' decisions.
void add_scene_decisions(const scene::Scene& scene, const std::vector<EncodedMesh>& meshes,
                         const PipelineOptions& options, std::vector<PlanDecision>& decisions) {
  for (PlanDecision& decision : unknown_names(scene, options)) decisions.push_back(std::move(decision));
  if (options.hooks != nullptr) {
    PlanDecision decision{"scene: experimental", true, options.hooks->words};
    decision.mesh = format::kNone;
    decisions.push_back(std::move(decision));
  }
  for (PlanDecision& decision : list_ruled_features(scene)) {
    decision.what = "scene: " + decision.what;
    decision.mesh = format::kNone;
    decisions.push_back(std::move(decision));
  }
  const auto whole = std::count_if(meshes.begin(), meshes.end(),
                                   [](const EncodedMesh& mesh) { return mesh.record.cluster_count == 1; });
  if (whole == 0) return;
  PlanDecision decision{"scene: " + std::to_string(whole) + " of " + std::to_string(meshes.size()) + " meshes", true,
                        "one cluster each: passed through without levels of detail"};
  decision.mesh = format::kNone;
  decisions.push_back(std::move(decision));
}

}  // namespace

WriteInput gather(const scene::Scene& scene, std::vector<BuiltMesh> meshes, const PipelineOptions& options,
                  PipelineReport& report) {
  WriteInput input;
  input.scene = &scene;
  input.codec = options.codec;
  input.has_page_hints = options.page_hints;
  input.promises = promises_of(options.promise);
  report.decisions.clear();
  report.levels.clear();
  report.stored_meshes = 0;
  report.clusters = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    BuiltMesh& mesh = meshes[i];
    mesh.clock.add_to(report.stages);
    report.stored_meshes += mesh.was_stored ? 1 : 0;
    report.clusters += mesh.encoded.clusters.size();
    for (PlanDecision& decision : mesh.decisions) decision.mesh = static_cast<std::uint32_t>(i);
    report.decisions.insert(report.decisions.end(), mesh.decisions.begin(), mesh.decisions.end());
    report.levels.insert(report.levels.end(), mesh.levels.begin(), mesh.levels.end());
    input.meshes.push_back(std::move(mesh.encoded));
    input.mesh_names.push_back(scene.meshes[i].name);
  }
  add_scene_decisions(scene, input.meshes, options, report.decisions);
  return input;
}

}  // namespace meshlode::builder
