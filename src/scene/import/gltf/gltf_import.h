// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the glTF import, in the order in which gltf_import.cpp calls them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "scene/import/gltf/tinygltf.h"
#include "scene/import/import.h"
#include "scene/scene.h"

namespace meshlode::scene {

class DecodeBudget;
class GltfFiles;
struct GltfAsset;
struct Json;

/// `bytes` are the scene file's own. `path` names it in messages and gives the folder that URIs are relative to.
[[nodiscard]] Result<Scene> import_gltf(const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                                        const ImportOptions& options);

/// list_references (import/import.h) of a glTF or GLB file.
[[nodiscard]] Result<std::vector<FileReference>> list_gltf_references(
    const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
    std::span<const std::filesystem::path> allow_outside);

/// One SceneMaterial per glTF material, in order; TextureUse::blob is carry_document's. \pre the asset is checked
[[nodiscard]] std::vector<SceneMaterial> read_materials(const GltfAsset& asset, std::vector<LeftOut>& left_out);

/// Of the node's own frame to its parent's.
[[nodiscard]] Mat4d local_transform(const tinygltf::Node& node);
/// Whether KHR_node_visibility hides the node itself; its children are hidden with it.
[[nodiscard]] bool is_hidden(const Json& node);

/// The visible nodes that draw a mesh, depth first over the default scene, which `choice` made so where it is not empty
/// (choose_scene.h). \pre the asset is checked: nodes form trees
[[nodiscard]] std::vector<SceneInstance> read_instances(const GltfAsset& asset, std::string_view choice,
                                                        std::vector<LeftOut>& left_out);

/// Fills scene.document and scene.blobs with all that travels unchanged, and the blobs of the materials' texture uses.
/// Opens the images.
[[nodiscard]] Status carry_document(GltfAsset& asset, GltfFiles& files, const ImportOptions& options,
                                    DecodeBudget& budget, Scene& scene);

/// The rigid animations of the document: fills `document`'s animations, accessors, bufferViews and buffers, and one
/// blob with the bytes they need. What is not rigid node animation is left out and said so.
[[nodiscard]] Status carry_animations(const GltfAsset& asset, DecodeBudget& budget, Json& document, Scene& scene);

}  // namespace meshlode::scene
