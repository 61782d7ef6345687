// SPDX-License-Identifier: GPL-3.0-or-later
// Detect: what in a source costs accuracy, bytes or time. Each fault is one function over a mesh (face_faults.h,
// edge_faults.h, precision_faults.h, attribute_faults.h) that whoever has a mesh may ask; these ask all of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/detect/fault.h"
#include "scene/scene.h"

namespace meshlode::scene {

[[nodiscard]] std::uint64_t triangles_of(const SourceMesh& mesh);

/// Of the triangles that the file plainly holds (Scene::triangles_in_file) those that are neither in a mesh nor counted
/// as removed by --repair. 0 where the format does not tell.
[[nodiscard]] std::uint64_t count_missing_triangles(const Scene& scene);

/// Everything that is found in a mesh, in the order of FaultKind; costs by their share. Any indices and any floats:
/// what import refuses is found here too. A mesh too large for ids of 32 bits has no faults. O(n log n).
[[nodiscard]] std::vector<Fault> examine_mesh(const SourceMesh& mesh, std::span<const SceneMaterial> materials);

/// From so many drawn instances of meshes of one cluster on, they are a fault.
constexpr std::uint64_t kManySmallDraws = 16;

/// Faults of meshes one after the other, then those of the scene.
[[nodiscard]] std::vector<Fault> examine_scene(const Scene& scene);

}  // namespace meshlode::scene
