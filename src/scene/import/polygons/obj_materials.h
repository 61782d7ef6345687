// SPDX-License-Identifier: GPL-3.0-or-later
// The materials that the faces of an OBJ or a PLY name become materials of the scene, as a glTF would have them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/hash.h"
#include "scene/import/import.h"
#include "scene/import/polygons/polygon_soup.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Fills scene.materials (one for each name, then the default one), blobs and document, from libraries and textures
/// below the folder of `path`; each file that is opened is hashed. What cannot be opened is said in scene.left_out, and
/// so is a material that no library has.
/// Errors: kIo, at the statement, where a library or a texture cannot be opened and options.may_lack_images is not set
[[nodiscard]] Status add_obj_materials(const std::filesystem::path& path, const PolygonFile& file,
                                       const ImportOptions& options, Hasher& hasher, Scene& scene);

/// Windows writes its paths the other way.
[[nodiscard]] std::string with_slashes(std::string name);
/// The file that a mtllib, a map or a TextureFile names. Errors: as resolve_below has them.
[[nodiscard]] Result<std::filesystem::path> resolve_named(const std::filesystem::path& folder, const std::string& name,
                                                          std::span<const std::filesystem::path> allow_outside);

/// Every file that add_obj_materials opens, or would open were it there: libraries, and what their maps name.
[[nodiscard]] std::vector<FileReference> list_obj_references(const std::filesystem::path& path,
                                                             std::span<const std::uint8_t> bytes,
                                                             std::span<const std::filesystem::path> allow_outside);
/// The same of a PLY's TextureFile comments.
[[nodiscard]] std::vector<FileReference> list_ply_references(const std::filesystem::path& path,
                                                             std::span<const std::uint8_t> bytes,
                                                             std::span<const std::filesystem::path> allow_outside);

}  // namespace meshlode::scene
