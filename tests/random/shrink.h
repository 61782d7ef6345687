// SPDX-License-Identifier: GPL-3.0-or-later
// A failing scene made small: whole meshes, primitives, attributes and options go first, then triangles by delta
// debugging (Zeller, Hildebrandt 2002), as long as the same rule still finds something.
#pragma once

#include <functional>
#include <string>

#include "scene.h"

namespace meshlode::test {

/// True where the scene still fails in the way that is being looked for.
using StillFails = std::function<bool(const RandomScene&)>;

/// The smallest scene found within `seconds` of wall time; the scene itself where nothing could go.
/// \pre still_fails(scene)
[[nodiscard]] RandomScene shrink_scene(RandomScene scene, const StillFails& still_fails, double seconds);

}  // namespace meshlode::test
