// SPDX-License-Identifier: GPL-3.0-or-later
// What the cases look like: one small picture each, all on one sheet with the numbers of the table's rows.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/raster.h"
#include "hard_case.h"

namespace meshlode::test::hard {

/// Level 0 of a case at the second parameter of its sweep, where something shows, or at the first where that is refused
/// or there is no other. Errors: of the case, of the build and of the rasterizer.
[[nodiscard]] Result<draw::Image> draw_thumbnail(const HardCase& hard_case);

/// A PNG of `columns` thumbnails a row, numbered from 1 on; a case that cannot be drawn is left grey.
[[nodiscard]] std::vector<std::uint8_t> contact_sheet(std::span<const HardCase* const> cases, std::uint32_t columns);

}  // namespace meshlode::test::hard
