// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/build_mesh.h"

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/release.h"
#include "base/try.h"
#include "builder/dag/aggregate_dag.h"
#include "builder/dag/build_dag.h"
#include "builder/encode/attribute_steps.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/hooks.h"
#include "builder/measure/measure.h"
#include "builder/needs.h"
#include "builder/order/covisible_order.h"
#include "builder/prepare/prepare.h"
#include "builder/promise/measure_promise.h"
#include "builder/promise/painted_source.h"
#include "builder/stage_options.h"
#include "builder/store/mesh_key.h"
#include "builder/store/mesh_store.h"
#include "builder/store/stored_mesh.h"

namespace meshlode::builder {

namespace {

/// Where PipelineOptions::mesh_store may have one mesh, or will be given it.
struct StoredPlace {
  MeshStore* store = nullptr;  ///< none: it is not asked
  Hash128 key{};

  StoredPlace() = default;
  StoredPlace(const scene::SourceMesh& source, const AttributeLayout& layout, const EncodeOptions& encoding,
              const MeshOptions& own, const SceneOptions& options, std::span<const TexelExtents> extents,
              const MeshGaps& gaps) {
    if (options.mesh_store == nullptr || !options.mesh_store->wants(count_mesh(source).triangles)) return;
    store = options.mesh_store;
    key = mesh_key(source, layout, encoding, own, options, extents, gaps);
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

/// The levels of one prepared mesh, whose surface is freed: by coverage where it is an aggregate, else by distances.
Result<LodDag> build_levels(PreparedMesh& mesh, bool is_aggregate, const Survey& found, const DagOptions& coarsening,
                            format::ErrorTier tier) {
  if (tier == format::ErrorTier::kQem) release(mesh.exact_positions, mesh.exact_on_grid, mesh.exact_triangles);
  return is_aggregate ? build_aggregate_dag_and_free(mesh, found.coarse.of_source, coarsening)
                      : build_dag_and_free(mesh, coarsening);
}

}  // namespace

std::uint32_t promises_of(format::Promise promise) {
  switch (promise) {
    case format::Promise::kPosition: break;
    case format::Promise::kTexels: return format::kPromisesTexels;
    case format::Promise::kAppearance: return format::kPromisesTexels | format::kPromisesAppearance;
  }
  return 0;
}

Result<BuiltMesh> build_mesh(const Source& from, std::size_t index, const Survey& found, const PipelineOptions& options,
                             ProgressMeter& progress) {
  const scene::SourceMesh& source = from.scene.meshes[index];
  const std::string label = mesh_label(source, index);
  const MeshOptions& own = options.of_mesh(index);
  BuiltMesh built;

  MeshPlan plan = plan_mesh(source, from.scene.materials, request_of(own, options.promise), label);
  built.decisions = std::move(plan.decisions);
  const MeshGaps& gaps = found.gaps[index];
  const AggregateDecision& aggregate = found.aggregates[index];
  if (!aggregate.reason.empty()) {
    built.decisions.push_back({label + ": aggregate", aggregate.is_aggregate, aggregate.reason});
  }
  if (!gaps.codes.empty()) built.decisions.push_back(describe_gaps(gaps, count_mesh(source).triangles, label));
  built.clock.end(Stage::kPlan);

  const EncodeOptions encoding = encode_options(options, own, source, plan.layout, found.texels);
  // What an aggregate becomes depends on images too: the key would have to have them.
  const StoredPlace place = aggregate.is_aggregate
                                ? StoredPlace()
                                : StoredPlace(source, plan.layout, encoding, own, options, found.extents, gaps);
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
  preparing.gaps = gaps.codes;
  preparing.gap_reach = gaps.reach;
  preparing.keeps_flat_normals = is_painted && options.promise == format::Promise::kAppearance;
  TRY_LET(mesh, prepare_mesh(source, plan.layout, preparing));
  const UvUnits uv_units = is_painted ? uv_units_of(source, plan.layout, found.extents) : UvUnits{};
  from.free_mesh(index);
  built.clock.end(Stage::kPrepare);

  std::optional<PaintedSource> painted;
  if (is_painted) {
    painted = keep_painted_source(*mesh, uv_units, options.promise == format::Promise::kAppearance,
                                  own.error_tier == format::ErrorTier::kCertified);
  }
  const PaintedUnits units = painted ? units_to_simplify_by(*painted, mesh->diagonal) : PaintedUnits();
  DagOptions coarsening = dag_options(options, *mesh, encoding);
  coarsening.simplify.painted = units;
  LevelClock levels(index);
  coarsening.on_level = [&](std::uint32_t level, std::uint64_t triangles) {
    levels.end(level, triangles);
    return progress.report(index, level, triangles);
  };
  Result<LodDag> dag = build_levels(*mesh, aggregate.is_aggregate, found, coarsening, own.error_tier);
  if (!dag) return Error{dag.error().code, label, dag.error().detail};
  built.levels = levels.times();
  built.clock.end(Stage::kDag);

  if (own.error_tier != format::ErrorTier::kQem) snap_attributes(mesh->layout, encoding, *dag);
  if (const Status status = measure_and_free(*mesh, own.error_tier, *dag); !status) {
    return Error{status.error().code, label, status.error().detail};
  }
  built.clock.end(Stage::kMeasure);

  Hierarchy hierarchy =
      build_hierarchy(*dag, *mesh, options.hooks != nullptr ? options.hooks->enclosing_ball : enclosing_ball);
  std::vector<ViewBits> needs;
  if (options.page_order == PageOrder::kCovisible) needs = order_by_covisibility(*dag, hierarchy);
  built.clock.end(Stage::kHierarchy);

  TRY_LET(encoded, encode_mesh(*mesh, *dag, hierarchy, encoding, needs));
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

}  // namespace meshlode::builder
