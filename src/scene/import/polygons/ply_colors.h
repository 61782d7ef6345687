// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of a PLY's vertices or faces, whatever type they have.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "scene/import/polygons/ply_header.h"

namespace meshlode::scene {

/// Values as the file has them, and what they become together: 8 bits each.
struct PlyColors {
  std::vector<Vec4f> raw;
  PlyType type = PlyType::kUint8;  ///< red's
  bool has_alpha = false;

  /// Floats are linear and cover 0 … 1. Whole numbers are levels of sRGB, unless `is_linear`: of 0 … 255 in 8 bits and
  /// where none is larger, else of 0 … 65535. Adds the colours that are outside to `clamped`.
  [[nodiscard]] std::vector<Vec4f> take(bool is_linear, std::uint64_t& clamped);
};

}  // namespace meshlode::scene
