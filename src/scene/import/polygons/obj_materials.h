// SPDX-License-Identifier: GPL-3.0-or-later
// The materials that an OBJ's faces name become materials of the scene, as a glTF would have them.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <meshlode/result.h>

#include "base/hash.h"
#include "scene/import/import.h"
#include "scene/import/polygons/polygon_soup.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Fills scene.materials (one for each name, then the default one), blobs and document, from libraries and textures
/// below the folder of `path`; each file that is opened is hashed. What cannot be opened is said in scene.left_out, and
/// so is a material that no library has.
void add_obj_materials(const std::filesystem::path& path, const PolygonFile& file, const ImportOptions& options,
                       Hasher& hasher, Scene& scene);

}  // namespace meshlode::scene
