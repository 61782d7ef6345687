// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a PLY (Turk 1994): its elements with their properties, and the textures that comments name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;
  std::optional<PlyType> list_count;  ///< the type of the length, for lists
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool is_ascii = true, is_big_endian = false;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< of each "comment TextureFile", as it is written
  Tally other;                        ///< lines that say nothing about the body: obj_info and unknown keywords
};

[[nodiscard]] std::size_t size_of(PlyType type);
[[nodiscard]] bool is_float(PlyType type);

/// Takes the header off the front: the body begins behind the line end of end_header, which is CR alone where the first
/// line's is. Errors: kInvalid, at the line.
[[nodiscard]] Result<PlyHeader> take_ply_header(std::string_view& text);

}  // namespace meshlode::scene
