// SPDX-License-Identifier: GPL-3.0-or-later
// The whole build as one straight line. Read this first, then the rooms in the order they are called.
#include "builder/builder.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/release.h"
#include "builder/aggregate/aggregate_choice.h"
#include "builder/aggregate/coarse_materials.h"
#include "builder/aggregate/material_looks.h"
#include "builder/aggregate/mesh_parts.h"
#include "builder/dag/aggregate_dag.h"
#include "builder/dag/build_dag.h"
#include "builder/encode/attribute_steps.h"
#include "builder/encode/encode.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/hooks.h"
#include "builder/measure/measure.h"
#include "builder/needs.h"
#include "builder/plan/features.h"
#include "builder/plan/plan.h"
#include "builder/plan/texel_sizes.h"
#include "builder/prepare/prepare.h"
#include "builder/progress_meter.h"
#include "builder/promise/measure_promise.h"
#include "builder/promise/painted_source.h"
#include "builder/stage_clock.h"
#include "builder/stage_options.h"
#include "builder/store/mesh_key.h"
#include "builder/store/mesh_store.h"
#include "builder/store/stored_mesh.h"
#include "builder/write/write.h"
#include "builder/write_meta.h"

namespace meshlode::builder {

namespace {

/// Refuses what cannot be built, before any mesh is.
Status check_build(const scene::Scene& scene, const PipelineOptions& options) {
  if (const Status s = check_options(options, scene.meshes.size()); !s) return s.error();
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const std::string label = mesh_label(scene.meshes[i], i);
    if (const Status counts = check_mesh_counts(count_mesh(scene.meshes[i]), label); !counts) return counts.error();
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

struct BuiltMesh {
  EncodedMesh encoded;
  std::vector<PlanDecision> decisions;
  StageClock clock;
  std::vector<LevelTime> levels;
  bool was_stored = false;
};

/// Where PipelineOptions::mesh_store may have one mesh, or will be given it.
struct StoredPlace {
  MeshStore* store = nullptr;  ///< none: it is not asked
  Hash128 key{};

  StoredPlace() = default;
  StoredPlace(const scene::SourceMesh& source, const AttributeLayout& layout, const EncodeOptions& encoding,
              const MeshOptions& own, const SceneOptions& options, std::span<const TexelExtents> extents) {
    if (options.mesh_store == nullptr || !options.mesh_store->wants(count_mesh(source).triangles)) return;
    store = options.mesh_store;
    key = mesh_key(source, layout, encoding, own, options, extents);
  }

  /// What was kept becomes `built`. False: nothing was.
  [[nodiscard]] bool take(const std::string& label, BuiltMesh& built) const {
    const auto bytes = store != nullptr ? store->find(key) : std::nullopt;
    auto mesh = bytes ? read_stored_mesh(*bytes, label) : std::nullopt;
    if (!mesh) return false;
    built.encoded = std::move(mesh->encoded);
    built.decisions.insert(built.decisions.end(), mesh->decisions.begin(), mesh->decisions.end());
    built.was_stored = true;
    return true;
  }

  void keep(const BuiltMesh& built, std::size_t first_decision, const std::string& label) const {
    if (store == nullptr) return;
    store->keep(key, stored_mesh_bytes(built.encoded, std::span(built.decisions).subspan(first_decision), label));
  }
};

/// The scene, and itself once more where it may be taken apart.
struct Source {
  const scene::Scene& scene;
  scene::Scene* owned = nullptr;

  void free_mesh(std::size_t index) const {
    if (owned == nullptr) return;
    for (scene::Primitive& primitive : owned->meshes[index].primitives) {
      const MaterialId material = primitive.material;
      primitive = {};
      primitive.material = material;
    }
  }
};

/// What is found out about the whole scene before any mesh is built.
struct Survey {
  std::vector<std::array<double, scene::kMaxUvSets>> texels;  ///< texels_of_materials()
  std::vector<TexelExtents> extents;          ///< texel_extents_of_materials(), where more than positions is promised
  std::vector<AggregateDecision> aggregates;  ///< by mesh
  CoarseMaterials coarse;                     ///< where some mesh has an aggregate
  [[nodiscard]] bool has_aggregates() const {
    return std::any_of(aggregates.begin(), aggregates.end(), [](const AggregateDecision& d) { return d.is_aggregate; });
  }
};

/// By mesh.
std::vector<AggregateDecision> decide_aggregates(const scene::Scene& scene, const PipelineOptions& options) {
  std::vector<AggregateDecision> decisions;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    decisions.push_back(decide_aggregate(scene.meshes[i], aggregate_question(scene, i, options)));
  }
  return decisions;
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
  Result<CoarseMaterials> coarse = derive_materials(scene, is_used, looks);
  if (!coarse) return coarse.error();
  found.coarse = std::move(*coarse);
  return found;
}

/// format::kPromises….
std::uint32_t promises_of(format::Promise promise) {
  switch (promise) {
    case format::Promise::kPosition: break;
    case format::Promise::kTexels: return format::kPromisesTexels;
    case format::Promise::kAppearance: return format::kPromisesTexels | format::kPromisesAppearance;
  }
  return 0;
}

/// The levels of one prepared mesh, whose surface is freed: by coverage where it is an aggregate, else by distances.
Result<LodDag> build_levels(PreparedMesh& mesh, bool is_aggregate, const Survey& found, const PaintedUnits& painted,
                            const PipelineOptions& options, const MeshOptions& own, const EncodeOptions& encoding,
                            const std::function<bool(std::uint32_t, std::uint64_t)>& on_level) {
  DagOptions coarsening = dag_options(options, mesh, encoding);
  coarsening.on_level = on_level;
  coarsening.simplify.painted = painted;
  if (own.error_tier == format::ErrorTier::kQem) {
    release(mesh.exact_positions, mesh.exact_on_grid, mesh.exact_triangles);
  }
  Result<LodDag> dag = is_aggregate ? build_aggregate_dag_and_free(mesh, found.coarse.of_source, coarsening)
                                    : build_dag_and_free(mesh, coarsening);
  if (!dag) return dag;
  if (own.error_tier != format::ErrorTier::kQem) snap_attributes(mesh.layout, encoding, *dag);
  const Status status = measure_and_free(mesh, own.error_tier, *dag);
  return status ? std::move(dag) : status.error();
}

/// One mesh from its source triangles to pages.
Result<BuiltMesh> build_mesh(const Source& from, std::size_t index, const Survey& found, const PipelineOptions& options,
                             ProgressMeter& progress) {
  const scene::SourceMesh& source = from.scene.meshes[index];
  const std::string label = mesh_label(source, index);
  const MeshOptions& own = options.of_mesh(index);
  BuiltMesh built;

  MeshPlan plan = plan_mesh(source, from.scene.materials, request_of(own, options.promise), label);
  built.decisions = std::move(plan.decisions);
  const AggregateDecision& aggregate = found.aggregates[index];
  if (!aggregate.reason.empty()) {
    built.decisions.push_back({label + ": aggregate", aggregate.is_aggregate, aggregate.reason});
  }
  built.clock.end(Stage::kPlan);

  const EncodeOptions encoding = encode_options(options, own, source, plan.layout, found.texels);
  // What an aggregate becomes depends on images too: the key would have to have them.
  const StoredPlace place =
      aggregate.is_aggregate ? StoredPlace() : StoredPlace(source, plan.layout, encoding, own, options, found.extents);
  const std::size_t planned = built.decisions.size();
  if (place.take(label, built)) {
    from.free_mesh(index);
    if (!progress.report(index, 0, 0)) return Error{ErrorCode::kBuildFailed, label, "cancelled"};
    return built;
  }

  const std::uint32_t promises = promises_of(options.promise);
  const bool is_painted = promises != 0;  // an aggregate may come to have no level but the finest, which promises too
  PrepareOptions preparing = prepare_options(own);
  if (options.hooks != nullptr) preparing.separates_needles = options.hooks->separates_needles;
  preparing.keeps_flat_normals = is_painted && options.promise == format::Promise::kAppearance;
  Result<PreparedMesh> mesh = prepare_mesh(source, plan.layout, preparing);
  if (!mesh) return mesh.error();
  const UvUnits uv_units = is_painted ? uv_units_of(source, plan.layout, found.extents) : UvUnits{};
  from.free_mesh(index);
  built.clock.end(Stage::kPrepare);

  std::optional<PaintedSource> painted;
  if (is_painted) {
    painted = keep_painted_source(*mesh, uv_units, options.promise == format::Promise::kAppearance,
                                  own.error_tier == format::ErrorTier::kCertified);
  }
  const PaintedUnits units = painted ? units_to_simplify_by(*painted, mesh->diagonal) : PaintedUnits();
  const DagOptions coarsening = dag_options(options, *mesh, encoding);
  LevelClock levels(index);
  const Result<LodDag> dag = build_levels(*mesh, aggregate.is_aggregate, found, units, options, own, encoding,
                                          [&](std::uint32_t level, std::uint64_t triangles) {
                                            levels.end(level, triangles);
                                            return progress.report(index, level, triangles);
                                          });
  if (!dag) return Error{dag.error().code, label, dag.error().detail};
  built.levels = levels.times();
  built.clock.end(Stage::kDag);

  const Hierarchy hierarchy =
      build_hierarchy(*dag, *mesh, options.hooks != nullptr ? options.hooks->enclosing_ball : enclosing_ball);
  built.clock.end(Stage::kHierarchy);

  Result<EncodedMesh> encoded = encode_mesh(*mesh, *dag, hierarchy, encoding);
  if (!encoded) return encoded.error();
  built.encoded = std::move(*encoded);
  built.encoded.record.error_tier = own.error_tier;
  if (promises != 0) {
    const format::MeshRecord& record = built.encoded.record;
    const double margin = own.error_tier == format::ErrorTier::kCertified ? 1.0 : kMeasuredMargin;
    PromiseErrors errors = painted && !has_aggregates(built.encoded.groups)
                               ? measure_promises(*painted, *dag, record, built.encoded.groups, margin, promises)
                               : promises_of_positions(record, built.encoded.groups, promises);
    built.encoded.promise = errors.mesh;
    built.encoded.promise_errors = std::move(errors.groups);
  }
  const bool keeps_area = coarsening.simplify.keep_area && !aggregate.is_aggregate;  // there nothing collapses
  for (PlanDecision& decision : late_decisions(own, *mesh, keeps_area, encoding, built.encoded, label)) {
    built.decisions.push_back(std::move(decision));
  }
  place.keep(built, planned, label);
  built.clock.end(Stage::kEncode);
  return built;
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

Result<std::vector<std::uint8_t>> build_asset_of(const Source& given, PipelineOptions options,
                                                 const ProgressCallback& progress, PipelineReport& report) {
  if (const Status s = check_build(given.scene, options); !s) return s.error();
  std::vector<AggregateDecision> aggregates = decide_aggregates(given.scene, options);
  const Result<MemoryFit> fit = check_memory(given.scene, options, aggregates, report);
  if (!fit) return fit.error();
  Result<Survey> found = survey(given.scene, options, std::move(aggregates));
  if (!found) return found.error();
  const std::vector<scene::MeshPart> parts = plan_parts(given.scene, found->aggregates, options);
  std::optional<scene::Scene> split;  // what is the caller's own stays as it is
  if (!parts.empty()) scene::split_parts(given.owned != nullptr ? *given.owned : split.emplace(given.scene), parts);
  const Source from = split ? Source{*split, &*split} : given;
  const scene::Scene& scene = from.scene;
  Result<std::vector<BuiltMesh>> meshes =
      with_threads_at_most(fit->threads, [&] { return build_meshes(from, options, *found, fit->at_once, progress); });
  if (!meshes) return meshes.error();

  WriteInput input;
  input.scene = &scene;
  input.codec = options.codec;
  input.promises = promises_of(options.promise);
  // Where all of them ended at level 0 nothing has such a material.
  if (std::any_of(meshes->begin(), meshes->end(),
                  [](const BuiltMesh& mesh) { return has_aggregates(mesh.encoded.groups); })) {
    input.materials = &found->coarse.materials;
    input.document = &found->coarse.document;
  }
  report.decisions.clear();
  report.levels.clear();
  report.stored_meshes = 0;
  report.clusters = 0;
  for (std::size_t i = 0; i < meshes->size(); ++i) {
    BuiltMesh& mesh = (*meshes)[i];
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
  input.meta_json = meta_json(scene, options, report.decisions, parts);

  StageClock clock;
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
