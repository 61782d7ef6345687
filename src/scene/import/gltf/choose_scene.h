// SPDX-License-Identifier: GPL-3.0-or-later
// Which of a file's scenes is instanced, where it is not the default one.
#pragma once

#include <string_view>

#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

/// ImportOptions::scene for all of them.
constexpr std::string_view kEveryScene = "all";

/// Makes the scene of that name, or else of that index, the default one, in the tree and in the model; "all" adds one
/// that has the roots of every scene, each once, behind the others. Empty: as the file has it.
/// Errors: kUsage where there is no such scene, or several of that name. \pre the asset is checked
[[nodiscard]] Status choose_scene(GltfAsset& asset, std::string_view choice);

}  // namespace meshlode::scene
