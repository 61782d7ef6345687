// SPDX-License-Identifier: GPL-3.0-or-later
// The whole build: what is asked of the scene, every mesh (build_mesh.h: plan, prepare, dag, measure, hierarchy,
// encode), and the file. Read this and build_mesh.cpp first, then the rooms in the order they are called.
#include "builder/builder.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/try.h"
#include "builder/aggregate/mesh_parts.h"
#include "builder/build_mesh.h"
#include "builder/gather.h"
#include "builder/needs.h"
#include "builder/progress_meter.h"
#include "builder/stage_clock.h"
#include "builder/stage_options.h"
#include "builder/stored_images.h"
#include "builder/survey.h"
#include "builder/write/write.h"
#include "builder/write_meta.h"

namespace meshlode::builder {

namespace {

/// Refuses what cannot be built, before any mesh is.
Status check_build(const scene::Scene& scene, const PipelineOptions& options) {
  TRY(check_options(options, scene.meshes.size()));
  TRY(check_material_count(scene.materials.size()));
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const std::string label = mesh_label(scene.meshes[i], i);
    TRY(check_mesh_counts(count_mesh(scene.meshes[i]), label));
  }
  return Ok{};
}

/// Refuses what memory has no room for, before any mesh is built.
Result<MemoryFit> check_memory(const scene::Scene& scene, const PipelineOptions& options,
                               std::span<const AggregateDecision> aggregates, PipelineReport& report) {
  const MemoryEstimate estimate = estimate_memory(scene, options, aggregates);
  const auto fit = fit_memory(estimate, scene, static_cast<std::uint32_t>(thread_limit()), options.max_memory);
  report.memory_estimate = fit ? estimate.bytes(fit->at_once, fit->threads) : estimate.bytes(1, 1);
  return fit;
}

/// Meshes from the largest to the smallest: begun last, a large one would end long after all others.
std::vector<std::size_t> largest_first(const scene::Scene& scene) {
  std::vector<std::uint64_t> triangles;
  for (const scene::SourceMesh& mesh : scene.meshes) triangles.push_back(count_mesh(mesh).triangles);
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return triangles[a] > triangles[b]; });
  return order;
}

/// Every mesh once, so many side by side. Error: the first mesh's that has one.
Result<std::vector<BuiltMesh>> build_meshes(const Source& from, const PipelineOptions& options, const Survey& found,
                                            std::size_t at_once, const ProgressCallback& progress) {
  ProgressMeter meter(from.scene, progress);
  const std::vector<std::size_t> order = largest_first(from.scene);
  std::vector<Result<BuiltMesh>> results(order.size(), Error{});
  parallel_for_each_in_order(order.size(), at_once, [&](std::size_t i) {
    results[order[i]] = build_mesh(from, order[i], found, options, meter);
  });
  std::vector<BuiltMesh> meshes;
  for (Result<BuiltMesh>& result : results) {
    if (!result) return result.error();
    meshes.push_back(std::move(*result));
  }
  return meshes;
}

Result<std::vector<std::uint8_t>> build_asset_of(const Source& given, PipelineOptions options,
                                                 const ProgressCallback& progress, PipelineReport& report) {
  TRY(check_build(given.scene, options));
  std::vector<AggregateDecision> aggregates = decide_aggregates(given.scene, options);
  TRY_LET(fit, check_memory(given.scene, options, aggregates, report));
  TRY_LET(found, survey(given.scene, options, std::move(aggregates)));
  const std::vector<scene::MeshPart> parts = plan_parts(given.scene, found->aggregates, options);
  std::optional<scene::Scene> split;  // what is the caller's own stays as it is
  if (!parts.empty()) scene::split_parts(given.owned != nullptr ? *given.owned : split.emplace(given.scene), parts);
  const Source from = split ? Source{*split, &*split} : given;
  const scene::Scene& scene = from.scene;
  found->gaps = find_layers(scene, found->aggregates, options);
  Result<std::vector<BuiltMesh>> meshes =
      with_threads_at_most(fit->threads, [&] { return build_meshes(from, options, *found, fit->at_once, progress); });
  if (!meshes) return meshes.error();

  WriteInput input = gather(scene, std::move(*meshes), options, report);
  // Where all of them ended at level 0 nothing has such a material.
  const auto has_some = [](const EncodedMesh& mesh) { return has_aggregates(mesh.groups); };
  if (std::any_of(input.meshes.begin(), input.meshes.end(), has_some)) {
    input.materials = &found->coarse.materials;
    input.document = &found->coarse.document;
  }
  StageClock clock;
  TRY_LET(images, store_images(scene, options, report.decisions));
  if (!images->blobs.empty()) input.blobs = &images->blobs;
  input.meta_json = meta_json(scene, options, report.decisions, parts, images->replaced);
  Result<std::vector<std::uint8_t>> bytes = write_asset(std::move(input));
  clock.end(Stage::kWrite);
  clock.add_to(report.stages);
  return bytes;
}

}  // namespace

Result<std::vector<std::uint8_t>> build_lode(const scene::Scene& scene, const PipelineOptions& options,
                                             const ProgressCallback& progress, PipelineReport& report) {
  return build_asset_of({scene, nullptr}, options, progress, report);
}

Result<std::vector<std::uint8_t>> build_lode(scene::Scene&& scene, const PipelineOptions& options,
                                             const ProgressCallback& progress, PipelineReport& report) {
  return build_asset_of({scene, &scene}, options, progress, report);
}

}  // namespace meshlode::builder
