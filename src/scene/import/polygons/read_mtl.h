// SPDX-License-Identifier: GPL-3.0-or-later
// The materials of an OBJ's mtllib: what of them a glTF material has.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshlode::scene {

struct MtlMaterial {
  std::string name;
  std::array<double, 3> diffuse{1.0, 1.0, 1.0};  ///< Kd, clamped to 0 … 1
  double opacity = 1.0;                          ///< d, or 1 - Tr
  std::string texture;                           ///< the file that map_Kd names, as it is written; empty without
};

/// In the order of the file; of two with one name both. Lines that make no sense are passed over, as other keywords
/// are.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::scene
