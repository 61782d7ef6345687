// SPDX-License-Identifier: GPL-3.0-or-later
// A file of polygons becomes a scene: a mesh, or one for each object that stands apart, with an instance each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include <meshlode/result.h>

#include "scene/import/polygons/polygon_soup.h"
#include "scene/scene.h"

namespace meshlode::scene {

using PolygonReader = Result<PolygonFile> (*)(std::span<const std::uint8_t>, const ImportOptions&);

/// The materials that the file names, or the default one. Errors: as the reader has them, behind the path; kIo as
/// add_polygon_materials has it.
[[nodiscard]] Result<Scene> import_polygons(PolygonReader read, const std::filesystem::path& path,
                                            std::span<const std::uint8_t> bytes, const ImportOptions& options);

}  // namespace meshlode::scene
