// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "builder/aggregate/material_looks.h"

namespace meshlode::cli {

/// Reads the images that the scene carries, as `render` reads those of an asset: nearest texel of the base level, 8
/// bits of alpha, no vertex colours.
[[nodiscard]] const builder::LookReader& image_looks();

}  // namespace meshlode::cli
