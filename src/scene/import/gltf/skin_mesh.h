// SPDX-License-Identifier: GPL-3.0-or-later
// The arithmetic of skins on one mesh: which joints move it, whether they move it as one, and where its vertices go.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/box.h"
#include "scene/import/gltf/primitive.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// 16 floats, column-major, whose last row is taken as (0, 0, 0, 1); zeros and that row for nullptr.
[[nodiscard]] Mat4d affine_matrix(const std::uint8_t* floats);
[[nodiscard]] bool is_finite(const Mat4d& matrix);

/// What of a skin moves a mesh. A vertex counts where a triangle names it.
struct MeshJoints {
  bool has_weights = false;               ///< some primitive has them
  std::vector<std::uint32_t> used;        ///< ascending
  std::uint64_t bad_vertices = 0;         ///< that have weights which mean nothing
  std::uint64_t unweighted_vertices = 0;  ///< of primitives without weights
  Box3d box;                              ///< of the vertices
};
[[nodiscard]] MeshJoints find_joints(const SourceMesh& mesh, const std::vector<VertexWeights>& weights,
                                     std::size_t joint_count);

/// The matrix that stands for those of all used joints: the identity, or else the first's, where no vertex inside the
/// box goes more than a millionth of the numbers in hand elsewhere.
[[nodiscard]] std::optional<Mat4d> common_matrix(const MeshJoints& joints, const std::vector<Mat4d>& matrices);

/// Moves each vertex by its weights' sum of the matrices (weights are made to sum to 1), normals by the inverse
/// transpose, and turns triangles that the matrices mirror. False where a position is not finite then.
[[nodiscard]] bool bake_mesh(SourceMesh& mesh, const std::vector<VertexWeights>& weights,
                             const std::vector<Mat4d>& matrices);

}  // namespace meshlode::scene
