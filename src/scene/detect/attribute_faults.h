// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of normals, texture coordinates and materials. Each function looks for one; `count` 0: none.
#pragma once

#include <span>

#include "scene/detect/fault.h"
#include "scene/detect/topology.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Across a smaller angle than this two triangles are thought to be meant as one smooth surface; degrees.
constexpr double kSmoothDegrees = 20.0;
/// Wedges that differ in their normals among triangles that smooth edges join around a point, beyond the first: where
/// they are a hundredth of the points or more. A mesh whose normals are its triangles' own is flat, which costs nothing
/// (a build stores none) and is no fault.
[[nodiscard]] Fault find_split_normals(const SourceMesh& mesh, const Topology& topology);

/// Pieces that a used UV set falls into beyond those of the surface, of the set that has most: where they are 16 and
/// one for 64 triangles or more, half a cluster.
[[nodiscard]] Fault find_uv_islands(const SourceMesh& mesh, const Topology& topology,
                                    std::span<const SceneMaterial> materials);

[[nodiscard]] Fault find_missing_uvs(const SourceMesh& mesh, const Topology& topology,
                                     std::span<const SceneMaterial> materials);
[[nodiscard]] Fault find_unused_uvs(const SourceMesh& mesh, const Topology& topology,
                                    std::span<const SceneMaterial> materials);

/// From a dozen on.
constexpr std::size_t kManyMaterials = 12;
[[nodiscard]] Fault find_many_materials(const SourceMesh& mesh, const Topology& topology);

}  // namespace meshlode::scene
