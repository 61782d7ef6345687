// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of surfaces that lie closely above one another: a good surface, and patches of one to three more a little
// above it, each a mesh and a material of its own, in a frame of its own.
#pragma once

#include <cstdint>

#include "dice.h"
#include "scene.h"

namespace meshlode::test {

/// Of about so many triangles. Gaps are from 2^-11 to 2^-5 of the scene; every layer is where it would be in one frame.
[[nodiscard]] RandomScene layered_scene(Dice& dice, std::uint32_t triangles);

}  // namespace meshlode::test
