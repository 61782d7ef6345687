// SPDX-License-Identifier: GPL-3.0-or-later
// What was kept or left out and why, with what is the same for several meshes said once.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshlode::app {

struct Reason {
  std::string what;  ///< "mesh 3 'rock': TANGENT", or what is no mesh's
  std::string why;
};

/// Reasons that differ in the mesh alone become one, "TANGENT, 6 of 9 meshes", in the place of the first.
[[nodiscard]] std::vector<Reason> fold_reasons(std::span<const Reason> reasons, std::size_t mesh_count);

}  // namespace meshlode::app
