// SPDX-License-Identifier: GPL-3.0-or-later
// The corners of an OBJ's face: indices of positions, texture coordinates and normals.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace meshlode::scene {

/// Indices from 1, 0 where there is none.
struct ObjCorner {
  std::uint64_t position = 0, uv = 0, normal = 0;
};

/// How many of each there are so far.
struct ObjCounts {
  std::uint64_t positions = 0, uvs = 0, normals = 0;
};

struct ObjFace {
  std::vector<ObjCorner> corners;                 ///< without those that repeat the one before
  std::uint64_t stated = 0;                       ///< how many the line has
  bool is_valid = true;                           ///< every position is there
  bool is_malformed = false;                      ///< some texture coordinate or normal is no number
  bool lacks_uvs = false, lacks_normals = false;  ///< some corner names one that is not there
};

/// \param line what follows the f
[[nodiscard]] ObjFace parse_obj_face(std::string_view line, const ObjCounts& counts);
/// Three or more positions are different.
[[nodiscard]] bool has_three_positions(const std::vector<ObjCorner>& corners);

}  // namespace meshlode::scene
