// SPDX-License-Identifier: GPL-3.0-or-later
// Two surfaces nearer to each other than coarse cuts' errors: a thin plate of brass in a shallow recess of a block of
// wood, as the plaque of FlightHelmet is. Millimetres.
#pragma once

#include <cstdint>

#include "base/vec.h"
#include "scene/scene.h"

namespace meshlode::test {

constexpr double kRecessDepth = 1.9, kPlateThickness = 1.0;
constexpr double kPlateBack = -1.7;  ///< z of the plate's back; the block's face is at 0, the recess's floor at -1.9

struct PlateSceneOptions {
  Vec3d plate_moved{0.0};
  bool has_plate = true;  ///< else its mesh has no triangle
  bool are_materials_swapped = false;
  std::uint32_t cells = 20;  ///< along the block's 100 mm
};

/// Mesh 0 the block, 100 by 60 by 20, material 0 and no plainer than its recess of 60 by 20; mesh 1 the plate, 58 by
/// 18, material 1. One instance each. Both closed, facing +z.
[[nodiscard]] scene::Scene plate_scene(const PlateSceneOptions& options = {});

}  // namespace meshlode::test
