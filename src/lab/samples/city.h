// SPDX-License-Identifier: GPL-3.0-or-later
// The small city of data/: meshes of two materials each, drawn many times under all kinds of transforms.
#pragma once

#include "lab/samples/write_glb.h"

namespace meshlode::lab {

[[nodiscard]] GlbScene make_city(std::uint64_t seed = 17);

}  // namespace meshlode::lab
