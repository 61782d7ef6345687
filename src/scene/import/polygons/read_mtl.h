// SPDX-License-Identifier: GPL-3.0-or-later
// The materials of an OBJ's mtllib: what of them a glTF material has.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

/// A texture that a material names.
struct MtlMap {
  std::string file;     ///< as it is written; empty without
  std::string keyword;  ///< what names it, to say so
};

struct MtlMaterial {
  std::string name;
  std::array<double, 3> diffuse{1.0, 1.0, 1.0};              ///< Kd, clamped to 0 … 1
  std::optional<double> dissolve;                            ///< d: 1 is opaque
  std::optional<double> transparency;                        ///< Tr: 0 is opaque, as far as writers agree
  std::optional<std::array<double, 3>> emission;             ///< Ke, 0 or more
  std::optional<double> roughness, metalness;                ///< Pr and Pm, clamped to 0 … 1
  MtlMap base_color, alpha, emissive, normal, rough, metal;  ///< map_Kd, map_d, map_Ke, norm, map_Pr, map_Pm
};

struct MtlFile {
  /// In the order of the file; of two with one name both.
  std::vector<MtlMaterial> materials;
  /// Lines that are passed over, by what they are: a keyword, one whose values make no sense, an option of a map.
  Tally skipped;
  Tally clamped;  ///< lines by keyword
};

/// Keywords in whatever case.
[[nodiscard]] MtlFile read_mtl(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::scene
