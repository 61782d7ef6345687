// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/attribute_scales.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace meshlode::builder {

namespace {

struct Areas {
  double surface = 0.0;
  std::array<double, scene::kMaxUvSets> uv{};  ///< that the texture coordinates of each set cover
};

Areas measure_areas(const SimplifyInput& input, const CollapseMesh& mesh, const GroupPlaces& places) {
  const AttributeLayout& layout = input.layout;
  Areas areas;
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.is_alive(t)) continue;
    const Vec3d& p = places[mesh.vertex(3 * t)];
    const Vec3d n = glm::cross(places[mesh.vertex(3 * t + 1)] - p, places[mesh.vertex(3 * t + 2)] - p);
    areas.surface += 0.5 * std::sqrt(glm::dot(n, n));
    for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
      std::array<Vec2d, 3> uv;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const float* a = &input.wedge_attributes[std::size_t{mesh.wedge(3 * t + k)} * layout.stride()];
        uv[k] = {a[layout.uv_offset() + 2 * set], a[layout.uv_offset() + 2 * set + 1]};
      }
      const Vec2d e = uv[1] - uv[0];
      const Vec2d f = uv[2] - uv[0];
      areas.uv[set] += 0.5 * std::abs(e.x * f.y - e.y * f.x);
    }
  }
  return areas;
}

}  // namespace

std::vector<double> attribute_scales(const SimplifyInput& input, const SimplifyOptions& options,
                                     const CollapseMesh& mesh, const GroupPlaces& places) {
  const AttributeLayout& layout = input.layout;
  std::vector<double> scales(layout.stride(), 0.0);
  if (scales.empty()) return scales;
  const Areas areas = measure_areas(input, mesh, places);
  // Where few triangles are left, what a normal says holds for less than they cover: the shape comes first then.
  constexpr double kMaxSide = 0.05;  // of half the group's extent: a full group has about this
  const double mean_side = std::min(kMaxSide, std::sqrt(areas.surface / std::max(1U, mesh.alive_count())));
  for (std::uint32_t j = 0; j < layout.stride(); ++j) {
    if (layout.has_normal && j < 3) {
      scales[j] = options.normal_weight * mean_side;
    } else if (j < layout.color_offset()) {
      const double density = areas.uv[(j - layout.uv_offset()) / 2];
      scales[j] = density > 0.0 ? options.uv_weight * std::sqrt(areas.surface / density) : 0.0;
    } else {
      scales[j] = options.color_weight * mean_side;
    }
    if (!std::isfinite(scales[j])) scales[j] = 0.0;
  }
  return scales;
}

}  // namespace meshlode::builder
