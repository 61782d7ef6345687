// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

namespace meshlode::scene::count {

/// Rows of a PLY's element `face` with three different corners, as far as the text is one.
[[nodiscard]] std::uint64_t count_ply_faces(std::string_view text);

}  // namespace meshlode::scene::count
