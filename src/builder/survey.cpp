// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/survey.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/append_format.h"
#include "base/printable.h"
#include "base/try.h"
#include "builder/aggregate/material_looks.h"
#include "builder/needs.h"
#include "builder/stage_options.h"
#include "scene/parts/pieces.h"

namespace meshlode::builder {

std::vector<AggregateDecision> decide_aggregates(const scene::Scene& scene, const PipelineOptions& options) {
  std::vector<AggregateDecision> decisions;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    decisions.push_back(decide_aggregate(scene.meshes[i], aggregate_question(scene, i, options)));
  }
  return decisions;
}

std::vector<MeshGaps> find_layers(const scene::Scene& scene, const std::vector<AggregateDecision>& aggregates,
                                  const PipelineOptions& options) {
  std::vector<std::uint8_t> wants(scene.meshes.size(), 0);
  for (std::size_t i = 0; i < wants.size() && options.keep_layers; ++i) {
    const bool has_levels = count_mesh(scene.meshes[i]).triangles > options.max_cluster_triangles;
    const bool is_thinned_out = aggregates[i].is_aggregate && aggregates[i].most_triangles.empty();
    wants[i] = has_levels && !is_thinned_out ? 1 : 0;
  }
  std::vector<MeshGaps> gaps = find_gaps(scene, wants);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (gaps[i].codes.empty()) continue;
    // Parts by vertex are at least as many as pieces: most meshes need no more than these.
    if (!are_seen_together(scene::count_parts_by_vertex(scene.meshes[i]), gaps[i].codes.size())) continue;
    const std::size_t pieces = scene::Pieces(scene.meshes[i]).pieces.size();
    if (are_seen_together(pieces, gaps[i].codes.size())) gaps[i].codes = {};
  }
  return gaps;
}

PlanDecision describe_gaps(const MeshGaps& gaps, std::uint64_t triangles, const std::string& label) {
  const GapSummary found = summarize(gaps);
  std::string text;
  append_format(
      text,
      "%s of %s triangles have a gap of %.2g to %.2g to a surface above or below that faces the same way: cuts "
      "whose error comes near it keep it, and more triangles there",
      grouped_digits(found.triangles).c_str(), grouped_digits(triangles).c_str(), found.narrowest, found.widest);
  return {label + ": layers", true, std::move(text)};
}

Result<Survey> survey(const scene::Scene& scene, const PipelineOptions& options,
                      std::vector<AggregateDecision> aggregates) {
  Survey found;
  found.aggregates = std::move(aggregates);
  found.texels = texels_of_materials(scene);
  if (options.promise != format::Promise::kPosition) found.extents = texel_extents_of_materials(scene);
  std::vector<std::uint8_t> is_used(scene.materials.size(), 0);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) add_materials(scene.meshes[i], found.aggregates[i], is_used);
  if (!found.has_aggregates()) return found;
  std::vector<std::uint8_t> wanted = is_used;
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = wanted[i] != 0 && needs_look(scene.materials[i]) ? 1 : 0;
  std::vector<std::optional<MaterialLook>> looks(scene.materials.size());
  if (options.looks != nullptr) looks = options.looks->read(scene, wanted);
  std::vector<std::uint8_t> is_unknown = wanted;
  for (std::size_t i = 0; i < wanted.size(); ++i) is_unknown[i] = wanted[i] != 0 && !looks[i] ? 1 : 0;
  is_used.assign(is_used.size(), 0);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    // Pieces whose texture cannot be read stay as they are.
    leave_out(scene.meshes[i], is_unknown, "what its texture shows is not known", found.aggregates[i]);
    add_materials(scene.meshes[i], found.aggregates[i], is_used);
  }
  if (!found.has_aggregates()) return found;
  TRY_LET(coarse, derive_materials(scene, is_used, looks));
  found.coarse = std::move(*coarse);
  return found;
}

}  // namespace meshlode::builder
