// SPDX-License-Identifier: GPL-3.0-or-later
// Random triangles that are no surface.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace meshlode::test {

/// Of one mesh and one instance, without attributes, with every fault that repair knows; of a small lattice, so that
/// corners, edges and triangles meet often.
scene::Scene make_random_soup(std::uint64_t seed);

}  // namespace meshlode::test
