// SPDX-License-Identifier: GPL-3.0-or-later
// One cut per mesh for a glTF, which has one mesh for all its instances. Uniform cuts are select_uniform's; here are
// the ones that a camera or a DAG level decides. All follow the one rule (I5): a set of groups that pass, closed
// towards the finer side, draws each piece of surface once.
#pragma once

#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "read/asset.h"
#include "select/select.h"

namespace meshlode {

/// The cut that replaces every group below `level`: 0 is the finest, level_count - 1 or more the coarsest.
[[nodiscard]] UniformCut choose_level_cut(const Asset& asset, MeshId mesh, std::uint32_t level);

/// Per mesh the coarsest cut that is at least as fine, everywhere, as what each of its instances draws for the camera:
/// a group passes iff it passes for all of them. Meshes without a drawn instance have an empty cut.
[[nodiscard]] std::vector<UniformCut> choose_camera_cuts(const Asset& asset, const Camera& camera, double pixel_error);

}  // namespace meshlode
