// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of a group, with numbers of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/left_behind.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// Two vertices may have come to lie on one point of the grid. A triangle with both has no area and no border by then.
[[nodiscard]] inline bool has_corners_in_one_place(const CollapseMesh& mesh, const GroupPlaces& places,
                                                   std::uint32_t triangle) {
  const Vec3i& p = places.on_grid(mesh.vertex(3 * triangle));
  const Vec3i& q = places.on_grid(mesh.vertex(3 * triangle + 1));
  const Vec3i& r = places.on_grid(mesh.vertex(3 * triangle + 2));
  return p == q || q == r || r == p;
}

/// Its triangles, vertices and wedges; `write_wedge(vertex, wedge, out)` appends a wedge's floats.
template <class WriteWedge>
[[nodiscard]] SimplifyResult write_group(const SimplifyInput& input, const CollapseMesh& mesh,
                                         const GroupPlaces& places, const LeftBehind& left_behind,
                                         const WriteWedge& write_wedge) {
  SimplifyResult out;
  const bool has_attributes = input.layout.stride() > 0;  // without them a position is its own wedge
  std::vector<std::uint32_t> new_position(places.size(), kNoId);
  // A wedge may have come to serve one vertex only, so a map per wedge is enough.
  std::vector<std::uint32_t> new_wedge(has_attributes ? input.wedge_position.size() : places.size(), kNoId);
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.is_alive(t) || has_corners_in_one_place(mesh, places, t)) continue;
    WedgeTriangle triangle{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.vertex(3 * t + k);
      const std::uint32_t w = has_attributes ? mesh.wedge(3 * t + k) : v;
      if (new_position[v] == kNoId) {
        new_position[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(places.on_grid(v));
        out.witnesses.push_back(left_behind.witnesses(v));
      }
      if (new_wedge[w] == kNoId) {
        new_wedge[w] = static_cast<std::uint32_t>(out.wedge_position.size());
        out.wedge_position.push_back(new_position[v]);
        if (has_attributes) write_wedge(v, w, out.wedge_attributes);
      }
      triangle[k] = new_wedge[w];
    }
    out.triangles.push_back(triangle);
    out.triangle_material.push_back(input.triangle_material[t]);
  }
  return out;
}

}  // namespace meshlode::builder
