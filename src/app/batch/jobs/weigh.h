// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene will cost to build, guessed before any geometry is read: by its bytes.
#pragma once

#include <cstdint>
#include <filesystem>

namespace meshlode::app {

/// Bytes of the scene, of a .gltf also of the files that it names, and one more: never 0. What cannot be opened has
/// none.
[[nodiscard]] std::uint64_t weigh_scene(const std::filesystem::path& scene);

}  // namespace meshlode::app
