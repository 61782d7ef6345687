// SPDX-License-Identifier: GPL-3.0-or-later
// EXT_mesh_gpu_instancing: copies of a node's mesh become nodes of their own.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/import/gltf/gltf.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Puts each instance behind the nodes that the file has, in the tree and in the model, as a child of the node that
/// names it, before that node's own children: so instances are instanced, drawn, carried and exported as any node, and
/// by readers that do not know the extension. Names: the node's with the instance's number, "tree[17]".
/// `max_decoded`: bytes that instances may take beyond what `file_bytes` justify.
/// Errors: kInvalid for attributes that are not as the extension has them, and for more instances than the file's size
/// and max_decoded justify. \pre the asset is checked, its buffers are loaded
[[nodiscard]] Status expand_instancing(GltfAsset& asset, DecodeBudget& budget, std::uint64_t file_bytes,
                                       std::uint64_t max_decoded, std::vector<LeftOut>& left_out);

}  // namespace meshlode::scene
