// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/float_positions.h"

#include <algorithm>
#include <cmath>

#include "format/grid.h"

namespace meshlode::app {

Vec3d choose_origin(const format::MeshRecord& record, std::span<const std::vector<CutPrimitive>> levels) {
  const Vec3d origin(record.origin[0], record.origin[1], record.origin[2]);
  const format::PositionGrid grid{record.grid.log2, record.grid.mantissa};
  const double bearable = std::max(grid.step() / 64.0, record.diagonal * format::exp2_exact(-24));
  const auto bears = [&](const CutPrimitive& primitive) {
    for (std::uint32_t i = 0; i < primitive.vertices.vertex_count; ++i) {
      const Vec3d exact = origin + grid.decode(primitive.vertices.position(i));
      for (int axis = 0; axis < 3; ++axis) {
        const double stored = static_cast<double>(static_cast<float>(exact[axis]));
        if (!(std::abs(stored - exact[axis]) <= bearable)) return false;
      }
    }
    return true;
  };
  for (const std::vector<CutPrimitive>& primitives : levels) {
    if (!std::all_of(primitives.begin(), primitives.end(), bears)) return Vec3d(0.0);
  }
  return origin;
}

std::optional<std::vector<Vec3f>> bake_positions(const format::MeshRecord& record, const run::DecodedCluster& vertices,
                                                 const Vec3d& baked) {
  const format::PositionGrid grid{record.grid.log2, record.grid.mantissa};
  std::vector<Vec3f> positions(vertices.vertex_count);
  for (std::uint32_t i = 0; i < vertices.vertex_count; ++i) {
    positions[i] = Vec3f(baked + grid.decode(vertices.position(i)));
    if (!std::isfinite(positions[i].x) || !std::isfinite(positions[i].y) || !std::isfinite(positions[i].z)) return {};
  }
  return positions;
}

}  // namespace meshlode::app
