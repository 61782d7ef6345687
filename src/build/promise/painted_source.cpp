// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/promise/painted_source.h"

#include <algorithm>
#include <cmath>

#include "build/prepare/zero_area.h"

namespace meshlode::build {

namespace {

/// A normal turned by an angle counts like a way of the angle times this share of the diagonal: what a highlight moves
/// by on a ball of that radius.
constexpr double kHighlightRadius = 1.0 / 8.0;

/// A positive, finite float that can be multiplied with.
bool is_scale(double value) {
  return value >= 0x1p-100 && value <= 0x1p100;
}

std::array<Vec2d, 3> uvs_of(const PaintedSource& source, std::size_t triangle, std::uint32_t set) {
  std::array<Vec2d, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const float* const a = &source.attributes[std::size_t{source.wedges[triangle][k]} * source.layout.stride() +
                                              source.layout.uv_offset() + 2 * std::size_t{set}];
    out[k] = {std::isfinite(a[0]) ? a[0] : 0.0F, std::isfinite(a[1]) ? a[1] : 0.0F};
  }
  return out;
}

void set_uv_units(const PreparedMesh& mesh, std::span<const TexelExtents> extents, std::uint32_t set,
                  PaintedSource& source) {
  const std::uint8_t texcoord = mesh.layout.uv_set_source[set];
  double width = 0.0, height = 0.0, surface = 0.0, uv = 0.0;
  for (std::size_t t = 0; t < source.triangles.size(); ++t) {
    const std::uint32_t material = mesh.triangle_material[t];
    if (material >= extents.size()) continue;
    const std::array<double, 2>& extent = extents[material][texcoord];
    if (!(extent[0] > 0.0) || !(extent[1] > 0.0)) continue;
    width = std::max(width, extent[0]);
    height = std::max(height, extent[1]);
    const auto& [a, b, c] = source.triangles[t];
    // What draws nothing covers no texels either.
    if (are_collinear(source.positions[a], source.positions[b], source.positions[c])) continue;
    const Vec3d n = glm::cross(source.positions[b] - source.positions[a], source.positions[c] - source.positions[a]);
    surface += 0.5 * std::sqrt(glm::dot(n, n));
    const std::array<Vec2d, 3> q = uvs_of(source, t, set);
    const Vec2d e = q[1] - q[0], f = q[2] - q[0];
    uv += 0.5 * std::abs(e.x * f.y - e.y * f.x);
  }
  const double texel = std::sqrt(surface / (width * height * uv));
  if (!is_scale(texel * width) || !is_scale(texel * height)) return;
  source.units.uv_object[set][0] = static_cast<float>(texel * width);
  source.units.uv_object[set][1] = static_cast<float>(texel * height);
}

}  // namespace

PaintedSource keep_painted_source(const PreparedMesh& mesh, std::span<const TexelExtents> extents, bool has_normals) {
  PaintedSource source;
  source.layout = mesh.layout;
  source.positions = mesh.exact_positions;
  source.triangles = mesh.exact_triangles;
  source.wedges = mesh.triangles;
  source.attributes = mesh.wedge_attributes;
  const double radius = kHighlightRadius * mesh.diagonal;
  if (has_normals && (mesh.layout.has_normal || mesh.layout.flat_normal) && is_scale(radius)) {
    source.units.normal_object = static_cast<float>(radius);
  }
  for (std::uint32_t set = 0; set < mesh.layout.uv_set_count; ++set) set_uv_units(mesh, extents, set, source);
  return source;
}

PaintedUnits units_to_simplify_by(const PaintedSource& painted, double diagonal) {
  constexpr double kShadingShare = 1.0 / 16.0;  // of what appearance counts
  PaintedUnits units;
  bool has_texels = false;
  for (std::size_t set = 0; set < units.uv.size(); ++set) {
    for (std::size_t axis = 0; axis < 2; ++axis) units.uv[set][axis] = double{painted.units.uv_object[set][axis]};
    has_texels = has_texels || units.uv[set][0] > 0.0;
  }
  units.normal = double{painted.units.normal_object};
  if (has_texels && units.normal == 0.0) units.normal = kShadingShare * kHighlightRadius * diagonal;
  return units;
}

}  // namespace meshlode::build
