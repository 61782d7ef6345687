// SPDX-License-Identifier: GPL-3.0-or-later
// What a build will need, known before it begins: counts that fit the ids of a mesh, and memory.
#pragma once

#include <cstdint>

#include <meshlode/result.h>

#include "build/build.h"
#include "scene/scene.h"

namespace meshlode::build {

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

/// Bytes that the whole process will take at most while it builds this scene on that many threads, the scene included.
/// Measured (docs/performance.md, "Memory") and meant to be a little more than what will be found: never 0.
[[nodiscard]] std::uint64_t estimate_memory(const scene::Scene& scene, const PipelineOptions& options,
                                            std::uint32_t threads);

/// Error: kBuildFailed where the estimate is more than PipelineOptions::max_memory, or, where that is 0, than what the
/// process has and the machine can still give it.
[[nodiscard]] Status check_memory(std::uint64_t estimate, const PipelineOptions& options);

}  // namespace meshlode::build
