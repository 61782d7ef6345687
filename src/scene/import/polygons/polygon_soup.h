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
#include "scene/import/polygons/read_mtl.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Which attributes a polygon has at all its corners: bits.
enum PolygonTraits : std::uint8_t { kHasUvs = 1, kHasNormals = 2, kHasColors = 4, kHasAll = 7 };

/// Vertices and polygons as a file has them.
struct PolygonSoup {
  std::vector<Vec3d> positions;                  ///< with all their digits; NaN and infinity too
  std::vector<Vec3f> normals;                    ///< empty or one per vertex
  std::vector<Vec2f> uvs;                        ///< empty or one per vertex
  std::vector<Vec4f> colors;                     ///< empty or one per vertex
  std::vector<std::uint32_t> corners;            ///< of all polygons, one after the other
  std::vector<std::uint32_t> polygon_sizes;      ///< 3 or more each
  std::vector<std::uint32_t> polygon_materials;  ///< empty, or for each an index into material_names or kNoId
  std::vector<std::uint8_t> polygon_traits;      ///< empty: each has all that the vertices have; or PolygonTraits
  std::vector<std::uint32_t> polygon_objects;    ///< empty, or for each an index into object_names or kNoId
};

struct PolygonFile {
  PolygonSoup soup;
  ImportDrops drops;
  std::vector<LeftOut> left_out;
  std::vector<std::string> material_names;      ///< of OBJ's usemtl, each once
  std::vector<std::string> material_libraries;  ///< of its mtllib, a line each
  std::vector<MtlMaterial> materials;           ///< those that the file itself describes: PLY's TextureFile
  std::vector<std::string> object_names;        ///< of OBJ's o, each once
};

/// Errors: kInvalid or kUnsupported, with the place in `where` for the caller to put the file's name before.
[[nodiscard]] Result<PolygonFile> read_ply(std::span<const std::uint8_t> bytes, const ImportOptions& options);
[[nodiscard]] Result<PolygonFile> read_obj(std::span<const std::uint8_t> bytes, const ImportOptions& options);
[[nodiscard]] Result<PolygonFile> read_stl(std::span<const std::uint8_t> bytes, const ImportOptions& options);

/// The primitives of one object, or of all that is in none.
struct PolygonMesh {
  std::uint32_t object = kNoId;  ///< index into object_names
  std::vector<Primitive> primitives;
};

/// Polygons become triangles: by a fan from a corner whose fan folds nowhere where there is one, else by
/// triangulate_polygon(). A polygon that crosses itself is a fan and said so. Triangles with a position that is not
/// finite are refused, or dropped and counted with options.repair. A mesh for each object, what is in none first; in it
/// one primitive for each material and set of attributes that a polygon has, those without material last. One mesh
/// with one primitive where there are no polygons.
[[nodiscard]] Result<std::vector<PolygonMesh>> triangulate(PolygonSoup soup, const ImportOptions& options,
                                                           ImportDrops& drops, std::vector<LeftOut>& left_out);

}  // namespace meshlode::scene
