// SPDX-License-Identifier: GPL-3.0-or-later
// A caller's arrays become a Scene, as import would hand it on: checked, owned, every index in range.
#pragma once

#include <meshlode/build.h>

#include "scene/scene.h"

namespace meshlode::builder {

/// Errors: kInvalid with the place. With `repair`, triangles that touch a non-finite position or an index out of range
/// are dropped and counted instead.
[[nodiscard]] Result<scene::Scene> make_scene(const SceneInput& input, bool repair);

}  // namespace meshlode::builder
