// SPDX-License-Identifier: GPL-3.0-or-later
// PLY, OBJ and STL: checked and rewritten plainly (*_check.cpp), read by OpenMesh (openmesh_read.cpp), triangulated
// here.
//
// OpenMesh's readers believe counts and list lengths, follow mtllib, skip what they cannot parse and know only some of
// PLY's types. So each file is walked first, every number and index is checked, and what the reader then gets is the
// same mesh in the plainest form of its format.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "scene/import/import.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// A file that OpenMesh may see.
struct CheckedMeshFile {
  enum class Format : std::uint8_t { kPly, kObj, kStl };
  Format format = Format::kPly;
  std::string text;  ///< the rewritten file, text or binary
  bool has_normals = false, has_uvs = false, has_colors = false;
  /// Per vertex of the file: the position with all its digits (OpenMesh keeps floats), NaN allowed. Empty for STL.
  std::vector<Vec3d> exact_positions;
  ImportDrops drops;
  std::vector<LeftOut> left_out;
};

/// What OpenMesh hands over: vertices and polygons.
struct PolygonSoup {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;                ///< empty or one per vertex
  std::vector<Vec2f> uvs;                    ///< empty or one per vertex
  std::vector<Vec4f> colors;                 ///< empty or one per vertex
  std::vector<std::uint32_t> corners;        ///< of all polygons, one after the other
  std::vector<std::uint32_t> polygon_sizes;  ///< 3 or more each
};

/// Errors: kInvalid or kUnsupported, with the place in `where` for the caller to put the file's name before.
[[nodiscard]] Result<CheckedMeshFile> check_ply(std::span<const std::uint8_t> bytes, const ImportOptions& options);
[[nodiscard]] Result<CheckedMeshFile> check_obj(std::span<const std::uint8_t> bytes, const ImportOptions& options);
[[nodiscard]] Result<CheckedMeshFile> check_stl(std::span<const std::uint8_t> bytes, const ImportOptions& options);

[[nodiscard]] Result<PolygonSoup> read_with_openmesh(CheckedMeshFile& file);

/// Polygons become triangles by fans, from a corner whose fan folds nowhere where there is one. Triangles with a
/// position that is not finite are refused, or dropped and counted with options.repair.
[[nodiscard]] Result<Primitive> triangulate(PolygonSoup soup, const ImportOptions& options, ImportDrops& drops,
                                            std::vector<LeftOut>& left_out);

}  // namespace meshlode::scene
