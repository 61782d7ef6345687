// SPDX-License-Identifier: GPL-3.0-or-later
// PLY, OBJ and STL: read by our own readers (read_*.cpp), triangulated here.
//
// Every number and index is checked as it is read, counts are believed only as far as the file has bytes for them, and
// positions keep all their digits. OpenMesh's readers do none of that: they know floats only, skip what they cannot
// parse, follow mtllib, and loop over whatever count a file states.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "scene/import/import.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Vertices and polygons as a file has them.
struct PolygonSoup {
  std::vector<Vec3d> positions;                  ///< with all their digits; NaN and infinity too
  std::vector<Vec3f> normals;                    ///< empty or one per vertex
  std::vector<Vec2f> uvs;                        ///< empty or one per vertex
  std::vector<Vec4f> colors;                     ///< empty or one per vertex
  std::vector<std::uint32_t> corners;            ///< of all polygons, one after the other
  std::vector<std::uint32_t> polygon_sizes;      ///< 3 or more each
  std::vector<std::uint32_t> polygon_materials;  ///< empty, or for each an index into material_names or kNoId
};

struct PolygonFile {
  PolygonSoup soup;
  ImportDrops drops;
  std::vector<LeftOut> left_out;
  std::vector<std::string> material_names;      ///< of OBJ's usemtl, each once
  std::vector<std::string> material_libraries;  ///< of its mtllib, a line each
};

/// Errors: kInvalid or kUnsupported, with the place in `where` for the caller to put the file's name before.
[[nodiscard]] Result<PolygonFile> read_ply(std::span<const std::uint8_t> bytes, const ImportOptions& options);
[[nodiscard]] Result<PolygonFile> read_obj(std::span<const std::uint8_t> bytes, const ImportOptions& options);
[[nodiscard]] Result<PolygonFile> read_stl(std::span<const std::uint8_t> bytes, const ImportOptions& options);

/// Polygons become triangles by fans, from a corner whose fan folds nowhere where there is one. Triangles with a
/// position that is not finite are refused, or dropped and counted with options.repair. One primitive for each material
/// that a polygon has, those without one last; one without a material where there are none.
[[nodiscard]] Result<std::vector<Primitive>> triangulate(PolygonSoup soup, const ImportOptions& options,
                                                         ImportDrops& drops, std::vector<LeftOut>& left_out);

}  // namespace meshlode::scene
