// SPDX-License-Identifier: GPL-3.0-or-later
// A plane whose texture is two charts side by side, cut at x = 0: ten units apart in u.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lab/samples/samples.h"

namespace meshlode::builder {

[[nodiscard]] inline scene::Primitive make_two_charts(std::uint32_t cells) {
  const scene::Primitive plane = lab::make_plane(cells);
  scene::Primitive cut;
  for (std::size_t i = 0; i < plane.indices.size(); i += 3) {
    double x = 0.0;
    for (std::size_t k = 0; k < 3; ++k) x += plane.positions[plane.indices[i + k]].x;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = plane.positions[plane.indices[i + k]];
      cut.indices.push_back(static_cast<std::uint32_t>(cut.positions.size()));
      cut.positions.push_back(p);
      cut.uvs[0].emplace_back(float(p.x) + (x < 0 ? 10.0F : 0.0F), float(p.z));
    }
  }
  return cut;
}

}  // namespace meshlode::builder
