// SPDX-License-Identifier: GPL-3.0-or-later
// All that one built mesh depends on, as a hash.
#pragma once

#include <span>

#include "base/hash.h"
#include "builder/encode/encode.h"
#include "builder/layers/find_gaps.h"
#include "builder/options.h"
#include "builder/plan/texel_sizes.h"
#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Over the mesh's triangles, attributes and materials' ids, and over what the plan and the textures made of the
/// options for it: a material's colour, a texture's pixels, other meshes, nodes and names are not in it, but for the
/// gaps to them. Bits, not values: -0 is another mesh than 0. `extents`: of the scene's materials, where more than
/// positions is promised.
[[nodiscard]] Hash128 mesh_key(const scene::SourceMesh& mesh, const AttributeLayout& layout,
                               const EncodeOptions& encode, const MeshOptions& own, const SceneOptions& options,
                               std::span<const TexelExtents> extents = {}, const MeshGaps& gaps = {});

}  // namespace meshlode::builder
