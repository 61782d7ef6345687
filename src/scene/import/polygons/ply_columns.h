// SPDX-License-Identifier: GPL-3.0-or-later
// Which single numbers of a PLY's vertices and faces are kept, by the names that programs give them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "scene/import/polygons/ply_header.h"

namespace meshlode::scene {

/// What a vertex or a face may have in single numbers.
enum PlyColumn : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kU, kV, kRed, kGreen, kBlue, kAlpha, kTexture, kColumnCount };

struct PlyColumns {
  /// \param sets that are kept where all of one are there; kAlpha goes with the colours
  PlyColumns(const PlyElement& element, const std::vector<std::vector<PlyColumn>>& sets);

  std::array<bool, kColumnCount> has{};
  std::vector<std::optional<PlyColumn>> columns;  ///< of each property; nothing for lists and what is not kept
  PlyType color_type = PlyType::kUint8;           ///< of red
};

}  // namespace meshlode::scene
