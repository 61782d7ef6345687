// SPDX-License-Identifier: GPL-3.0-or-later
// The whole build as one straight line. Read this first, then the rooms in the order they are called.
#include "build/build.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <mutex>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "build/dag/build_dag.h"
#include "build/encode/encode.h"
#include "build/hierarchy/hierarchy.h"
#include "format/grid.h"
#include "build/write_meta.h"
#include "build/needs.h"
#include "build/plan/plan.h"
#include "build/plan/texel_sizes.h"
#include "build/prepare/prepare.h"
#include "build/write/write.h"

namespace meshlode::build {

namespace {

enum Stage : std::size_t { kPlan, kPrepare, kDag, kHierarchy, kEncode, kWrite, kStageCount };
constexpr const char* kStageNames[kStageCount] = {"plan", "prepare", "dag", "hierarchy", "encode", "write"};

/// Seconds per stage, summed over meshes (which may run side by side).
class StageClock {
 public:
  StageClock() : last_(std::chrono::steady_clock::now()) {}
  void end(Stage stage) {
    const auto now = std::chrono::steady_clock::now();
    seconds_[stage] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  void add_to(std::vector<StageTime>& stages) const {
    if (stages.empty()) {
      for (const char* name : kStageNames) stages.push_back({name, 0.0});
    }
    for (std::size_t s = 0; s < kStageCount; ++s) stages[s].seconds += seconds_[s];
  }

 private:
  std::chrono::steady_clock::time_point last_;
  double seconds_[kStageCount] = {};
};

/// Progress of all meshes together, weighted by triangles: one level of a DAG halves what is left to do.
class ProgressMeter {
 public:
  ProgressMeter(const scene::Scene& scene, const ProgressCallback& callback) : callback_(callback) {
    for (const scene::SourceMesh& mesh : scene.meshes) {
      std::uint64_t triangles = 0;
      for (const scene::Primitive& primitive : mesh.primitives) triangles += primitive.indices.size() / 3;
      source_triangles_.push_back(triangles);
      total_ += triangles;
      remaining_.push_back(triangles);
    }
  }

  bool report(const scene::Scene& scene, std::size_t mesh, std::uint32_t level, std::uint64_t triangles) {
    const std::lock_guard lock(mutex_);
    if (is_cancelled_) return false;
    remaining_[mesh] = std::min(remaining_[mesh], triangles);
    if (!callback_) return true;
    std::uint64_t left = 0;
    for (const std::uint64_t r : remaining_) left += r;
    ProgressEvent event;
    event.mesh = static_cast<std::uint32_t>(mesh);
    event.mesh_count = static_cast<std::uint32_t>(scene.meshes.size());
    event.mesh_name = scene.meshes[mesh].name;
    event.level = level;
    event.triangles = triangles;
    event.fraction = total_ == 0 ? 1.0 : 1.0 - static_cast<double>(left) / static_cast<double>(total_);
    is_cancelled_ = !callback_(event);
    return !is_cancelled_;
  }

 private:
  const ProgressCallback& callback_;
  std::mutex mutex_;
  std::vector<std::uint64_t> source_triangles_, remaining_;
  std::uint64_t total_ = 0;
  bool is_cancelled_ = false;
};

struct BuiltMesh {
  EncodedMesh encoded;
  std::vector<PlanDecision> decisions;
  StageClock clock;
};

std::string label_of(const scene::SourceMesh& mesh, std::size_t index) {
  return "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " '" + mesh.name + "'");
}

/// Foliage and soups: so many pieces so small that they are seen together, not one by one.
bool is_aggregate(const PreparedMesh& mesh) {
  constexpr std::uint64_t kFewestPieces = 64;
  constexpr std::uint64_t kLargestPiece = 64;  // triangles, on average
  return mesh.piece_count >= kFewestPieces && mesh.triangles.size() <= kLargestPiece * mesh.piece_count;
}

ErrorSource error_source_of(format::ErrorTier tier) {
  switch (tier) {
    case format::ErrorTier::kMeasured: return ErrorSource::kMeasured;
    case format::ErrorTier::kCertified: return ErrorSource::kCertified;
    case format::ErrorTier::kQem: break;
  }
  return ErrorSource::kQuadric;
}

/// The budget of each stored UV set in UV units; 0 leaves it to encode, where no texture's size is known.
std::array<double, scene::kMaxUvSets> uv_errors(std::span<const std::array<double, scene::kMaxUvSets>> texels_of_materials,
                                         const scene::SourceMesh& source, const AttributeLayout& layout,
                                         const PipelineOptions& options) {
  std::array<double, scene::kMaxUvSets> errors{};
  if (!options.uv_error_is_texels) {
    errors.fill(options.uv_error);
    return errors;
  }
  constexpr double kUsualTexels = 2048.0;  // of a texture whose size is not known
  const std::array<double, scene::kMaxUvSets> texels = texels_per_unit(texels_of_materials, source);
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    const double known = texels[layout.uv_set_source[set]];
    if (options.uv_error_is_default) {
      errors[set] = known > 0.0 ? options.uv_error / std::max(known, kUsualTexels) : 0.0;
    } else {
      errors[set] = options.uv_error / (known > 0.0 ? known : kUsualTexels);
    }
  }
  return errors;
}

Result<BuiltMesh> build_mesh(const scene::Scene& scene, std::size_t index,
                             std::span<const std::array<double, scene::kMaxUvSets>> texels, const PipelineOptions& options,
                             ProgressMeter& progress) {
  const scene::SourceMesh& source = scene.meshes[index];
  BuiltMesh built;

  MeshPlan plan = plan_mesh(source, scene.materials, options.attributes, label_of(source, index));
  built.decisions = std::move(plan.decisions);
  built.clock.end(kPlan);

  PrepareOptions prepare_options;
  prepare_options.grid_step = options.grid_step;
  prepare_options.position_error = options.position_error;
  Result<PreparedMesh> mesh = prepare_mesh(source, plan.layout, prepare_options);
  if (!mesh) return mesh.error();
  built.clock.end(kPrepare);

  EncodeOptions encode_options;
  encode_options.normal_error = options.normal_error;
  encode_options.uv_error = uv_errors(texels, source, plan.layout, options);
  encode_options.uv_error_may_fall_short = options.uv_error_is_default;
  DagOptions dag_options;
  dag_options.error = error_source_of(options.error_tier);
  dag_options.caps.max_triangles = options.max_cluster_triangles;
  dag_options.caps.max_vertices = options.max_cluster_vertices;
  dag_options.caps.target_triangles = options.max_cluster_triangles - std::min(2U, options.max_cluster_triangles / 16);
  dag_options.simplify.keep_area = is_aggregate(*mesh);
  if (dag_options.simplify.keep_area) {
    built.decisions.push_back({label_of(source, index) + ": covered area", true,
                               std::to_string(mesh->piece_count) + " loose pieces: those that stay grow when others go"});
  }
  dag_options.max_group_bytes = format::kMaxPageBytes - kPageFrameBytes;
  dag_options.cluster_bytes = [&](std::uint32_t vertices, std::uint32_t triangles, std::uint32_t materials) {
    return max_cluster_bytes(mesh->layout, encode_options, vertices, triangles, materials);
  };
  dag_options.on_level = [&](std::uint32_t level, std::uint64_t triangles) {
    return progress.report(scene, index, level, triangles);
  };
  const Result<LodDag> dag = build_dag(*mesh, dag_options);
  if (!dag) return Error{dag.error().code, label_of(source, index), dag.error().detail};
  built.clock.end(kDag);

  const Hierarchy hierarchy = build_hierarchy(*dag, *mesh);
  built.clock.end(kHierarchy);

  Result<EncodedMesh> encoded = encode_mesh(*mesh, *dag, hierarchy, encode_options);
  if (!encoded) return encoded.error();
  built.encoded = std::move(*encoded);
  for (std::uint32_t set = 0; set < mesh->layout.uv_set_count; ++set) {
    const double asked = encode_options.uv_error[set], kept = 0.5 * format::exp2_exact(built.encoded.record.uv_log2[set]);
    if (!(asked > 0.0) || kept <= asked) continue;
    built.decisions.push_back({label_of(source, index) + ": TEXCOORD_" + std::to_string(mesh->layout.uv_set_source[set]) + ", accuracy", true,
                               "its coordinates are so large that they are kept as finely as floats hold the largest"});
  }
  built.encoded.record.error_tier = options.error_tier;
  built.clock.end(kEncode);
  return built;
}

}  // namespace

Result<std::vector<std::uint8_t>> build_lode(const scene::Scene& scene, const PipelineOptions& options,
                                             const ProgressCallback& progress, PipelineReport& report) {
  if (options.max_cluster_triangles == 0 || options.max_cluster_triangles > format::kMaxClusterTriangles ||
      options.max_cluster_vertices < 3 || options.max_cluster_vertices > format::kMaxClusterVertices) {
    return Error{ErrorCode::kUsage, "", "a cluster holds 1 to 256 triangles and 3 to 256 vertices"};
  }

  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const Status counts = check_mesh_counts(count_mesh(scene.meshes[i]), label_of(scene.meshes[i], i));
    if (!counts) return counts.error();
  }
  report.memory_estimate = estimate_memory(scene, options, static_cast<std::uint32_t>(tbb::this_task_arena::max_concurrency()));
  if (const Status memory = check_memory(report.memory_estimate, options); !memory) return memory.error();

  ProgressMeter meter(scene, progress);
  const auto texels = texels_of_materials(scene);
  std::vector<Result<BuiltMesh>> meshes(scene.meshes.size(), Error{});
  parallel_for_each_index(scene.meshes.size(), 1, [&](std::size_t i) { meshes[i] = build_mesh(scene, i, texels, options, meter); });

  WriteInput input;
  input.scene = &scene;
  input.codec = options.codec;
  std::vector<PlanDecision> decisions;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (!meshes[i]) return meshes[i].error();
    meshes[i]->clock.add_to(report.stages);
    decisions.insert(decisions.end(), meshes[i]->decisions.begin(), meshes[i]->decisions.end());
    input.meshes.push_back(std::move(meshes[i]->encoded));
    input.mesh_names.push_back(scene.meshes[i].name);
  }
  input.meta_json = meta_json(scene, options, decisions);
  report.decisions = std::move(decisions);
  StageClock clock;
  Result<std::vector<std::uint8_t>> bytes = write_asset(std::move(input));
  clock.end(kWrite);
  clock.add_to(report.stages);
  return bytes;
}

}  // namespace meshlode::build
