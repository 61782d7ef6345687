// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/stage_options.h"

#include <algorithm>

#include "builder/hooks.h"
#include "builder/plan/texel_sizes.h"
#include "builder/preset.h"
#include "format/grid.h"
#include "format/names.h"

namespace meshlode::builder {

namespace {

/// The budget of each stored UV set in UV units; 0 leaves it to encode, where no texture's size is known.
std::array<double, scene::kMaxUvSets> uv_errors(const MeshOptions& options, const scene::SourceMesh& source,
                                                const AttributeLayout& layout,
                                                std::span<const std::array<double, scene::kMaxUvSets>> texels) {
  std::array<double, scene::kMaxUvSets> errors{};
  if (!options.uv_error_is_texels) {
    errors.fill(options.uv_error);
    return errors;
  }
  constexpr double kUsualTexels = 2048.0;  // of a texture whose size is not known
  const std::array<double, scene::kMaxUvSets> per_unit = texels_per_unit(texels, source);
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    const double known = per_unit[layout.uv_set_source[set]];
    if (options.uv_error_is_default) {
      errors[set] = known > 0.0 ? options.uv_error / std::max(known, kUsualTexels) : 0.0;
    } else {
      errors[set] = options.uv_error / (known > 0.0 ? known : kUsualTexels);
    }
  }
  return errors;
}

}  // namespace

bool are_seen_together(std::uint64_t pieces, std::uint64_t triangles) {
  constexpr std::uint64_t kFewestPieces = 64;
  constexpr std::uint64_t kLargestPiece = 64;  // triangles, on average
  return pieces >= kFewestPieces && triangles <= kLargestPiece * pieces;
}

Status check_options(const PipelineOptions& options, std::size_t mesh_count) {
  if (options.max_cluster_triangles == 0 || options.max_cluster_triangles > format::kMaxClusterTriangles ||
      options.max_cluster_vertices < 3 || options.max_cluster_vertices > format::kMaxClusterVertices) {
    return Error{ErrorCode::kUsage, "", "a cluster holds 1 to 256 triangles and 3 to 256 vertices"};
  }
  if (options.group_clusters < kFewestGroupClusters || options.group_clusters > kMostGroupClusters) {
    return Error{ErrorCode::kUsage, "", "a group aims at 4 to 32 clusters"};
  }
  if (!is_page_size(options.page_kib)) return Error{ErrorCode::kUsage, "", "a page has 16, 32, 64 or 128 KiB"};
  if (!is_root_size(options.root_bytes)) {
    return Error{ErrorCode::kUsage, "", "the first page has 16384 to 131072 bytes"};
  }
  if (!options.mesh_options.empty() && options.mesh_options.size() != mesh_count) {
    return Error{ErrorCode::kUsage, "", "options of meshes are as many as there are meshes"};
  }
  const bool heeds_all = options.hooks == nullptr || options.hooks->heeds_all_options;
  if (options.keep_topology && !heeds_all) {
    return Error{ErrorCode::kUsage, "", "topology is kept by the own simplifier alone"};
  }
  for (std::size_t i = 0; i < mesh_count; ++i) {
    const MeshOptions& own = options.of_mesh(i);
    if (own.lock_borders && !heeds_all) {
      return Error{ErrorCode::kUsage, "", "borders are locked by the own simplifier alone"};
    }
    if ((own.keep & own.drop) == 0) continue;
    return Error{ErrorCode::kUsage, "", "an attribute cannot be both kept and dropped"};
  }
  return Ok{};
}

AttributeRequest request_of(const MeshOptions& options, format::Promise promise) {
  return {options.attributes, options.keep, options.drop, promise == format::Promise::kAppearance};
}

PrepareOptions prepare_options(const MeshOptions& options) {
  PrepareOptions prepare;
  prepare.grid_step = options.grid_step;
  prepare.position_error = options.position_error;
  prepare.locks_borders = options.lock_borders;
  return prepare;
}

EncodeOptions encode_options(const SceneOptions& whole, const MeshOptions& options, const scene::SourceMesh& source,
                             const AttributeLayout& layout,
                             std::span<const std::array<double, scene::kMaxUvSets>> texels) {
  EncodeOptions encode;
  encode.normal_error = options.normal_error;
  encode.uv_error = uv_errors(options, source, layout, texels);
  encode.uv_error_may_fall_short = options.uv_error_is_default;
  const PresetSettings& effort = settings_of(whole.strip_effort, whole.preset);
  encode.strip_trials = effort.strip_trials;
  encode.mixed_strip_trials = effort.mixed_strip_trials;
  encode.page_bytes = whole.page_kib * 1024;
  encode.first_page_bytes = whole.root_bytes > 0 ? whole.root_bytes : encode.page_bytes;
  return encode;
}

DagOptions dag_options(const PipelineOptions& options, const PreparedMesh& mesh, const EncodeOptions& encode) {
  DagOptions dag;
  dag.caps.max_triangles = options.max_cluster_triangles;
  dag.caps.max_vertices = options.max_cluster_vertices;
  dag.caps.target_triangles = options.max_cluster_triangles - std::min(2U, options.max_cluster_triangles / 16);
  dag.caps.seed = options.partition_seed;
  dag.grouping.seed = options.partition_seed;
  dag.grouping.target_clusters = options.group_clusters;
  dag.caps.merge_triangles = mesh.triangles.size() >= settings_of(options.preset).merged_from;
  dag.simplify.keep_topology = options.keep_topology;
  dag.simplify.keep_area = !options.keep_topology && are_seen_together(mesh.piece_count, mesh.triangles.size());
  if (options.hooks != nullptr) dag.simplify_group = options.hooks->simplify_group;
  dag.max_group_bytes = format::kMaxPageBytes - kPageFrameBytes;
  dag.cluster_bytes = [&mesh, encode](std::uint32_t vertices, std::uint32_t triangles, std::uint32_t materials) {
    return max_cluster_bytes(mesh.layout, encode, vertices, triangles, materials);
  };
  return dag;
}

AggregateQuestion aggregate_question(const scene::Scene& scene, std::size_t mesh, const PipelineOptions& options) {
  const MeshOptions& own = options.of_mesh(mesh);
  return {own.aggregate, own.aggregate_names, options.keep_topology, own.lock_borders, scene.materials};
}

std::vector<PlanDecision> unknown_names(const scene::Scene& scene, const PipelineOptions& options) {
  std::vector<std::string> asked;
  const auto ask = [&](const MeshOptions& own) {
    if (own.aggregate == AggregateChoice::kNamed) asked.push_back(own.aggregate_names);
  };
  ask(options);
  for (const MeshOptions& own : options.mesh_options) ask(own);
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
  std::vector<PlanDecision> decisions;
  for (const std::string& names : asked) {
    for (const std::string& name : find_unknown_names(scene, names)) {
      decisions.push_back(
          {std::string(kUnknownAggregate) + name + "'", false, "no mesh and no material has that name", true});
      decisions.back().mesh = format::kNone;
    }
  }
  return decisions;
}

namespace {

/// From this share of level 0 on it is said that triangles have no area.
constexpr double kManyFlat = 0.5;

std::uint64_t count_finest(const EncodedMesh& encoded) {
  std::uint64_t triangles = 0;
  for (const format::ClusterRecord& cluster : encoded.clusters) {
    if (cluster.level == 0) triangles += cluster.triangles_less_1 + std::uint64_t{1};
  }
  return triangles;
}

}  // namespace

std::vector<PlanDecision> late_decisions(const MeshOptions& own, const PreparedMesh& mesh, bool keeps_area,
                                         const EncodeOptions& encode, const EncodedMesh& encoded,
                                         const std::string& label) {
  std::vector<PlanDecision> decisions;
  if (keeps_area) {
    decisions.push_back({label + ": covered area", true,
                         std::to_string(mesh.piece_count) + " loose pieces: those that stay grow when others go"});
  }
  if (!mesh.is_border_locked.empty()) {
    const auto locked = std::count(mesh.is_border_locked.begin(), mesh.is_border_locked.end(), 1);
    decisions.push_back({label + ": borders", true,
                         std::to_string(locked) + " positions of open borders are locked: every cut has them" +
                             (own.grid_step > 0.0 ? "" : "; meshes that are to abut take one --grid too")});
  }
  const std::uint64_t finest = count_finest(encoded), flat = encoded.record.grid_collapsed;
  if (flat > 0 && static_cast<double>(flat) >= kManyFlat * static_cast<double>(finest)) {
    decisions.push_back({label + ": area on the position grid", false,
                         std::to_string(flat) + " of " + std::to_string(finest) +
                             " triangles have none: a smaller --position-error keeps what the source has",
                         true});
  }
  for (std::uint32_t set = 0; set < mesh.layout.uv_set_count; ++set) {
    const double asked = encode.uv_error[set], kept = 0.5 * format::exp2_exact(encoded.record.uv_log2[set]);
    if (!(asked > 0.0) || kept <= asked) continue;
    decisions.push_back({label + ": TEXCOORD_" + std::to_string(mesh.layout.uv_set_source[set]) + ", accuracy", true,
                         "its coordinates are so large that they are kept as finely as floats hold the largest"});
  }
  return decisions;
}

}  // namespace meshlode::builder
