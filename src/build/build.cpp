// SPDX-License-Identifier: GPL-3.0-or-later
// The whole build as one straight line. Read this first, then the rooms in the order they are called.
#include "build/build.h"

#include <array>
#include <span>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "build/dag/build_dag.h"
#include "build/encode/encode.h"
#include "build/hierarchy/hierarchy.h"
#include "build/needs.h"
#include "build/plan/plan.h"
#include "build/plan/texel_sizes.h"
#include "build/prepare/prepare.h"
#include "build/progress_meter.h"
#include "build/stage_clock.h"
#include "build/stage_options.h"
#include "build/write/write.h"
#include "build/write_meta.h"

namespace meshlode::build {

namespace {

std::string label_of(const scene::SourceMesh& mesh, std::size_t index) {
  return "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " '" + mesh.name + "'");
}

/// Refuses what cannot be built, before any work is done.
Status check_build(const scene::Scene& scene, const PipelineOptions& options, PipelineReport& report) {
  if (const Status s = check_options(options); !s) return s;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const std::string label = label_of(scene.meshes[i], i);
    if (const Status counts = check_mesh_counts(count_mesh(scene.meshes[i]), label); !counts) return counts;
  }
  const auto threads = static_cast<std::uint32_t>(tbb::this_task_arena::max_concurrency());
  report.memory_estimate = estimate_memory(scene, options, threads);
  return check_memory(report.memory_estimate, options);
}

struct BuiltMesh {
  EncodedMesh encoded;
  std::vector<PlanDecision> decisions;
  StageClock clock;
};

/// One mesh from its source triangles to pages. `texels`: texels_of_materials() of the scene.
Result<BuiltMesh> build_mesh(const scene::Scene& scene, std::size_t index,
                             std::span<const std::array<double, scene::kMaxUvSets>> texels,
                             const PipelineOptions& options, ProgressMeter& progress) {
  const scene::SourceMesh& source = scene.meshes[index];
  const std::string label = label_of(source, index);
  BuiltMesh built;

  MeshPlan plan = plan_mesh(source, scene.materials, options.attributes, label);
  built.decisions = std::move(plan.decisions);
  built.clock.end(Stage::kPlan);

  const Result<PreparedMesh> mesh = prepare_mesh(source, plan.layout, prepare_options(options));
  if (!mesh) return mesh.error();
  built.clock.end(Stage::kPrepare);

  const EncodeOptions encoding = encode_options(options, source, plan.layout, texels);
  DagOptions coarsening = dag_options(options, *mesh, encoding);
  coarsening.on_level = [&](std::uint32_t level, std::uint64_t triangles) {
    return progress.report(index, level, triangles);
  };
  const Result<LodDag> dag = build_dag(*mesh, coarsening);
  if (!dag) return Error{dag.error().code, label, dag.error().detail};
  built.clock.end(Stage::kDag);

  const Hierarchy hierarchy = build_hierarchy(*dag, *mesh);
  built.clock.end(Stage::kHierarchy);

  Result<EncodedMesh> encoded = encode_mesh(*mesh, *dag, hierarchy, encoding);
  if (!encoded) return encoded.error();
  built.encoded = std::move(*encoded);
  built.encoded.record.error_tier = options.error_tier;
  for (PlanDecision& decision : late_decisions(*mesh, coarsening, encoding, built.encoded, label)) {
    built.decisions.push_back(std::move(decision));
  }
  built.clock.end(Stage::kEncode);
  return built;
}

/// Every mesh once, side by side. Error: the first mesh's that has one.
Result<std::vector<BuiltMesh>> build_meshes(const scene::Scene& scene, const PipelineOptions& options,
                                            const ProgressCallback& progress) {
  ProgressMeter meter(scene, progress);
  const auto texels = texels_of_materials(scene);
  std::vector<Result<BuiltMesh>> results(scene.meshes.size(), Error{});
  parallel_for_each_index(results.size(), 1,
                          [&](std::size_t i) { results[i] = build_mesh(scene, i, texels, options, meter); });
  std::vector<BuiltMesh> meshes;
  for (Result<BuiltMesh>& result : results) {
    if (!result) return result.error();
    meshes.push_back(std::move(*result));
  }
  return meshes;
}

}  // namespace

Result<std::vector<std::uint8_t>> build_lode(const scene::Scene& scene, const PipelineOptions& options,
                                             const ProgressCallback& progress, PipelineReport& report) {
  if (const Status possible = check_build(scene, options, report); !possible) return possible.error();
  Result<std::vector<BuiltMesh>> meshes = build_meshes(scene, options, progress);
  if (!meshes) return meshes.error();

  WriteInput input;
  input.scene = &scene;
  input.codec = options.codec;
  report.decisions.clear();
  for (std::size_t i = 0; i < meshes->size(); ++i) {
    BuiltMesh& mesh = (*meshes)[i];
    mesh.clock.add_to(report.stages);
    report.decisions.insert(report.decisions.end(), mesh.decisions.begin(), mesh.decisions.end());
    input.meshes.push_back(std::move(mesh.encoded));
    input.mesh_names.push_back(scene.meshes[i].name);
  }
  input.meta_json = meta_json(scene, options, report.decisions);

  StageClock clock;
  Result<std::vector<std::uint8_t>> bytes = write_asset(std::move(input));
  clock.end(Stage::kWrite);
  clock.add_to(report.stages);
  return bytes;
}

}  // namespace meshlode::build
