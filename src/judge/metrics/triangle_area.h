// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a triangle has area, decided exactly for all finite doubles: what the source is hangs on it
// (docs/reference/format.md, "The source").
#pragma once

#include "base/vec.h"

namespace meshlode::judge {

/// False if the corners lie on one line or at one point, exactly. \pre all finite
[[nodiscard]] bool has_area(const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace meshlode::judge
