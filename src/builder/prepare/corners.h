// SPDX-License-Identifier: GPL-3.0-or-later
// A source mesh as the rest of prepare sees it: its primitives as one list of corners, with the attributes that are
// kept.
#pragma once

#include <cstdint>
#include <vector>

#include "base/unset_vector.h"
#include "base/vec.h"
#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// `vertex` ids run over all primitives.
struct Corners {
  UnsetVector<Vec3d> positions;          ///< per vertex, object units
  UnsetVector<float> attributes;         ///< per vertex, layout.stride() floats
  UnsetVector<std::uint32_t> triangles;  ///< 3 vertex ids each
  UnsetVector<std::uint32_t> materials;  ///< per triangle

  [[nodiscard]] const float* attributes_of(std::uint32_t vertex, std::uint32_t stride) const {
    return attributes.data() + std::size_t{vertex} * stride;
  }
};

/// Where the layout has normals and a primitive has none, its corners get their triangles' own, each a vertex of its
/// own. Zeros are positive. \pre indices are in range, and attributes as long as positions
[[nodiscard]] Corners gather_corners(const scene::SourceMesh& mesh, const AttributeLayout& layout);

}  // namespace meshlode::builder
