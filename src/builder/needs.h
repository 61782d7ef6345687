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

/// What the whole process will take at most, the scene included: so much from the beginning to the end, and so much
/// more while a mesh is in work. Measured (docs/performance.md, "Memory") and meant to be a little more than what will
/// be found.
struct MemoryEstimate {
  std::uint64_t always = 0;            ///< bytes, never 0
  std::vector<std::uint64_t> working;  ///< bytes by mesh, the largest first
  /// Where large arrays go to a file (PipelineOptions::spills): what is too small for that, and room to work in.
  std::uint64_t spilled = 0;

  /// With so many meshes in work at once: the largest, at worst.
  [[nodiscard]] std::uint64_t bytes(std::size_t at_once) const;
};

/// `aggregates`: by mesh; none where there are none.
[[nodiscard]] MemoryEstimate estimate_memory(const scene::Scene& scene, const PipelineOptions& options,
                                             std::uint32_t threads, std::span<const AggregateDecision> aggregates = {});

/// How many meshes may be in work at once, at most one a thread: fewer where memory asks for it, down to one after
/// another. The limit is PipelineOptions::max_memory or, where that is 0, what the process has and the machine can
/// still give it. Error: kBuildFailed where one at a time is too much, and spilling does not help.
[[nodiscard]] Result<std::size_t> fit_memory(const MemoryEstimate& estimate, std::uint32_t threads,
                                             const PipelineOptions& options);

/// How many of the threads that an estimate is of build one mesh under a limit: as many as fit, each with what it has
/// in hand. Where not even two do, large arrays go to a file, and one for each 128 MiB, two at least: each that comes
/// to the file here and there brings more into memory than it asks for, and sooner than it can be taken out again
/// (sixteen under 1 GiB went beyond it, and were no quicker than eight).
[[nodiscard]] std::uint32_t threads_within(const MemoryEstimate& estimate, std::uint32_t threads, std::uint64_t limit);

}  // namespace meshlode::builder
