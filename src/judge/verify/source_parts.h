// SPDX-License-Identifier: GPL-3.0-or-later
// The source's meshes as an asset has them: where META says that pieces of a mesh are a mesh of their own they are
// taken out of it.
#pragma once

#include <optional>

#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::judge {

/// Nothing where the source's meshes are the asset's, or where what META says cannot be: the numbers of meshes differ
/// then.
[[nodiscard]] std::optional<scene::Scene> split_source(const run::Asset& asset, const scene::Scene& source);

}  // namespace meshlode::judge
