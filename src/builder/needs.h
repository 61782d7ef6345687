// SPDX-License-Identifier: GPL-3.0-or-later
// What a build will need, known before it begins: counts that fit the ids of a mesh, and memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/options.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Of one mesh, all primitives together.
struct MeshCounts {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  ///< those of the source, or a triangle's three where flat normals are made
};
[[nodiscard]] MeshCounts count_mesh(const scene::SourceMesh& mesh);

/// Every level keeps at most 85% of the finer one's triangles, or ends (a stuck group emits nothing): all levels
/// together have less than 6.67 times the source's, of three corners each, and ids of corners have 32 bits.
constexpr std::uint64_t kMaxMeshTriangles = 214000000;
constexpr std::uint64_t kMaxMeshVertices = 4294967295;

/// Error: kUnsupported, naming the mesh, its count and the limit.
[[nodiscard]] Status check_mesh_counts(const MeshCounts& counts, const std::string& mesh);

/// Materials of a scene: with those that aggregates derive from them, a triangle's label has room for twice as many
/// (gap_label.h).
constexpr std::uint64_t kMaxMaterials = 8'388'607;
/// Error: kUnsupported, more materials than kMaxMaterials.
[[nodiscard]] Status check_material_count(std::uint64_t count);

/// What the whole process will take at most, the scene included: so much from the beginning to the end, and so much
/// more while a mesh is in work. Measured (docs/log/build-time.md, "Memory") and meant to be a little more than what
/// will be found.
struct MemoryEstimate {
  struct Mesh {
    std::uint64_t bytes = 0;
    std::size_t mesh = 0;  ///< of the scene
  };
  std::uint64_t always = 0;   ///< bytes, never 0
  std::vector<Mesh> working;  ///< the largest first

  /// With so many meshes in work at once, the largest at worst, by so many threads.
  [[nodiscard]] std::uint64_t bytes(std::size_t at_once, std::uint32_t threads) const;
};

/// `aggregates`: by mesh; none where there are none.
[[nodiscard]] MemoryEstimate estimate_memory(const scene::Scene& scene, const PipelineOptions& options,
                                             std::span<const AggregateDecision> aggregates = {});

struct MemoryFit {
  std::size_t at_once = 1;    ///< meshes in work
  std::uint32_t threads = 1;  ///< of the whole build
};

/// As many meshes in work at once as memory has room for, at most one a thread; where not even one fits, with fewer
/// threads. The limit is `max_memory` or, where that is 0, what the process has and the machine can still give it.
/// Error: kBuildFailed, naming the largest mesh of `scene`, where one at a time by one thread is too much.
[[nodiscard]] Result<MemoryFit> fit_memory(const MemoryEstimate& estimate, const scene::Scene& scene,
                                           std::uint32_t threads, std::uint64_t max_memory);

}  // namespace meshlode::builder
